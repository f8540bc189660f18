#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/model_units.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/cli/cli_runner.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// Six pictures of 160 x 120 pixels in a row over the plane z = 0, 3.2 x 2.4 units each, 0.6 apart,
// and a cloud of what two of them see, with a hole of one unit about (0, 1.5).
class CompletenessReporter : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_ / "images");
    SparseModel model;
    Camera camera = MakeCamera(CameraModel::kPinhole, 125, 160, 120);
    camera.camera_id = 1;
    model.cameras[1] = camera;
    for (int k = 0; k < 6; ++k) {
      PosedImage image;
      image.image_id = static_cast<uint32_t>(k + 1);
      image.camera_id = 1;
      image.name = "dive_" + std::to_string(k) + ".png";
      image.cam_from_world.rotation = Eigen::Quaterniond(0, 1, 0, 0);
      image.cam_from_world.translation = {0, 0.6 * k, 2.5};
      WriteImage(folder_ / "images" / image.name, Texture(k));
      model.images.push_back(image);
    }
    WriteSparseModelText(folder_ / "sparse", model);
    WriteCloud({0, 0});
  }

  static ColorImage Texture(int seed) {
    ColorImage image(160, 120, 3);
    uint32_t random = static_cast<uint32_t>(seed);
    for (uint8_t& value : image.data) {
      random = random * 1664525u + 1013904223u;
      value = static_cast<uint8_t>(60 + (random >> 25));
    }
    return image;
  }
  void WriteCloud(const Eigen::Vector2d& shift) const {
    CloudWriter cloud(folder_ / "fused.ply");
    for (double y = -0.6; y < 3.6; y += 0.02) {
      for (double x = -1.6; x < 1.6; x += 0.02) {
        if (std::hypot(x, y - 1.5) < 0.5) continue;
        CloudPoint point;
        point.xyz = Eigen::Vector3d(x + shift.x(), y + shift.y(), 0).cast<float>();
        point.normal = {0, 0, 1};
        const uint32_t seen_by[] = {0, 1};
        cloud.Add(point, seen_by, 2);
      }
    }
    cloud.Finish();
  }
  CliResult Report(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments = {"completeness_reporter",          "--input_path",
                                          (folder_ / "sparse").string(),    "--cloud_path",
                                          (folder_ / "fused.ply").string(), "--output_path",
                                          (folder_ / "out").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(SEAPOINT_PROGRAM, arguments);
  }
  Json Answer() const {
    std::ifstream in(folder_ / "out" / "completeness.json");
    return Json::parse(in);
  }

  static std::string TextOf(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  TemporaryFolder folder_;
};

TEST_F(CompletenessReporter, TheHoleIsFound) {
  const CliResult result = Report({"--image_path", (folder_ / "images").string()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("% (+- "), std::string::npos);
  const Json answer = Answer();
  bool is_found = false;
  for (const Json& gap : answer.at("gaps")) {
    if (gap.at("cause") != "views_disagree") continue;
    is_found = true;
    EXPECT_NEAR(gap.at("area").get<double>(), 0.785, 0.06);
    EXPECT_NEAR(gap.at("centroid")[1].get<double>(), 1.5, 0.05);
  }
  EXPECT_TRUE(is_found);
  EXPECT_EQ(answer.at("unit"), "units");
  for (const char* name : {"index.html", "gaps.geojson", "gaps.csv", "map.png", "run.json"}) {
    EXPECT_TRUE(fs::exists(folder_ / "out" / name)) << name;
  }
  const std::string page = TextOf(folder_ / "out" / "index.html");
  EXPECT_NE(page.find("dive_0.png"), std::string::npos);
  // The answer can be read without scripts.
  EXPECT_NE(page.find("<p class=\"answer\">" + result.out.substr(0, 6)), std::string::npos);
  EXPECT_FALSE(fs::exists(folder_ / "out" / "route.plan"));  // nowhere on the Earth
  // Again into the same folder: the ids stay, and the page is the same whatever the threads.
  ASSERT_EQ(Report({"--image_path", (folder_ / "images").string(), "--num_threads", "1"}).exit_code,
            0);
  EXPECT_EQ(Answer().at("gaps"), answer.at("gaps"));
  EXPECT_EQ(TextOf(folder_ / "out" / "index.html"), page);
}

TEST_F(CompletenessReporter, MapsOfLayersThatHaveNoGapsAnyMoreGo) {
  ASSERT_EQ(Report().exit_code, 0);
  // As an earlier run would have left it, and a file of the user's.
  WriteTextFile(folder_ / "out" / "map_left_3.png", "former");
  WriteTextFile(folder_ / "out" / "map_mine.png", "the user's");
  {
    std::ofstream names(folder_ / "out" / ".colmap_seapoint", std::ios::app);
    names << "map_left_3.png\n";
  }
  ASSERT_EQ(Report().exit_code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "out" / "map_left_3.png"));
  EXPECT_TRUE(fs::exists(folder_ / "out" / "map_mine.png"));
  EXPECT_TRUE(fs::exists(folder_ / "out" / "map.png"));
}

// The same survey turned onto its side: z is no height.
TEST_F(CompletenessReporter, AnAreaNeedsALevelModel) {
  SparseModel model = ReadSparseModel(folder_ / "sparse", ModelContent::kPosesAndPoints);
  const Eigen::Quaterniond turn(std::sqrt(0.5), std::sqrt(0.5), 0, 0);
  for (PosedImage& image : model.images) {
    image.cam_from_world.rotation = image.cam_from_world.rotation * turn.conjugate();
  }
  WriteSparseModelText(folder_ / "sparse", model);
  std::vector<CloudPoint> points = ReadCloud(folder_ / "fused.ply");
  CloudWriter cloud(folder_ / "fused.ply");
  for (CloudPoint& point : points) {
    point.xyz = turn.cast<float>() * point.xyz;
    point.normal = turn.cast<float>() * point.normal;
    const uint32_t seen_by[] = {0, 1};
    cloud.Add(point, seen_by, 2);
  }
  cloud.Finish();
  ASSERT_EQ(Report().exit_code, 0);
  std::ifstream in(folder_ / "out" / "gaps.geojson");
  EXPECT_NE(Json::parse(in).at("map_from_model"), Json::parse("[[1,0,0],[0,1,0],[0,0,1]]"));
  const fs::path area = folder_ / "area.geojson";
  WriteTextFile(area, R"({"type":"Polygon","coordinates":[[[0,0],[1,0],[1,1],[0,0]]]})");
  const CliResult result = Report({"--area", area.string()});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("does not point up"), std::string::npos) << result.err;
}

TEST_F(CompletenessReporter, TheRouteForVehiclesComesAndGoes) {
  ModelUnits units;
  units.is_metric = true;
  units.frame = "east-north-up";
  units.origin = GeoPosition{43.1, 5.9, 0};
  WriteModelUnits(folder_ / "sparse", units);
  ASSERT_EQ(Report().exit_code, 0);
  for (const char* name : {"route.plan", "route.waypoints", "route.cmp", "gaps.kml"}) {
    EXPECT_TRUE(fs::exists(folder_ / "out" / name)) << name;
  }
  fs::remove(folder_ / "sparse" / kUnitsFile);
  ASSERT_EQ(Report().exit_code, 0);
  for (const char* name : {"route.plan", "route.waypoints", "route.cmp", "gaps.kml"}) {
    EXPECT_FALSE(fs::exists(folder_ / "out" / name)) << name;
  }
}

TEST_F(CompletenessReporter, AMapOfAnotherProgramIsRefused) {
  fs::create_directories(folder_ / "map");
  WriteTextFile(folder_ / "map" / "map.json", "{}");
  WriteImage(folder_ / "map" / "orthomosaic.jpg", ColorImage(4, 4, 3, 9));
  const CliResult result = Report({"--map_path", (folder_ / "map").string()});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("is no map of ours"), std::string::npos) << result.err;
}

TEST_F(CompletenessReporter, WithoutPictures) {
  const CliResult result = Report();
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

TEST_F(CompletenessReporter, UnreadablePictureIsNamed) {
  WriteTextFile(folder_ / "images" / "dive_2.png", "no picture");
  const CliResult result = Report({"--image_path", (folder_ / "images").string()});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_NE(result.err.find("dive_2.png"), std::string::npos);
}

TEST_F(CompletenessReporter, ChecksItselfByHiddenPictures) {
  ASSERT_EQ(Report().exit_code, 0);
  const double tolerance = Answer().at("covered_share_tolerance");
  EXPECT_TRUE(Answer().at("self_check").is_null());
  const CliResult run = Report({"--self_check", "1"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  // All points are from pictures 0 and 1: twice nothing was lost.
  EXPECT_EQ(Answer().at("self_check").at("folds"), 2);
  EXPECT_GT(Answer().at("self_check").at("hidden_area"), 1);
  EXPECT_GE(Answer().at("covered_share_tolerance"), tolerance);
}

TEST_F(CompletenessReporter, WithoutWhatTellsThePicturesNothingIsHidden) {
  const fs::path vis = folder_ / "fused.ply.vis";
  std::fstream file(vis, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(12);  // the first point's first picture
  const uint32_t other = 6;
  file.write(reinterpret_cast<const char*>(&other), sizeof(other));
  file.close();
  CliResult run = Report({"--self_check", "1"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("names pictures that the model does not hold"), std::string::npos)
      << run.err;
  fs::remove(vis);
  run = Report({"--self_check", "1"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("no picture can be hidden"), std::string::npos) << run.err;
  EXPECT_EQ(Report().exit_code, 0);
}

TEST_F(CompletenessReporter, FaultsSayWhatToDo) {
  const auto last_line_of = [&](const CliResult& result) {
    EXPECT_EQ(result.exit_code, 1);
    return result.err;
  };
  const fs::path area = folder_ / "area.geojson";
  WriteTextFile(area, R"({"type":"Polygon","coordinates":[[[0,0],[1,1],[1,0],[0,1],[0,0]]]})");
  EXPECT_NE(last_line_of(Report({"--area", area.string()})).find("crosses itself"),
            std::string::npos);
  WriteTextFile(area, R"({"type":"Polygon","coordinates":[[[0,0],[1e9,0],[1e9,1e9],[0,0]]]})");
  EXPECT_NE(last_line_of(Report({"--area", area.string()})).find("too large"), std::string::npos);
  WriteTextFile(area, R"({"type":"Polygon","coordinates":[[[90,90],[91,90],[91,91],[90,90]]]})");
  EXPECT_NE(last_line_of(Report({"--area", area.string()})).find("no picture shows"),
            std::string::npos);
  // Another dive's pictures.
  fs::create_directories(folder_ / "other");
  fs::copy_file(folder_ / "images" / "dive_0.png", folder_ / "other" / "other.png");
  const CliResult other = Report({"--image_path", (folder_ / "other").string()});
  EXPECT_NE(last_line_of(other).find("none of the model's pictures"), std::string::npos);
  WriteCloud({100, 0});
  EXPECT_NE(last_line_of(Report()).find("of the cloud lie in any picture"), std::string::npos);
  fs::remove(folder_ / "fused.ply");
  EXPECT_NE(last_line_of(Report()).find("fused.ply"), std::string::npos);
}

}  // namespace
}  // namespace colmap_seapoint
