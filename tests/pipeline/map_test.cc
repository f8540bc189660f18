#include "colmap_seapoint/pipeline/map.h"

#include <gtest/gtest.h>

#include <functional>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/workspace/stage_runner.h"
#include "tests/cli/database_tables.h"
#include "tests/expect_error.h"
#include "tests/pipeline/strip_survey.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;
using Options = AutomaticReconstructorOptions;

// A COLMAP that knows the options of 4.0, and does nothing.
constexpr char kColmap4[] = R"sh(#!/bin/sh
case "$1 $2" in
  "mapper -h")
    echo "COLMAP 4.0 (a test)"
    for name in random_seed database_path image_path output_path Mapper.num_threads \
        Mapper.min_model_size Mapper.abs_pose_min_num_inliers Mapper.ba_refine_focal_length \
        Mapper.ba_global_frames_ratio Mapper.ba_local_num_images Mapper.init_min_tri_angle; do
      echo "  --$name arg"
    done ;;
  "global_mapper -h") printf '  --GlobalMapper.num_threads arg\n  --GlobalMapper.random_seed arg\n' ;;
  "help ") printf 'Available commands:\n  mapper\n  global_mapper\n' ;;
esac
)sh";

class PlanMappingTest : public StripSurvey {
 protected:
  void SetUp() override {
    WriteBytes(folder_ / "colmap", kColmap4);
    fs::permissions(folder_ / "colmap", fs::perms::owner_all);
  }

  MappingPlan Plan(const std::function<void(Options*)>& change = [](Options*) {}) const {
    Options options = ReconstructorOptions();
    options.colmap_path = (folder_ / "colmap").string();
    change(&options);
    return PlanMapping(options, Workspace(options.image_path, options.workspace_path));
  }

  static std::string Value(const MapperOptions& options, const std::string& name) {
    const auto option = options.find(name);
    return option == options.end() ? "not given" : option->second;
  }
};

TEST_F(PlanMappingTest, NamesWorkspaceAndProgram) {
  const MappingPlan plan = Plan();
  EXPECT_EQ(plan.colmap.path, folder_ / "colmap");
  EXPECT_EQ(plan.colmap.version, "COLMAP 4.0 (a test)");
  EXPECT_TRUE(plan.colmap.has_global_mapper);
  const fs::path root = folder_ / "ws";
  EXPECT_EQ(plan.job.database_path, root / "database.db");
  EXPECT_EQ(plan.job.image_path, Images());
  EXPECT_EQ(plan.job.output_path, root / "sparse.tmp");
  EXPECT_EQ(plan.sparse, root / "sparse");
  EXPECT_EQ(plan.job.log_folder, root / "report");
  EXPECT_TRUE(plan.job.pictures.empty());
  EXPECT_FALSE(fs::exists(root));  // a plan writes nothing
}

TEST_F(PlanMappingTest, QualityIsTheMappersEffort) {
  const MapperJob survey = Plan().job;
  EXPECT_EQ(Value(survey.first_round, "Mapper.ba_global_frames_ratio"), "1.4");
  EXPECT_EQ(Value(survey.first_round, "Mapper.ba_local_num_images"), "not given");
  EXPECT_FALSE(survey.global_round.has_value());
  const MapperJob field = Plan([](Options* options) { options->quality = "field"; }).job;
  EXPECT_EQ(Value(field.first_round, "Mapper.ba_global_frames_ratio"), "2");
  EXPECT_EQ(Value(field.later_rounds, "Mapper.ba_local_num_images"), "4");
  const MapperJob archive = Plan([](Options* options) { options->quality = "archive"; }).job;
  EXPECT_EQ(Value(archive.first_round, "Mapper.ba_global_frames_ratio"), "not given");
  EXPECT_FALSE(archive.global_round.has_value());
  for (const MapperJob& job : {survey, field, archive}) {
    EXPECT_EQ(job.lens, LensRule::kFind);
    EXPECT_TRUE(job.adjusts_principal_point);
    EXPECT_EQ(Value(job.first_round, "Mapper.num_threads"), "1");
    // The later rounds ask for less.
    EXPECT_EQ(Value(job.first_round, "Mapper.abs_pose_min_num_inliers"), "20");
    EXPECT_EQ(Value(job.later_rounds, "Mapper.abs_pose_min_num_inliers"), "15");
    EXPECT_EQ(Value(job.first_round, "Mapper.init_min_tri_angle"), "not given");
    EXPECT_EQ(Value(job.later_rounds, "Mapper.init_min_tri_angle"), "4");
  }
}

TEST_F(PlanMappingTest, FieldTriesTheGlobalMapperFirst) {
  const auto field = [](Options* options) {
    options->quality = "field";
    options->run.random_seed = 7;
  };
  const auto global = Plan(field).job.global_round;
  ASSERT_TRUE(global.has_value());
  EXPECT_EQ(*global,
            (MapperOptions{{"GlobalMapper.num_threads", "1"}, {"GlobalMapper.random_seed", "7"}}));
  // Not where the user's options are for the other mapper, nor where COLMAP has none.
  EXPECT_FALSE(Plan([&](Options* options) {
                 field(options);
                 options->mapper["Mapper.min_model_size"] = "4";
               }).job.global_round.has_value());
  EXPECT_FALSE(Plan([&](Options* options) {
                 field(options);
                 options->colmap_path = FAKE_COLMAP;
               }).job.global_round.has_value());
}

TEST_F(PlanMappingTest, AGivenLensIsHeldAndTheRestAdjusted) {
  const MapperJob job = Plan([](Options* options) {
                          options->quality = "field";
                          options->reader.camera_model = "SIMPLE_PINHOLE";
                          options->reader.camera_params = "480,200,150";
                        }).job;
  EXPECT_EQ(job.lens, LensRule::kHold);
  EXPECT_TRUE(job.thins_matches);
  EXPECT_FALSE(job.global_round.has_value());
  EXPECT_EQ(Value(job.first_round, "Mapper.ba_global_frames_ratio"), "2");
}

TEST_F(PlanMappingTest, WhatTheUserHasRefinedIsTheMappersOwn) {
  for (const char* params : {"", "480,480,200,150,0,0,0,0"}) {
    const MapperJob job = Plan([&](Options* options) {
                            options->quality = "field";
                            options->reader.camera_params = params;
                            options->mapper["Mapper.ba_refine_focal_length"] = "0";
                          }).job;
    EXPECT_EQ(job.lens, LensRule::kLeaveToMapper);
    EXPECT_FALSE(job.thins_matches);
    EXPECT_FALSE(job.global_round.has_value());
    EXPECT_EQ(Value(job.first_round, "Mapper.ba_global_frames_ratio"), "not given");
    EXPECT_EQ(Value(job.later_rounds, "Mapper.ba_local_num_images"), "not given");
  }
}

TEST_F(PlanMappingTest, TheUsersOptionsWinAndUnknownOnesAreRefused) {
  const MapperJob job = Plan([](Options* options) {
                          options->mapper["Mapper.num_threads"] = "8";
                          options->mapper["Mapper.abs_pose_min_num_inliers"] = "40";
                          options->run.random_seed = 3;
                          options->adjust_principal_point = false;
                        }).job;
  for (const MapperOptions& round : {job.first_round, job.later_rounds}) {
    EXPECT_EQ(Value(round, "Mapper.num_threads"), "8");
    EXPECT_EQ(Value(round, "Mapper.abs_pose_min_num_inliers"), "40");
    EXPECT_EQ(Value(round, "random_seed"), "3");
  }
  EXPECT_FALSE(job.adjusts_principal_point);
  const auto unknown = [](Options* options) { options->mapper["Mapper.min_model_sice"] = "3"; };
  EXPECT_USAGE_ERROR(Plan(unknown), "--Mapper.min_model_sice 3");
}

TEST_F(PlanMappingTest, WithoutColmapTheRemedyIsSaid) {
  const auto with = [](const std::string& path) {
    return [path](Options* options) { options->colmap_path = path; };
  };
  EXPECT_ERROR(Plan(with((folder_ / "absent").string())), "--colmap_path");
  EXPECT_ERROR(Plan(with("no_such_colmap")), "--colmap_path");
  EXPECT_ERROR(Plan(with("/bin/false")), "does not answer 'mapper -h' as COLMAP does");
}

class MapPicturesTest : public StripSurvey {
 protected:
  static constexpr int kNumPictures = 5;

  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(MatchPicturesOf(kNumPictures));
    fs::create_directories(Space().report);
    fs::copy_file(DatabasePath(), Space().database);
  }

  Workspace Space() const { return Workspace(Images().string(), (folder_ / "ws").string()); }

  Mapping Map(const Options& options, WorkspaceState* state) const {
    const ColmapDatabase database(Space().database, ColmapDatabase::Mode::kReadWrite);
    return MapPictures(PlanMapping(options, Space()), database, state);
  }
  // Maps with the stand-in; whether it was asked, as it would not have succeeded.
  bool IsDoneAgain(const Options& options, WorkspaceState* state) const {
    const FakeColmapMode crash("crash");
    try {
      Map(options, state);
    } catch (const Error&) {
      return true;
    }
    return false;
  }
};

TEST_F(MapPicturesTest, LeavesModelsOfAllMatchedPictures) {
  WorkspaceState state(Space().root);
  const Mapping mapping = Map(ReconstructorOptions(), &state);
  EXPECT_EQ(mapping.fingerprint.size(), 21u);
  ASSERT_EQ(mapping.seconds.size(), 1u);
  EXPECT_EQ(mapping.seconds[0].name, "mapper");
  EXPECT_GT(mapping.seconds[0].wall_seconds, 0);
  const SparseModel model = ReadSparseModel(Space().sparse / "0");
  EXPECT_EQ(model.images.size(), static_cast<size_t>(kNumPictures));
  EXPECT_GT(model.points3D.size(), 100u);
  EXPECT_FALSE(fs::exists(Space().sparse / "1"));
  EXPECT_FALSE(fs::exists(Space().sparse.string() + ".tmp"));
  EXPECT_TRUE(fs::exists(Space().report / "mapper_1_thinned.log"));
}

// A COLMAP that aborts on a table of pose priors, as 3.10 does on that of 4.2.1 and 4.2.1 on that
// of 3.10.
constexpr char kColmapWithoutPriors[] = R"sh(#!/bin/sh
for argument in "$@"; do
  if [ "$last" = --database_path ] && sqlite3 "$argument" .tables | grep -q pose_priors; then
    echo "SQLite error: SQL logic error"
    exit 134
  fi
  last=$argument
done
)sh";

TEST_F(MapPicturesTest, AnotherVersionsPosePriorsAreNotShownToTheMapper) {
  ExecuteSql(Space().database.string(),
             "CREATE TABLE pose_priors(image_id INTEGER PRIMARY KEY NOT NULL, position BLOB, "
             "coordinate_system INTEGER NOT NULL); INSERT INTO pose_priors VALUES(1, NULL, 1)");
  const fs::path colmap = folder_ / "colmap_without_priors";
  WriteBytes(colmap, kColmapWithoutPriors + std::string("exec '") + FAKE_COLMAP + "' \"$@\"\n");
  fs::permissions(colmap, fs::perms::owner_all);
  Options options = ReconstructorOptions();
  options.colmap_path = colmap.string();
  options.quality = "archive";  // maps all matches, without a thinned copy
  WorkspaceState state(Space().root);
  Map(options, &state);
  EXPECT_EQ(ReadSparseModel(Space().sparse / "0").images.size(), static_cast<size_t>(kNumPictures));
  EXPECT_EQ(QueryRows(Space().database.string(), "SELECT count(*) FROM pose_priors").front(), "1");
  EXPECT_FALSE(fs::exists(Space().sparse.string() + ".tmp.db"));
}

TEST_F(MapPicturesTest, MapsOnce) {
  WorkspaceState state(Space().root);
  const Mapping first = Map(ReconstructorOptions(), &state);
  const auto models = ReadTree(Space().sparse);
  Mapping second;
  const std::string log = LogOf([&] {
    const FakeColmapMode crash("crash");  // it is not even asked
    second = Map(ReconstructorOptions(), &state);
  });
  EXPECT_NE(log.find("are there already"), std::string::npos) << log;
  EXPECT_EQ(second.fingerprint, first.fingerprint);
  ASSERT_EQ(second.seconds.size(), 1u);
  EXPECT_EQ(second.seconds[0].wall_seconds, first.seconds[0].wall_seconds);
  EXPECT_EQ(ReadTree(Space().sparse), models);
}

TEST_F(MapPicturesTest, MapsAgainWhenTheDatabasesContentChanges) {
  WorkspaceState state(Space().root);
  const std::string first = Map(ReconstructorOptions(), &state).fingerprint;
  ExecuteSql(Space().database, "UPDATE cameras SET prior_focal_length = 1");
  EXPECT_TRUE(IsDoneAgain(ReconstructorOptions(), &state));
  EXPECT_NE(Map(ReconstructorOptions(), &state).fingerprint, first);
  EXPECT_FALSE(IsDoneAgain(ReconstructorOptions(), &state));
  // What the database was begun with tells of its matches.
  FinishStage({"database", "1", "other matches", ""}, nullptr, {}, &state);
  EXPECT_TRUE(IsDoneAgain(ReconstructorOptions(), &state));
}

TEST_F(MapPicturesTest, MapsAgainWhenOptionsChange) {
  const std::vector<std::function<void(Options*)>> changes = {
      [](Options* options) { options->mapper["Mapper.min_model_size"] = "4"; },
      [](Options* options) { options->adjust_principal_point = false; },
      [](Options* options) { options->join_models = false; },
      [](Options* options) { options->run.random_seed = 1; },
      [](Options* options) { options->reader.camera_params = "480,480,200,150,0,0,0,0"; },
  };
  WorkspaceState state(Space().root);
  Map(ReconstructorOptions(), &state);
  const std::string record = ReadBytes(Space().root / "state/mapper.json");
  for (size_t i = 0; i < changes.size(); ++i) {
    Options options = ReconstructorOptions();
    changes[i](&options);
    EXPECT_TRUE(IsDoneAgain(options, &state)) << i;
    WriteBytes(Space().root / "state/mapper.json", record);
  }
  // The rest of the chain's options are not the mapper's.
  Options options = ReconstructorOptions();
  options.densification.step = 9;
  options.run.num_threads = 1;
  EXPECT_FALSE(IsDoneAgain(options, &state));
}

TEST_F(MapPicturesTest, MapsAgainWhenAModelIsGone) {
  WorkspaceState state(Space().root);
  Map(ReconstructorOptions(), &state);
  fs::remove_all(Space().sparse / "0");
  Map(ReconstructorOptions(), &state);
  EXPECT_EQ(ReadSparseModel(Space().sparse / "0").images.size(), 5u);
}

TEST_F(MapPicturesTest, AMapperThatFailsIsTriedAgain) {
  WorkspaceState state(Space().root);
  {
    const FakeColmapMode mode("no_model");
    EXPECT_ERROR(Map(ReconstructorOptions(), &state), "the mapper found no model");
  }
  EXPECT_FALSE(state.Read("mapper").has_value());
  EXPECT_FALSE(fs::exists(Space().sparse));
  EXPECT_NO_THROW(Map(ReconstructorOptions(), &state));
}

TEST_F(MapPicturesTest, NoVerifiedPairIsAnErrorWithItsRemedy) {
  ExecuteSql(Space().database, "DELETE FROM two_view_geometries");
  WorkspaceState state(Space().root);
  const std::string error = ErrorOf([&] { Map(ReconstructorOptions(), &state); });
  EXPECT_EQ(error.rfind(Images().string() + ": no two of its pictures show the same place", 0), 0u)
      << error;
  EXPECT_NE(error.find("raise --SeaPointExtraction.max_num_features"), std::string::npos) << error;
  EXPECT_FALSE(state.Read("mapper").has_value());
  EXPECT_FALSE(fs::exists(Space().sparse));
}

}  // namespace
}  // namespace colmap_seapoint
