// orthomosaic as a user runs it: on an exact survey, on the Earth and off it, and on bad input.
#include <gdal.h>
#include <gtest/gtest.h>
#include <ogr_srs_api.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "colmap_seapoint/base/similarity3.h"
#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/model_units.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr int kNumPictures = 5;
constexpr double kGsd = kStripRange / (1.2 * kStripWidth);
const Eigen::Vector3d kOffset(530000, 5950000, -20);

struct DatasetCloser {
  void operator()(void* dataset) const { GDALClose(dataset); }
};
using Dataset = std::unique_ptr<void, DatasetCloser>;

// A strip over flat ground, and the cloud of its ground: one point a pixel. The strip's z is down;
// the model's is up.
class OrthomosaicCommand : public testing::Test {
 protected:
  void SetUp() override {
    GDALAllRegister();
    WriteStrip(folder_ / "images", kNumPictures);
    model_ = StripModel(kNumPictures);
    Similarity3d upright;
    upright.rotation = Eigen::Quaterniond(0, 1, 0, 0);
    TransformModel(upright, &model_);
    WriteSparseModelBinary(folder_ / "model", model_);
    WriteCloud({0, 0, 0});
  }

  // From the first picture's left border to the last one's right, at z = -kStripRange.
  void WriteCloud(const Eigen::Vector3d& shift) const {
    CloudWriter cloud(folder_ / "fused.ply");
    const int width = kStripWidth + (kNumPictures - 1) * kStripStep;
    for (int y = 0; y < kStripHeight; ++y) {
      for (int x = 0; x < width; ++x) {
        CloudPoint point;
        const Eigen::Vector3d place((x + kStripStep + 0.5 - 0.5 * kStripWidth) * kGsd,
                                    (0.5 * kStripHeight - y - 0.5) * kGsd, -kStripRange);
        point.xyz = (place + shift).cast<float>();
        point.normal = {0, 0, 1};
        cloud.Add(point, nullptr, 0);
      }
    }
    cloud.Finish();
  }

  void PlaceOnEarth(const std::string& crs = "EPSG:32755") const {
    ModelUnits units;
    units.is_metric = true;
    units.frame = "projected";
    units.crs = crs;
    units.offset = kOffset;
    WriteModelUnits(folder_ / "model", units);
  }

  CliResult Make(const std::vector<std::string>& more = {}, const std::string& output = "out",
                 const CliOptions& options = {}) const {
    std::vector<std::string> arguments = {"orthomosaic",
                                          "--image_path",
                                          (folder_ / "images").string(),
                                          "--input_path",
                                          (folder_ / "model").string(),
                                          "--cloud_path",
                                          (folder_ / "fused.ply").string(),
                                          "--output_path",
                                          (folder_ / output).string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(SEAPOINT_PROGRAM, arguments, options);
  }

  void ExpectFailure(const CliResult& result, int exit_code, const std::string& words) const {
    EXPECT_EQ(result.exit_code, exit_code) << result.Text();
    EXPECT_NE(result.LastErrorLine().find(words), std::string::npos) << result.Text();
  }

  Dataset Open(const std::string& name) const {
    return Dataset(GDALOpen((folder_ / "out" / name).c_str(), GA_ReadOnly));
  }
  static float Value(const Dataset& dataset, int band, int x, int y) {
    float value = 0;
    EXPECT_EQ(GDALRasterIO(GDALGetRasterBand(dataset.get(), band), GF_Read, x, y, 1, 1, &value, 1,
                           1, GDT_Float32, 0, 0),
              CE_None);
    return value;
  }
  Json Description() const { return Json::parse(ReadBytes(folder_ / "out" / "map.json")); }

  TemporaryFolder folder_;
  SparseModel model_;
};

TEST_F(OrthomosaicCommand, LiesWhereItIsOnTheEarth) {
  PlaceOnEarth();
  const CliResult result = Make();
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_NE(result.out.find("north is up"), std::string::npos) << result.out;
  for (const char* name : {"orthomosaic.tif", "dem.tif", "source.tif", "surface.tif"}) {
    const Dataset raster = Open(name);
    ASSERT_NE(raster, nullptr) << name;
    double transform[6];
    ASSERT_EQ(GDALGetGeoTransform(raster.get(), transform), CE_None);
    EXPECT_NEAR(transform[1], kGsd, 1e-12) << name;
    EXPECT_NEAR(transform[5], -kGsd, 1e-12) << name;
    // The strip's left border, and a fiftieth of its length more.
    const double length = (kStripWidth + (kNumPictures - 1) * kStripStep) * kGsd;
    EXPECT_NEAR(transform[0], kOffset.x() + (kStripStep - 0.5 * kStripWidth) * kGsd - 0.02 * length,
                3 * kGsd);
    const OGRSpatialReferenceH crs = GDALGetSpatialRef(raster.get());
    ASSERT_NE(crs, nullptr) << name;
    EXPECT_STREQ(OSRGetAuthorityCode(crs, nullptr), "32755") << name;
    EXPECT_STREQ(GDALGetMetadataItem(raster.get(), "LAYOUT", "IMAGE_STRUCTURE"), "COG") << name;
  }
  EXPECT_FALSE(fs::exists(folder_ / "out" / "orthomosaic.tfw"));
  EXPECT_TRUE(fs::exists(folder_ / "out" / "hillshade.pgw"));
}

TEST_F(OrthomosaicCommand, HeightsColoursAndSourcesAreThoseOfTheStrip) {
  PlaceOnEarth();
  ASSERT_EQ(Make().exit_code, 0);
  const Dataset colors = Open("orthomosaic.tif"), heights = Open("dem.tif"),
                sources = Open("source.tif"), surface = Open("surface.tif");
  double transform[6];
  GDALGetGeoTransform(colors.get(), transform);
  EXPECT_STREQ(GDALGetRasterUnitType(GDALGetRasterBand(heights.get(), 1)), "metre");
  EXPECT_EQ(GDALGetRasterNoDataValue(GDALGetRasterBand(heights.get(), 1), nullptr), -9999);
  std::vector<std::string> labels = {""};
  std::istringstream table(ReadBytes(folder_ / "out" / "source.csv"));
  std::string line;
  std::getline(table, line);
  EXPECT_EQ(line, "label,name,used");
  for (int i = 1; std::getline(table, line); ++i) {
    EXPECT_EQ(line, std::to_string(i) + ",img" + std::to_string(i) + ".png,1");
  }
  double error = 0;
  int count = 0;
  for (int y = 20; y + 20 < GDALGetRasterYSize(colors.get()); y += 17) {
    for (int x = 40; x + 40 < GDALGetRasterXSize(colors.get()); x += 17) {
      ASSERT_EQ(Value(colors, 4, x, y), 255) << x << " " << y;
      EXPECT_NEAR(Value(heights, 1, x, y), kOffset.z() - kStripRange, 1e-4);
      EXPECT_EQ(Value(surface, 1, x, y), 1);
      const auto label = static_cast<int>(Value(sources, 1, x, y));
      ASSERT_TRUE(label >= 1 && label <= kNumPictures);
      const PosedImage& image = model_.images[static_cast<size_t>(label - 1)];
      const Eigen::Vector3d place(transform[0] + (x + 0.5) * kGsd - kOffset.x(),
                                  transform[3] - (y + 0.5) * kGsd - kOffset.y(), -kStripRange);
      const auto pixel =
          model_.cameras.at(image.camera_id).ImgFromCam(image.cam_from_world * place);
      ASSERT_TRUE(pixel && model_.cameras.at(image.camera_id).InImage(*pixel));
      const ColorImage picture = StripPicture(label);
      const auto px = static_cast<int>(pixel->x() - 0.5), py = static_cast<int>(pixel->y() - 0.5);
      // Between these four pixels, up to the blend of pictures that show the same.
      float least = 255, most = 0;
      for (int k = 0; k < 4; ++k) {
        const float value = picture.At(std::min(px + k % 2, kStripWidth - 1),
                                       std::min(py + k / 2, kStripHeight - 1), 1);
        least = std::min(least, value);
        most = std::max(most, value);
      }
      const float shown = Value(colors, 2, x, y);
      error += std::max({least - shown, shown - most, 0.0f});
      ++count;
    }
  }
  EXPECT_GT(count, 500);
  EXPECT_LT(error / count, 2);
}

TEST_F(OrthomosaicCommand, OffTheEarthThereAreWorldFiles) {
  PlaceOnEarth();
  ASSERT_EQ(Make().exit_code, 0);
  fs::remove(folder_ / "model" / "units.json");
  const CliResult result = Make();
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_NE(result.out.find("north is not known"), std::string::npos) << result.out;
  const Dataset colors = Open("orthomosaic.tif");
  EXPECT_EQ(GDALGetSpatialRef(colors.get()), nullptr);
  EXPECT_EQ(Description()["crs"], Json());
  EXPECT_EQ(Description()["unit"], "arbitrary");
  std::istringstream world(ReadBytes(folder_ / "out" / "orthomosaic.tfw"));
  double size = 0, zero = 1;
  world >> size >> zero;
  EXPECT_NEAR(size, kGsd, 0.01 * kGsd);
  EXPECT_EQ(zero, 0);
  // And back: no world file stays that says something else.
  PlaceOnEarth();
  ASSERT_EQ(Make().exit_code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "out" / "orthomosaic.tfw"));
}

TEST_F(OrthomosaicCommand, AnyNumberOfThreadsGivesTheSameBytes) {
  ASSERT_EQ(Make({"--num_threads", "1"}, "one").exit_code, 0);
  ASSERT_EQ(Make({"--num_threads", "3"}, "three").exit_code, 0);
  auto one = ReadTree(folder_ / "one"), three = ReadTree(folder_ / "three");
  EXPECT_GE(one.size(), 12u);
  one.erase("run.json");
  three.erase("run.json");
  EXPECT_TRUE(one == three);
}

TEST_F(OrthomosaicCommand, PlaneAndUpOverrideWhatIsFound) {
  PlaceOnEarth();
  ASSERT_EQ(Make({"--up", "1,0,0", "--pixel_size", "0.01"}).exit_code, 0);
  const Json turned = Description();
  EXPECT_EQ(turned["crs"], Json());
  EXPECT_EQ(turned["pixel_size"], 0.01);
  EXPECT_GT(turned["height"], turned["width"]);  // x, along the strip, is up
  ASSERT_EQ(Make({"--plane", "0,-1,1"}).exit_code, 0);
  EXPECT_NE(Description()["frame"].get<std::string>().find("given direction"), std::string::npos);
  ExpectFailure(Make({"--plane", "0,0,1", "--up", "0,0,2"}), 1, "give --up across --plane");
  ExpectFailure(Make({"--plane", "level"}), 2, "--plane level: must be auto, model, fitted");
  ExpectFailure(Make({"--up", "1,2"}), 2, "--up 1,2: must be a direction");
  ExpectFailure(Make({"--color", "nice"}), 2, "color");
}

TEST_F(OrthomosaicCommand, PicturesThatCannotBeUsedAreNamed) {
  WriteBytes(folder_ / "images" / "img2.png", "no picture");
  fs::create_directories(folder_ / "masks");
  WriteImage(folder_ / "masks" / "img3.png.png", GrayImage(100, 100, 1, 255));
  fs::remove(folder_ / "images" / "img5.png");
  const CliResult result = Make({"--mask_path", (folder_ / "masks").string()});
  EXPECT_EQ(result.exit_code, 3) << result.Text();
  const Json report = Json::parse(ReadBytes(folder_ / "out" / "run.json"));
  EXPECT_EQ(report["images_in"], kNumPictures);
  EXPECT_EQ(report["images_used"], kNumPictures - 3);
  ASSERT_EQ(report["left_out"].size(), 3u);
  EXPECT_EQ(report["left_out"][0]["name"], "img2.png");
  EXPECT_EQ(report["left_out"][1]["name"], "img3.png");
  EXPECT_NE(report["left_out"][1]["reason"].get<std::string>().find("another size"),
            std::string::npos);
  EXPECT_EQ(report["left_out"][2]["name"], "img5.png");
  EXPECT_EQ(report["stages"][0]["name"], "orthomosaic");
  EXPECT_EQ(Description()["pictures"]["unread"].size(), 3u);
}

TEST_F(OrthomosaicCommand, BadInputIsOneLine) {
  ExpectFailure(Make({"--pixel_size", "1e-6"}), 1, "give a pixel size of");
  WriteCloud({1000, 0, 0});
  ExpectFailure(Make(), 1, "different frames");
  WriteCloud({0, 0, 0});
  ModelUnits units;
  units.is_metric = true;
  units.frame = "local";
  WriteModelUnits(folder_.Path(), units);  // beside the cloud
  ExpectFailure(Make(), 1, "is in other units than the model");
  fs::remove(folder_ / "units.json");
  PlaceOnEarth("EPSG:999999");
  ExpectFailure(Make(), 1, "EPSG:999999");
  fs::remove(folder_ / "model" / "units.json");
  fs::create_directories(folder_ / "empty");
  ExpectFailure(Make({"--mask_path", (folder_ / "none").string()}), 1, "check --mask_path");
  for (int i = 1; i <= kNumPictures; ++i) {
    fs::remove(folder_ / "images" / ("img" + std::to_string(i) + ".png"));
  }
  ExpectFailure(Make(), 1, "none of the model's 5 pictures can be used");
  WriteSparseModelBinary(folder_ / "model", SparseModel());
  ExpectFailure(Make(), 1, "holds no pictures");
  fs::remove(folder_ / "fused.ply");
  ExpectFailure(Make(), 1, "");
  // Nothing was made by any of these.
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(OrthomosaicCommand, OthersFilesStay) {
  WriteBytes(folder_ / "out" / "dem.tif", "my own");
  ExpectFailure(Make(), 1, "dem.tif");
  EXPECT_EQ(ReadBytes(folder_ / "out" / "dem.tif"), "my own");
  EXPECT_FALSE(fs::exists(folder_ / "out" / "orthomosaic.tif"));
}

TEST_F(OrthomosaicCommand, AFullDiskIsSaidAndLeavesNoHalfFile) {
  CliOptions options;
  options.max_file_bytes = 40000;  // the pictures' own files are smaller than a map
  const CliResult result = Make({}, "out", options);
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_FALSE(HoldsTemporaryFile(folder_.Path()));
  EXPECT_FALSE(fs::exists(folder_ / "out" / "orthomosaic.tif"));
  EXPECT_EQ(Make().exit_code, 0);
}

}  // namespace
}  // namespace colmap_seapoint
