// partial_densifier: what it writes, and models that do not fit the pictures.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr int kNumPictures = 5;

class Densifier : public testing::Test {
 protected:
  void SetUp() override {
    WriteStrip(folder_ / "images", kNumPictures);
    model_ = StripModel(kNumPictures);
  }

  CliResult Densify(const std::vector<std::string>& more = {}) {
    WriteSparseModelText(folder_ / "model", model_);
    std::vector<std::string> arguments = {"partial_densifier",           "--image_path",
                                          (folder_ / "images").string(), "--input_path",
                                          (folder_ / "model").string(),  "--output_path",
                                          (folder_ / "dense").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(SEAPOINT_PROGRAM, arguments);
  }

  nlohmann::json Report() const {
    return nlohmann::json::parse(ReadBytes(folder_ / "dense" / "run.json"));
  }

  std::set<std::string> LeftOut() const {
    std::set<std::string> names;
    const nlohmann::json report = Report();
    for (const auto& item : report["left_out"]) {
      names.insert(item["name"]);
      EXPECT_FALSE(item["reason"].get<std::string>().empty());
    }
    return names;
  }

  TemporaryFolder folder_;
  SparseModel model_;
};

TEST_F(Densifier, WritesCloudPairsAndReport) {
  const CliResult result = Densify();
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  const nlohmann::json report = Report();
  EXPECT_EQ(report["images_in"], kNumPictures);
  EXPECT_EQ(report["images_used"], kNumPictures);
  EXPECT_EQ(report["inputs"].size(), static_cast<size_t>(kNumPictures) + 3);  // model files too
  const std::string csv = ReadBytes(folder_ / "dense" / "pairs.csv");
  EXPECT_EQ(csv.find("image1,image2,pass,baseline,overlap,num_oa,num_na,num_rea,"), 0u);
  EXPECT_GE(report["pairs"].get<int>(), kNumPictures - 2);
  const auto cloud = ReadCloud(folder_ / "dense" / "fused.ply");
  ASSERT_EQ(cloud.size(), report["points"].get<size_t>());
  EXPECT_GT(cloud.size(), 1000u);
  EXPECT_TRUE(fs::exists(folder_ / "dense" / "fused.ply.vis"));
  size_t num_near = 0;  // to the ground plane
  for (const CloudPoint& point : cloud) {
    if (std::abs(point.xyz.z() - kStripRange) < 0.02 * kStripRange) ++num_near;
  }
  EXPECT_GT(static_cast<double>(num_near), 0.9 * static_cast<double>(cloud.size()));
}

TEST_F(Densifier, SameBytesForOneAndTwoThreadsAndWithADatabase) {
  ASSERT_EQ(Densify({"--num_threads", "1"}).exit_code, 0);
  const std::string ply = ReadBytes(folder_ / "dense" / "fused.ply");
  const std::string vis = ReadBytes(folder_ / "dense" / "fused.ply.vis");
  ASSERT_EQ(Densify({"--num_threads", "2"}).exit_code, 0);
  EXPECT_TRUE(ReadBytes(folder_ / "dense" / "fused.ply") == ply);
  EXPECT_TRUE(ReadBytes(folder_ / "dense" / "fused.ply.vis") == vis);
  const std::string database = (folder_ / "database.db").string();
  ASSERT_EQ(RunProgram(SEAPOINT_PROGRAM, {"feature_extractor", "--database_path", database,
                                          "--image_path", (folder_ / "images").string()})
                .exit_code,
            0);
  ASSERT_EQ(Densify({"--database_path", database}).exit_code, 0);
  EXPECT_TRUE(ReadBytes(folder_ / "dense" / "fused.ply") == ply);

  // Matches of the database instead: verified and guided ones, so maybe not the same cloud.
  ASSERT_EQ(
      RunProgram(SEAPOINT_PROGRAM, {"sequential_matcher", "--database_path", database}).exit_code,
      0);
  ASSERT_EQ(Densify({"--database_path", database, "--num_threads", "1"}).exit_code, 0);
  const std::string matched = ReadBytes(folder_ / "dense" / "fused.ply");
  ASSERT_EQ(Densify({"--database_path", database, "--num_threads", "2"}).exit_code, 0);
  EXPECT_TRUE(ReadBytes(folder_ / "dense" / "fused.ply") == matched);
}

TEST_F(Densifier, PanoramasAreRefused) {
  for (auto& [id, camera] : model_.cameras) {
    camera = MakeCamera(CameraModel::kEquirectangular, 1, camera.width, camera.height);
    camera.camera_id = id;
  }
  const CliResult result = Densify();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.Text().find("EQUIRECTANGULAR"), std::string::npos) << result.Text();
}

TEST_F(Densifier, WriteDebugDrawsEveryPair) {
  const std::vector<std::string> sequential = {"--PartialDensification.redundancy", "sequential",
                                               "--PartialDensification.completion", "0"};
  ASSERT_EQ(Densify(sequential).exit_code, 0);
  const std::string ply = ReadBytes(folder_ / "dense" / "fused.ply");
  EXPECT_FALSE(fs::exists(folder_ / "dense" / "debug"));
  std::vector<std::string> with_debug = sequential;
  with_debug.insert(with_debug.end(), {"--PartialDensification.write_debug", "1"});
  const CliResult result = Densify(with_debug);
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_TRUE(ReadBytes(folder_ / "dense" / "fused.ply") == ply);

  std::map<std::string, int> num_figures;  // "fig10" -> count
  for (const auto& entry : fs::directory_iterator(folder_ / "dense" / "debug")) {
    const std::string name = entry.path().filename().string();
    ASSERT_EQ(name.find("pair_000"), 0u) << name;
    ++num_figures[name.substr(10, 5)];
    const ColorImage figure = ReadColorImage(entry.path());
    EXPECT_GE(figure.width, kStripWidth) << name;
    EXPECT_NE(figure.data.front(), 0) << name;  // the title's ground
  }
  const int num_pairs = Report()["pairs"];
  ASSERT_GE(num_pairs, 2);
  EXPECT_EQ(num_figures, (std::map<std::string, int>{{"fig10", num_pairs - 1},
                                                     {"fig11", num_pairs - 1},
                                                     {"fig13", num_pairs},
                                                     {"fig15", num_pairs},
                                                     {"fig17", num_pairs - 1}}));
}

TEST_F(Densifier, PicturesThatAreNotThereAreLeftOut) {
  fs::remove(folder_ / "images" / "img1.png");
  WriteBytes(folder_ / "images" / "img2.png", "");
  CliResult result = Densify();
  EXPECT_EQ(result.exit_code, 3) << result.Text();
  EXPECT_EQ(LeftOut(), (std::set<std::string>{"img1.png", "img2.png"}));
  EXPECT_EQ(Report()["images_used"], kNumPictures - 2);

  WriteStrip(folder_ / "images", kNumPictures);
  const std::string png = ReadBytes(folder_ / "images" / "img5.png");
  WriteBytes(folder_ / "images" / "img5.png", png.substr(0, png.size() / 2));
  WriteImage(folder_ / "images" / "img1.png", ColorImage(64, 40, 3, 99));  // other proportions
  result = Densify();
  EXPECT_EQ(result.exit_code, 3) << result.Text();
  EXPECT_EQ(LeftOut(), (std::set<std::string>{"img1.png", "img5.png"}));
}

TEST_F(Densifier, NoneOfThePicturesIsThere) {
  ASSERT_EQ(Densify().exit_code, 0);
  const auto before = ReadTree(folder_ / "dense");
  fs::remove_all(folder_ / "images");
  CliResult result = Densify();
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find((folder_ / "images").string()), std::string::npos);
  fs::create_directories(folder_ / "images");
  result = Densify();
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("--image_path"), std::string::npos) << result.Text();
  EXPECT_TRUE(ReadTree(folder_ / "dense") == before);
}

TEST_F(Densifier, NamesThatLeadOutsideAreRefused) {
  WriteImage(folder_ / "secret.png", StripPicture(1));
  for (const std::string& name :
       {std::string("../secret.png"), (folder_ / "secret.png").string()}) {
    model_.images[0].name = name;
    const CliResult result = Densify();
    EXPECT_EQ(result.exit_code, 1) << result.Text();
    EXPECT_NE(result.LastErrorLine().find(name), std::string::npos) << result.Text();
  }
}

TEST_F(Densifier, BrokenModels) {
  ASSERT_EQ(Densify().exit_code, 0);
  const auto densify = [&](const fs::path& model) {
    return RunProgram(
        SEAPOINT_PROGRAM,
        {"partial_densifier", "--image_path", (folder_ / "images").string(), "--input_path",
         model.string(), "--output_path", (folder_ / "dense").string()});
  };
  CliResult result = densify(folder_ / "absent");
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find((folder_ / "absent").string()), std::string::npos);
  const std::string images = ReadBytes(folder_ / "model" / "images.txt");
  WriteBytes(folder_ / "model" / "images.txt", images.substr(0, images.size() / 2) + " x");
  result = densify(folder_ / "model");
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("images.txt"), std::string::npos) << result.Text();
  model_.images.clear();
  model_.points3D.clear();
  result = Densify();
  EXPECT_EQ(result.exit_code, 1) << result.Text();
}

TEST_F(Densifier, ADatabaseThatIsNoneIsAnErrorBeforeAnyWork) {
  WriteBytes(folder_ / "database.db", std::string(5000, 'x'));
  const CliResult result = Densify({"--database_path", (folder_ / "database.db").string()});
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("database.db"), std::string::npos) << result.Text();
}

}  // namespace
}  // namespace colmap_seapoint
