#include "colmap_seapoint/pipeline/scale_models.h"

#include <gtest/gtest.h>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "tests/expect_error.h"
#include "tests/pipeline/strip_survey.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr int kNumPictures = 3;  // of each model

// Models WS/sparse/<k> of the pictures <letter>1.png, <letter>2.png ..., without pictures.
class ScaleModelsTest : public StripSurvey {
 protected:
  Workspace Space() const { return Workspace(Images().string(), (folder_ / "ws").string()); }

  std::vector<ModelSummary> WriteModels(const std::string& letters) const {
    std::vector<ModelSummary> models;
    for (const char letter : letters) {
      ModelSummary model;
      model.name = std::to_string(models.size());
      model.path = Space().sparse / model.name;
      WriteSparseModelBinary(model.path, StripModel(kNumPictures, std::string(1, letter)));
      models.push_back(model);
    }
    return models;
  }

  // Places of the pictures of these models, `metres` apart.
  ModelScalerOptions Positions(const std::string& letters, int metres = 2) const {
    std::string text = "image,x,y,z\n";
    for (const char letter : letters) {
      for (int i = 1; i <= kNumPictures; ++i) {
        text += std::string(1, letter) + std::to_string(i) + ".png," + std::to_string(metres * i) +
                ",0,-5\n";
      }
    }
    ModelScalerOptions scaler;
    scaler.sources.positions_path = Write("positions.csv", text);
    return scaler;
  }

  RunReport Scale(const ModelScalerOptions& scaler, std::vector<ModelSummary>* models,
                  const std::string& mapper_fingerprint = "mapper",
                  const PictureRecords& records = {}) const {
    WorkspaceState state(Space().root);
    return ScaleAllModels(scaler, records, Space(), mapper_fingerprint, &state, models);
  }

  // As EXIF tells them: the pictures of model a lie `metres` apart to the east, and each `scatter`
  // metres off to the north or south in turn.
  static PictureRecords Gps(double metres, double scatter = 0) {
    PictureRecords records;
    records.gps.positions.is_geographic = true;
    records.gps.heights = "heights from the GPS altitude";
    for (int i = 1; i <= kNumPictures; ++i) {
      records.gps.positions.positions["a" + std::to_string(i) + ".png"] = {
          43 + (i % 2 == 0 ? scatter : -scatter) / 111'000, 5 + i * metres / 81'400, 3};
    }
    return records;
  }

  // Between the places of the first two pictures.
  double Spacing(int k) const {
    const SparseModel model = ReadSparseModel(Space().scaled / std::to_string(k));
    return (model.images[1].cam_from_world.OriginInSource() -
            model.images[0].cam_from_world.OriginInSource())
        .norm();
  }
  // Makes a scaled model older than it is; true as long as it was not made anew.
  void Mark(int k) const {
    fs::last_write_time(Space().scaled / std::to_string(k) / "images.bin", fs::file_time_type());
  }
  bool IsMarked(int k) const {
    return fs::last_write_time(Space().scaled / std::to_string(k) / "images.bin") ==
           fs::file_time_type();
  }
};

TEST_F(ScaleModelsTest, GpsOfThePicturesCountsWhereNothingElseIsGiven) {
  std::vector<ModelSummary> models = WriteModels("ab");
  const RunReport report = Scale({}, &models, "mapper", Gps(2));
  EXPECT_TRUE(report.left_out.empty());
  EXPECT_NEAR(Spacing(0), 2, 0.01);
  EXPECT_EQ(models[0].units_word, "metres");
  EXPECT_NE(models[0].units.find("EPSG:32631"), std::string::npos) << models[0].units;
  EXPECT_NE(models[0].scaling.find("from the GPS in the pictures"), std::string::npos);
  // The other model's pictures have none: it stays as it is, and says why.
  EXPECT_EQ(models[1].units_word, "arbitrary");
  EXPECT_NE(models[1].scaling.find("only 0 pictures"), std::string::npos) << models[1].scaling;
  EXPECT_EQ(models[1].path, Space().sparse / "1");
  // Again: taken as it is. Declined: gone.
  Mark(0);
  Scale({}, &models, "mapper", Gps(2));
  EXPECT_TRUE(IsMarked(0));
  ModelScalerOptions declined;
  declined.sources.positions_path = kNoPositions;
  models = WriteModels("ab");
  Scale(declined, &models, "mapper", Gps(2));
  EXPECT_EQ(models[0].units_word, "arbitrary");
  EXPECT_FALSE(fs::exists(Space().scaled));
}

TEST_F(ScaleModelsTest, GpsThatScattersTooMuchIsRefusedAndTheRunGoesOn) {
  std::vector<ModelSummary> models = WriteModels("a");
  const RunReport report = Scale({}, &models, "mapper", Gps(2, 30));
  EXPECT_EQ(models[0].units_word, "arbitrary");
  EXPECT_NE(models[0].scaling.find("the GPS in the pictures is not used"), std::string::npos)
      << models[0].scaling;
  EXPECT_TRUE(report.left_out.empty());
}

TEST_F(ScaleModelsTest, ALogOfAnotherDayIsLeftOutAndTheRunGoesOn) {
  std::vector<ModelSummary> models = WriteModels("a");
  ModelScalerOptions scaler;
  scaler.sources.nav = Write("log.csv",
                             "time,x,y,depth\n2024-05-01T12:00:00Z,0,0,1\n"
                             "2024-05-01T12:01:00Z,9,9,1\n");
  PictureRecords records;
  for (int i = 1; i <= kNumPictures; ++i) {
    records.times.push_back({"a" + std::to_string(i) + ".png", {1714900000.0 + i, true}});
  }
  const RunReport report = Scale(scaler, &models, "mapper", records);
  ASSERT_EQ(report.left_out.size(), 1u);
  EXPECT_NE(report.left_out[0].reason.find("of another time"), std::string::npos);
  EXPECT_EQ(models[0].units_word, "arbitrary");
}

TEST_F(ScaleModelsTest, WithoutSourcesNothingHappens) {
  std::vector<ModelSummary> models = WriteModels("ab");
  const RunReport report = Scale({}, &models);
  EXPECT_TRUE(report.stages.empty());
  EXPECT_TRUE(report.left_out.empty());
  EXPECT_FALSE(fs::exists(Space().scaled));
  for (const ModelSummary& model : models) {
    EXPECT_EQ(model.path, Space().sparse / model.name);
    EXPECT_EQ(model.units, "units arbitrary");
    EXPECT_EQ(model.units_word, "arbitrary");
    EXPECT_EQ(model.scaling, "");
    EXPECT_EQ(model.scaling_fingerprint, "");
  }
}

TEST_F(ScaleModelsTest, EveryModelIsScaledBesideTheMappers) {
  std::vector<ModelSummary> models = WriteModels("ab");
  const auto before = ReadTree(Space().sparse);
  const RunReport report = Scale(Positions("ab"), &models);
  EXPECT_TRUE(report.left_out.empty());
  ASSERT_EQ(report.stages.size(), 2u);
  EXPECT_EQ(report.stages[0].name, "model_scaler 0");
  EXPECT_EQ(report.stages[1].name, "model_scaler 1");
  for (const ModelSummary& model : models) {
    EXPECT_EQ(model.path, Space().scaled / model.name);
    EXPECT_EQ(model.units.rfind("metres, local", 0), 0u) << model.units;
    EXPECT_EQ(model.units_word, "metres");
    EXPECT_EQ(model.scaling.rfind("scale ", 0), 0u) << model.scaling;
    EXPECT_EQ(model.scaling_fingerprint.size(), 21u);
  }
  EXPECT_NEAR(Spacing(0), 2, 1e-6);
  EXPECT_NEAR(Spacing(1), 2, 1e-6);
  EXPECT_EQ(ReadTree(Space().sparse), before);
}

TEST_F(ScaleModelsTest, OneThatCannotBeScaledStaysAndIsNamed) {
  std::vector<ModelSummary> models = WriteModels("ab");
  const RunReport report = Scale(Positions("b"), &models);
  ASSERT_EQ(NamesOf(report.left_out), std::vector<std::string>{"scale of sparse/0"});
  EXPECT_EQ(report.left_out[0].reason.rfind("its units stay arbitrary: ", 0), 0u);
  EXPECT_NE(report.left_out[0].reason.find("none of its pictures is in the model"),
            std::string::npos)
      << report.left_out[0].reason;
  EXPECT_EQ(models[0].path, Space().sparse / "0");
  EXPECT_EQ(models[0].units_word, "arbitrary");
  EXPECT_EQ(models[0].scaling, "");
  EXPECT_FALSE(fs::exists(Space().scaled / "0"));
  EXPECT_EQ(models[1].path, Space().scaled / "1");
  EXPECT_EQ(models[1].units_word, "metres");
  EXPECT_NEAR(Spacing(1), 2, 1e-6);
}

TEST_F(ScaleModelsTest, OneThatCannotBeScaledAnyMoreLosesItsOldScale) {
  std::vector<ModelSummary> models = WriteModels("ab");
  Scale(Positions("ab"), &models);
  models = WriteModels("ab");
  const RunReport report = Scale(Positions("a"), &models);
  EXPECT_EQ(NamesOf(report.left_out), std::vector<std::string>{"scale of sparse/1"});
  EXPECT_EQ(models[1].path, Space().sparse / "1");
  EXPECT_FALSE(fs::exists(Space().scaled / "1"));
}

TEST_F(ScaleModelsTest, NoneThatCanBeScaledIsAnError) {
  std::vector<ModelSummary> models = WriteModels("ab");
  EXPECT_ERROR(Scale(Positions("c"), &models), "none of its pictures is in the model");
  EXPECT_EQ(models[0].path, Space().sparse / "0");
}

TEST_F(ScaleModelsTest, IsDoneOnce) {
  std::vector<ModelSummary> models = WriteModels("ab");
  const RunReport first = Scale(Positions("ab"), &models);
  const std::vector<ModelSummary> scaled = models;
  Mark(0);
  models = WriteModels("ab");
  RunReport second;
  const std::string log = LogOf([&] { second = Scale(Positions("ab"), &models); });
  EXPECT_NE(log.find("The scaled model in " + (Space().scaled / "1").string()), std::string::npos)
      << log;
  EXPECT_TRUE(IsMarked(0));
  ASSERT_EQ(second.stages.size(), 2u);
  EXPECT_EQ(second.stages[0].name, "model_scaler 0");
  EXPECT_EQ(second.stages[0].wall_seconds, first.stages[0].wall_seconds);
  for (size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(models[k].path, scaled[k].path);
    EXPECT_EQ(models[k].units, scaled[k].units);
    EXPECT_EQ(models[k].scaling, scaled[k].scaling);
    EXPECT_EQ(models[k].scaling_fingerprint, scaled[k].scaling_fingerprint);
  }
}

TEST_F(ScaleModelsTest, IsDoneAgainWhenItsInputsChange) {
  std::vector<ModelSummary> models = WriteModels("a");
  Scale(Positions("a"), &models);
  const std::string first = models[0].scaling_fingerprint;
  // The table's content, not its name.
  Mark(0);
  models = WriteModels("a");
  Scale(Positions("a", 3), &models);
  EXPECT_FALSE(IsMarked(0));
  EXPECT_NEAR(Spacing(0), 3, 1e-6);
  EXPECT_NE(models[0].scaling_fingerprint, first);
  // The models themselves.
  Mark(0);
  models = WriteModels("a");
  Scale(Positions("a", 3), &models, "another mapper");
  EXPECT_FALSE(IsMarked(0));
  // An output that is gone.
  Mark(0);
  fs::remove(Space().scaled / "0/scale.json");
  models = WriteModels("a");
  Scale(Positions("a", 3), &models, "another mapper");
  EXPECT_FALSE(IsMarked(0));
  EXPECT_TRUE(fs::exists(Space().scaled / "0/scale.json"));
}

// What was made of a model stays true when pictures come in whose positions agree with it.
TEST_F(ScaleModelsTest, AModelThatGrowsKeepsItsScaleWhereItMay) {
  const auto write = [&](int count) {
    std::vector<ModelSummary> models(1);
    models[0].name = "0";
    models[0].path = Space().sparse / "0";
    WriteSparseModelBinary(models[0].path, StripModel(count, "a"));
    return models;
  };
  // Every second picture `scatter` metres off, in an order that is not that of the strip.
  const auto positions = [&](int count, double scatter) {
    std::string text = "image,x,y,z\n";
    for (int i = 1; i <= count; ++i) {
      text += "a" + std::to_string(i) + ".png," + std::to_string(2 * i) + "," +
              std::to_string(i % 3 == 0 ? scatter : -scatter) + ",-5\n";
    }
    ModelScalerOptions scaler;
    scaler.sources.positions_path = Write("positions.csv", text);
    return scaler;
  };
  const auto first_pose = [&] {
    const Rigid3d pose = ReadSparseModel(Space().scaled / "0").images[0].cam_from_world;
    return std::make_pair(pose.translation, pose.rotation.coeffs());
  };
  std::vector<ModelSummary> models = write(8);
  Scale(positions(8, 0.02), &models);
  const auto before = first_pose();
  models = write(10);
  Scale(positions(10, 0.02), &models, "grown");
  EXPECT_EQ(first_pose(), before);
  EXPECT_NE(models[0].scaling.find("as before pictures came in"), std::string::npos)
      << models[0].scaling;
  // Done again, as after damage: the same bytes.
  const std::string bytes = ReadBytes(Space().scaled / "0/images.bin");
  fs::remove(Space().scaled / "0/images.bin");
  models = write(10);
  Scale(positions(10, 0.02), &models, "grown");
  EXPECT_EQ(ReadBytes(Space().scaled / "0/images.bin"), bytes);
  // A table that is corrected counts.
  models = write(10);
  Scale(positions(10, 0.021), &models, "grown");
  EXPECT_NE(first_pose(), before);
}

TEST_F(ScaleModelsTest, WithoutSourcesTheFolderGoes) {
  std::vector<ModelSummary> models = WriteModels("ab");
  Scale(Positions("ab"), &models);
  models = WriteModels("ab");
  Scale({}, &models);
  EXPECT_FALSE(fs::exists(Space().scaled));
  EXPECT_EQ(models[1].path, Space().sparse / "1");
  EXPECT_EQ(models[1].units_word, "arbitrary");
  // What is not ours stays.
  models = WriteModels("ab");
  Scale(Positions("ab"), &models);
  WriteBytes(Space().scaled / "notes.txt", "mine");
  models = WriteModels("ab");
  Scale({}, &models);
  EXPECT_EQ(ReadTree(Space().scaled), (std::map<std::string, std::string>{{"notes.txt", "mine"}}));
}

TEST_F(ScaleModelsTest, ModelsThatAreNotFoundAnyMoreGo) {
  std::vector<ModelSummary> models = WriteModels("abc");
  Scale(Positions("abc"), &models);
  models.resize(1);
  models[0].path = Space().sparse / "0";
  Scale(Positions("abc"), &models);
  EXPECT_TRUE(fs::exists(Space().scaled / "0"));
  EXPECT_FALSE(fs::exists(Space().scaled / "1"));
  EXPECT_FALSE(fs::exists(Space().scaled / "2"));
}

// Between two models that were scaled, one could not be.
TEST_F(ScaleModelsTest, WithoutSourcesTheFolderGoesWhateverFailedInIt) {
  std::vector<ModelSummary> models = WriteModels("abc");
  EXPECT_EQ(NamesOf(Scale(Positions("ac"), &models).left_out),
            std::vector<std::string>{"scale of sparse/1"});
  ASSERT_TRUE(fs::exists(Space().scaled / "2/images.bin"));
  models = WriteModels("abc");
  Scale({}, &models);
  EXPECT_FALSE(fs::exists(Space().scaled));
}

TEST_F(ScaleModelsTest, LeftOutIsWhatNoModelCouldUse) {
  const auto with_bar = [&](const std::string& marks) {
    ModelScalerOptions scaler = Positions("ab");
    scaler.sources.scale_bars_path = Write("bars.csv", "name1,name2,length_m,sigma_m\np,q,1,0.5\n");
    scaler.sources.targets_path = Write("targets.csv", "target,image,x,y\n" + marks);
    return scaler;
  };
  // In each model marked once only: nothing to triangulate.
  std::vector<ModelSummary> models = WriteModels("ab");
  RunReport report =
      Scale(with_bar("p,a1.png,200,100\nq,a1.png,300,200\np,b1.png,200,100\nq,b1.png,300,200\n"),
            &models);
  EXPECT_EQ(NamesOf(report.left_out), std::vector<std::string>{"scale bar p - q"});
  // In the first model twice: a place of the ground moves by a step from picture to picture.
  models = WriteModels("ab");
  report = Scale(with_bar("p,a1.png,200,100\np,a2.png,110,100\nq,a1.png,300,200\n"
                          "q,a2.png,210,200\n"),
                 &models);
  EXPECT_EQ(NamesOf(report.left_out), std::vector<std::string>());
}

}  // namespace
}  // namespace colmap_seapoint
