#include "colmap_seapoint/pipeline/densify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>

#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "colmap_seapoint/io/files/model_units.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/expect_error.h"
#include "tests/pipeline/strip_survey.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

constexpr int kNumPictures = 4;

class DensifyModelTest : public StripSurvey {
 protected:
  void SetUp() override {
    WritePictures(kNumPictures);
    WriteSparseModelBinary(folder_ / "model", StripModel(kNumPictures));
  }

  PartialDensifierOptions Options(const std::string& output = "out") const {
    return DensifierOptions("model", output);
  }
  // So many matches no pair has.
  static PartialDensifierOptions WithoutPoints(PartialDensifierOptions options) {
    options.densification.min_num_seeds = 100000;
    return options;
  }
  std::set<std::string> Files(const std::string& output = "out") const {
    std::set<std::string> names;
    for (const auto& [name, bytes] : ReadTree(folder_ / output)) names.insert(name);
    return names;
  }
};

TEST_F(DensifyModelTest, WritesCloudTableUnitsAndReport) {
  const RunReport report = DensifyModel(Options(), nullptr);
  EXPECT_EQ(Files(), (std::set<std::string>{".colmap_seapoint", "fused.ply", "fused.ply.vis",
                                            "pairs.csv", "run.json", "units.json"}));
  EXPECT_EQ(report.command, "partial_densifier");
  EXPECT_EQ(report.images_in, kNumPictures);
  EXPECT_EQ(report.images_used, kNumPictures);
  EXPECT_EQ(report.units, "arbitrary");
  EXPECT_TRUE(report.left_out.empty());
  EXPECT_GE(report.pairs, 2);
  ASSERT_EQ(report.stages.size(), 1u);
  EXPECT_EQ(report.stages[0].name, "partial_densifier");
  // Pictures in the model's order, then the model's files.
  ASSERT_EQ(report.inputs.size(), static_cast<size_t>(kNumPictures + 3));
  EXPECT_EQ(report.inputs[0].name, "img1.png");
  EXPECT_EQ(report.inputs[kNumPictures].name, (folder_ / "model/cameras.bin").string());
  for (const RunReport::Input& input : report.inputs) EXPECT_EQ(input.hash.size(), 21u);
  const auto cloud = ReadCloud(folder_ / "out/fused.ply");
  EXPECT_EQ(static_cast<int64_t>(cloud.size()), report.points);
  EXPECT_GT(cloud.size(), 3000u);
  const auto json = nlohmann::json::parse(ReadBytes(folder_ / "out/run.json"));
  EXPECT_EQ(json["points"], report.points);
  EXPECT_EQ(json["pairs"], report.pairs);
}

TEST_F(DensifyModelTest, NoPointLiesInAMask) {
  const SparseModel model = StripModel(kNumPictures);
  const Camera& camera = model.cameras.begin()->second;
  // What hangs in view of the camera, in the same place of every picture.
  GrayImage mask(camera.width, camera.height, 1, 255);
  for (int y = mask.height / 3; y < mask.height; ++y) {
    std::fill(mask.Row(y) + mask.width / 4, mask.Row(y) + mask.width / 2, uint8_t{0});
  }
  fs::create_directories(folder_ / "masks");
  for (const PosedImage& image : model.images) {
    WriteImage(folder_ / "masks" / (image.name + ".png"), mask);
  }
  // The two pictures that fused.ply.vis names for each point.
  const auto num_hidden = [&](const fs::path& cloud_path) {
    const std::string vis = ReadBytes(cloud_path.string() + ".vis");
    const auto cloud = ReadCloud(cloud_path);
    size_t num = 0;
    for (size_t i = 0; i < cloud.size(); ++i) {
      for (size_t k = 0; k < 2; ++k) {
        uint32_t image_idx = 0;
        std::memcpy(&image_idx, vis.data() + 8 + 12 * i + 4 + 4 * k, 4);
        const auto pixel = camera.ImgFromCam(model.images.at(image_idx).cam_from_world *
                                             cloud[i].xyz.cast<double>());
        num += pixel && camera.InImage(*pixel) &&
               mask.At(static_cast<int>(pixel->x()), static_cast<int>(pixel->y())) == 0;
      }
    }
    return num;
  };
  DensifyModel(Options("all"), nullptr);
  EXPECT_GT(num_hidden(folder_ / "all/fused.ply"), 500u);
  PartialDensifierOptions options = Options();
  options.mask_path = (folder_ / "masks").string();
  const RunReport report = DensifyModel(options, nullptr);
  EXPECT_EQ(num_hidden(folder_ / "out/fused.ply"), 0u);
  EXPECT_GT(report.points, 2000);
  // A mask of other proportions leaves its picture out, and says so.
  WriteImage(folder_ / "masks/img2.png.png", GrayImage(10, 90, 1, 255));
  options.output_path = (folder_ / "again").string();
  const RunReport again = DensifyModel(options, nullptr);
  EXPECT_EQ(NamesOf(again.left_out), Names{"img2.png"});
  EXPECT_NE(again.left_out.at(0).reason.find("mask"), std::string::npos);
}

TEST_F(DensifyModelTest, PointsLieOnTheGround) {
  DensifyModel(Options(), nullptr);
  size_t num_near = 0;
  const auto cloud = ReadCloud(folder_ / "out/fused.ply");
  for (const CloudPoint& point : cloud) {
    num_near += std::abs(point.xyz.z() - kStripRange) < 0.005 * kStripRange ? 1 : 0;
    EXPECT_LT(point.normal.z(), 0);  // towards the cameras
  }
  EXPECT_GT(static_cast<double>(num_near), 0.99 * static_cast<double>(cloud.size()));
}

TEST_F(DensifyModelTest, TheSameBytesForAnyNumberOfThreads) {
  PartialDensifierOptions options = Options("one");
  options.run.num_threads = 1;
  DensifyModel(options, nullptr);
  options.output_path = (folder_ / "three").string();
  options.run.num_threads = 3;
  DensifyModel(options, nullptr);
  for (const char* name : {"fused.ply", "fused.ply.vis", "units.json"}) {
    EXPECT_TRUE(ReadBytes(folder_ / "one" / name) == ReadBytes(folder_ / "three" / name)) << name;
  }
}

TEST_F(DensifyModelTest, UnitsAreThoseOfTheModel) {
  ModelUnits units;
  units.is_metric = true;
  units.frame = "local";
  WriteModelUnits(folder_ / "model", units);
  EXPECT_EQ(DensifyModel(Options(), nullptr).units, "metres");
  const auto found = ReadModelUnits(folder_ / "out");
  ASSERT_TRUE(found.has_value());
  EXPECT_TRUE(found->is_metric);
  EXPECT_EQ(found->frame, "local");
}

TEST_F(DensifyModelTest, SeaPointsOfTheDatabaseAreTaken) {
  ASSERT_NO_FATAL_FAILURE(MatchPicturesOf(kNumPictures));
  PartialDensifierOptions options = Options();
  options.database_path = DatabasePath().string();
  ColmapDatabase database = OpenDatabase();
  std::string log;
  RunReport report;
  log = LogOf([&] { report = DensifyModel(options, &database); });
  EXPECT_EQ(log.find("holds SeaPoints of no picture"), std::string::npos) << log;
  EXPECT_GT(report.points, 3000);
  // Pairs that were tried there in vain are not tried again.
  TwoViewGeometry unverified;
  unverified.config = TwoViewConfig::kDegenerate;
  for (uint32_t id1 = 1; id1 <= kNumPictures; ++id1) {
    for (uint32_t id2 = id1 + 1; id2 <= kNumPictures; ++id2) {
      WriteMatches(&database, id1, id2, {}, unverified);
    }
  }
  EXPECT_EQ(DensifyModel(options, &database).points, 0);
}

TEST_F(DensifyModelTest, ADatabaseOfOtherPicturesIsNoHelp) {
  ColmapDatabase database = OpenDatabase();
  PartialDensifierOptions options = Options();
  options.database_path = DatabasePath().string();
  RunReport report;
  const std::string log = LogOf([&] { report = DensifyModel(options, &database); });
  EXPECT_NE(log.find("survey.db holds SeaPoints of no picture of the model"), std::string::npos)
      << log;
  EXPECT_GT(report.points, 3000);
}

TEST_F(DensifyModelTest, UnreadablePicturesAreNamed) {
  WriteBytes(Images() / "img4.png", "");
  const RunReport report = DensifyModel(Options(), nullptr);
  EXPECT_EQ(NamesOf(report.left_out), Names{"img4.png"});
  EXPECT_EQ(report.images_in, kNumPictures);
  EXPECT_EQ(report.images_used, kNumPictures - 1);
  EXPECT_GT(report.points, 0);
  EXPECT_FALSE(RunPartialDensifier(Options("again")).is_complete);
}

TEST_F(DensifyModelTest, ForeignPicturesAreSeenBeforeTheWork) {
  fs::remove_all(Images());
  WriteStrip(Images(), 1, "a");
  const std::string error = ErrorOf([&] { DensifyModel(Options(), nullptr); });
  EXPECT_NE(error.find("none of the model's 4 pictures can be used (img1.png: "), std::string::npos)
      << error;
  EXPECT_EQ(Files().count("run.json"), 0u);
}

TEST_F(DensifyModelTest, ModelsThatCannotBeDensified) {
  SparseModel model = StripModel(kNumPictures);
  model.cameras[1] =
      MakeCamera(CameraModel::kEquirectangular, kStripWidth, kStripWidth, kStripHeight);
  model.cameras[1].camera_id = 1;
  WriteSparseModelBinary(folder_ / "model", model);
  EXPECT_ERROR(DensifyModel(Options(), nullptr), "camera 1 is EQUIRECTANGULAR");
  WriteSparseModelBinary(folder_ / "model", SparseModel());
  EXPECT_ERROR(DensifyModel(Options(), nullptr), "the model holds no pictures");
  fs::remove_all(folder_ / "model");
  EXPECT_ERROR(DensifyModel(Options(), nullptr), "model");
}

TEST_F(DensifyModelTest, OptionsAreCheckedBeforeTheWork) {
  PartialDensifierOptions options = Options();
  options.densification.window_size = 8;
  EXPECT_USAGE_ERROR(DensifyModel(options, nullptr), "window_size is 8");
  options = Options();
  options.rig = "one";
  EXPECT_USAGE_ERROR(RunPartialDensifier(options), "LEFT,RIGHT");
  options = Options();
  options.extraction.max_num_features = options.extraction.min_num_features - 1;
  EXPECT_USAGE_ERROR(RunPartialDensifier(options), "max_num_features");
  options = Options();
  options.image_path = (folder_ / "absent").string();
  EXPECT_ERROR(DensifyModel(options, nullptr), "check --image_path");
  options = DensifierOptions("model", ".");
  options.densification.write_maps = true;
  EXPECT_ERROR(DensifyModel(options, nullptr), "would write undistorted pictures over yours");
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(DensifyModelTest, NoPointIsAReportThatSaysWhy) {
  const RunReport report = DensifyModel(WithoutPoints(Options()), nullptr);
  EXPECT_EQ(report.points, 0);
  EXPECT_EQ(report.pairs, 0);
  EXPECT_EQ(report.images_used, 0);
  EXPECT_EQ(Files(),
            (std::set<std::string>{".colmap_seapoint", "pairs.csv", "run.json", "units.json"}));
  // Every row ends with a reason.
  std::istringstream rows(ReadBytes(folder_ / "out/pairs.csv"));
  std::string row;
  std::getline(rows, row);
  int num_rows = 0;
  for (; std::getline(rows, row); ++num_rows) EXPECT_NE(row.back(), ',') << row;
  EXPECT_GT(num_rows, 0);
  EXPECT_ERROR(RunPartialDensifier(WithoutPoints(Options())), "out/pairs.csv");
}

TEST_F(DensifyModelTest, PicturesOfAnotherResolutionScaleTheCameras) {
  for (int i = 1; i <= kNumPictures; ++i) {
    const ColorImage whole = StripPicture(i);
    ColorImage half(kStripWidth / 2, kStripHeight / 2, 3);
    for (int y = 0; y < half.height; ++y) {
      for (int x = 0; x < half.width; ++x) {
        for (int c = 0; c < 3; ++c) half.At(x, y, c) = whole.At(2 * x, 2 * y, c);
      }
    }
    WriteImage(Images() / ("img" + std::to_string(i) + ".png"), half);
  }
  RunReport report;
  const std::string log = LogOf([&] { report = DensifyModel(Options(), nullptr); });
  EXPECT_NE(log.find("4 pictures are of another resolution"), std::string::npos) << log;
  EXPECT_TRUE(report.left_out.empty());
  EXPECT_GT(report.points, 500);
  for (const CloudPoint& point : ReadCloud(folder_ / "out/fused.ply")) {
    EXPECT_NEAR(point.xyz.z(), kStripRange, 0.1 * kStripRange);
  }
}

TEST_F(DensifyModelTest, MapsAreAStageOfTheirOwn) {
  PartialDensifierOptions options = Options();
  options.densification.write_maps = true;
  const RunReport report = DensifyModel(options, nullptr);
  ASSERT_EQ(report.stages.size(), 2u);
  EXPECT_EQ(report.stages[0].name, "partial_densifier");
  EXPECT_EQ(report.stages[1].name, "write_maps");
  EXPECT_EQ(Files().count("stereo/fusion.cfg"), 1u);
  EXPECT_EQ(Files().count("images/img3.png"), 1u);
  // Without a point there is nothing to draw.
  PartialDensifierOptions nothing = WithoutPoints(options);
  nothing.output_path = (folder_ / "nothing").string();
  EXPECT_EQ(DensifyModel(nothing, nullptr).stages.size(), 1u);
  EXPECT_EQ(Files("nothing").count("stereo/fusion.cfg"), 0u);
}

class SideBySide : public DensifyModelTest {
 protected:
  // sparse/0 of the pictures a1 ... , sparse/1 of b1 ...
  void SetUp() override {
    WriteStrip(Images(), 3, "a");
    WriteSparseModelBinary(folder_ / "sparse/0", StripModel(3, "a"));
    WriteStrip(Images(), 3, "b");
    WriteSparseModelBinary(folder_ / "sparse/1", StripModel(3, "b"));
  }
  PartialDensifierOptions Options() const { return DensifierOptions("sparse", "dense"); }
};

TEST_F(SideBySide, EachModelGetsAFolderOfItsName) {
  EXPECT_TRUE(RunPartialDensifier(Options()).is_complete);
  for (const char* model : {"0", "1"}) {
    const auto json = nlohmann::json::parse(ReadBytes(folder_ / "dense" / model / "run.json"));
    EXPECT_EQ(json["options"]["input_path"], (folder_ / "sparse" / model).string());
    EXPECT_EQ(ReadCloud(folder_ / "dense" / model / "fused.ply").size(), json["points"]);
  }
  EXPECT_FALSE(fs::exists(folder_ / "dense/fused.ply"));
}

TEST_F(SideBySide, AModelWithoutAPointIsLeftOut) {
  WriteSparseModelBinary(folder_ / "sparse/1", StripModel(1, "b"));
  CommandResult result;
  const std::string log = LogOf([&] { result = RunPartialDensifier(Options()); });
  EXPECT_FALSE(result.is_complete);
  EXPECT_NE(log.find((folder_ / "sparse/1").string() + " is left out"), std::string::npos) << log;
  EXPECT_TRUE(fs::exists(folder_ / "dense/0/fused.ply"));
  EXPECT_FALSE(fs::exists(folder_ / "dense/1/fused.ply"));
  EXPECT_TRUE(fs::exists(folder_ / "dense/1/pairs.csv"));
}

TEST_F(SideBySide, NoPointInAnyModelIsAnError) {
  EXPECT_ERROR(RunPartialDensifier(WithoutPoints(Options())),
               "no pair of any of its models gave a point");
}

}  // namespace
}  // namespace colmap_seapoint
