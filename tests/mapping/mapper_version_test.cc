// kMapperVersion's guard: a hash of what the mapping decides. When it fails because a result has
// changed on purpose, raise kMapperVersion, and set both constants at the end anew.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/mapping/run_mapper.h"
#include "tests/io/test_files.h"
#include "tests/mapping/exact_survey.h"
#include "tests/mapping/scripted_colmap.h"
#include "tests/mapping/survey_database.h"

namespace colmap_seapoint {
namespace {

// Every option that we know of, so that none of our defaults is left out of the hash.
ColmapProgram ProgramThatKnows(const std::vector<std::string>& names) {
  ColmapProgram program;
  program.path = "colmap";
  program.has_global_mapper = true;
  program.mapper_options = names;
  std::sort(program.mapper_options.begin(), program.mapper_options.end());
  return program;
}

const std::vector<std::string> kEveryOption = {"random_seed",
                                               "Mapper.random_seed",
                                               "Mapper.num_threads",
                                               "Mapper.abs_pose_min_num_inliers",
                                               "Mapper.abs_pose_min_inlier_ratio",
                                               "Mapper.min_model_size",
                                               "Mapper.init_min_num_inliers",
                                               "Mapper.init_min_tri_angle",
                                               "Mapper.tri_ignore_two_view_tracks",
                                               "Mapper.ba_global_images_ratio",
                                               "Mapper.ba_global_frames_ratio",
                                               "Mapper.ba_global_points_ratio",
                                               "Mapper.ba_global_max_refinements",
                                               "Mapper.ba_global_max_num_iterations",
                                               "Mapper.ba_local_max_refinements",
                                               "Mapper.ba_local_max_num_iterations",
                                               "Mapper.ba_local_num_images",
                                               "GlobalMapper.num_threads",
                                               "GlobalMapper.random_seed"};

std::string TextOf(const MapperOptions& options) {
  std::string text;
  for (const auto& [name, value] : options) text += name + "=" + value + "\n";
  return text;
}

std::string AllOptionSets() {
  const ColmapProgram colmap = ProgramThatKnows(kEveryOption);
  std::string text = TextOf(*OptionsOfGlobalMapper(colmap, 3));
  for (const Round round : {Round::kFirst, Round::kLater}) {
    for (const char* effort : {"field", "survey", "archive"}) {
      text += std::string(effort) + "\n" + TextOf(OptionsOfRound(colmap, round, effort, 3, {}));
    }
  }
  return text;
}

// To thousandths of a pixel, or millionths: another processor's last bits do not count.
std::string TextOf(const std::vector<double>& params) {
  std::string text;
  for (size_t i = 0; i < params.size(); ++i) {
    char number[32];
    std::snprintf(number, sizeof(number), i < 4 ? "%.3f " : "%.6f ", params[i]);
    text += number;
  }
  return text;
}

// Pixels that are off by fractions of one, and every fiftieth by more: the lens then depends on how
// its errors are weighed.
void AddErrors(SparseModel* model) {
  for (PosedImage& image : model->images) {
    for (size_t i = 0; i < image.points2D.size(); ++i) {
      const double phase = 1.7 * static_cast<double>(i) + image.image_id;
      const double size = i % 50 == 0 ? 6 : 0.3;
      image.points2D[i] += size * Eigen::Vector2d(std::sin(phase), std::cos(3 * phase));
    }
  }
}

// A first round that leaves a picture over, a second trial with a free distortion, a later round:
// which calls that makes, which models are taken, and which lens and points they end with.
std::string Rounds() {
  TempDir dir;
  ScriptedColmap colmap(dir / "bin");
  SparseModel survey = ExactSurvey(ExactLens(), 4);
  AddErrors(&survey);
  SparseModel part = survey;
  part.images.pop_back();
  for (auto& [id, point] : part.points3D) {
    if (!point.track.empty() && point.track.back().image_id == 8) point.track.pop_back();
  }
  colmap.Leaves("mapper", 1, "0", Disturbed(part));
  colmap.Leaves("mapper", 2, "0", Disturbed(survey));
  std::filesystem::create_directories(dir / "logs");
  MapperJob job;
  job.database_path = dir / "database.db";
  WriteSurveyDatabase(survey, job.database_path);
  job.image_path = dir / "images";
  WriteTinyPictures(survey, job.image_path);
  job.output_path = dir / "sparse";
  job.log_folder = dir / "logs";
  for (const PosedImage& image : survey.images) job.pictures.push_back(image.name);
  RunMapper(colmap.Program(), job);

  std::string text;
  for (const char* command : {"mapper", "point_triangulator"}) {
    for (int call = 1; call <= colmap.NumCalls(command); ++call) {
      for (const std::string& argument : colmap.Arguments(command, call)) {
        if (argument.find(dir.Path().string()) == std::string::npos) text += argument + " ";
      }
    }
  }
  const SparseModel model = ReadSparseModel(job.output_path / "0");
  return text + std::to_string(model.images.size()) + "\n" + TextOf(model.cameras.at(1).params);
}

constexpr char kVersionOfTheHash[] = "16";  // to be raised together with the hash
constexpr char kHash[] = "xxh3-c4d861c307b0ae8b";

TEST(MapperVersionTest, TheSameDecisionsAsWhenTheVersionWasGiven) {
  EXPECT_STREQ(kMapperVersion, kVersionOfTheHash);
  const std::string decisions = AllOptionSets() + Rounds();
  EXPECT_EQ(HashText(decisions), kHash) << "of:\n" << decisions;
}

}  // namespace
}  // namespace colmap_seapoint
