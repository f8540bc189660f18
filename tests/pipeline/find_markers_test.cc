// Coded markers from pictures to a scaled model, and from the printed sheet back.
#include "colmap_seapoint/pictures/find_markers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/pipeline/markers/marker_finder.h"
#include "colmap_seapoint/pipeline/markers/print_markers.h"
#include "colmap_seapoint/pipeline/scale_models.h"
#include "tests/io/test_files.h"
#include "tests/markers/marker_world.h"

namespace colmap_seapoint {
namespace {

constexpr MarkerFamily kTag = MarkerFamily::kTag36h11;

// Four pictures of a bar of two markers, 0.4 units long, 25 pixels each.
class FindMarkersTest : public testing::Test {
 protected:
  void SetUp() override {
    Camera camera = MakeCamera(CameraModel::kPinhole, 500, 400, 200);
    camera.camera_id = 1;
    model_.cameras[1] = camera;
    const std::vector<PlaneMarker> bar = {{{kTag, 20}, {-0.2, 0, 2}, 0.1, 0.3, false},
                                          {{kTag, 21}, {0.2, 0.05, 2}, 0.1, 1.3, false}};
    for (uint32_t i = 0; i < 4; ++i) {
      PosedImage image;
      image.image_id = i + 1;
      image.camera_id = 1;
      image.name = "img" + std::to_string(i) + ".png";
      image.cam_from_world.translation = {0.3 - 0.2 * i, 0.05 * i, 0};
      names_.push_back(image.name);
      std::filesystem::create_directories(dir_ / "images");
      WriteImage(dir_ / ("images/" + image.name),
                 MarkerPicture(bar, camera, image.cam_from_world, {0.4, 1.5, 1, 0.3}));
      model_.images.push_back(image);
    }
    WriteSparseModelBinary(dir_ / "model", model_);
    bars_ = (dir_ / "bars.csv").string();
    WriteBytes(bars_, "name1,name2,length_m\ntag36h11:20,tag36h11:21,1.209339\n");
  }

  ModelScalerOptions Scaler() const {
    ModelScalerOptions options;
    options.input_path = (dir_ / "model").string();
    options.output_path = (dir_ / "out").string();
    options.image_path = (dir_ / "images").string();
    options.sources.scale_bars_path = bars_;
    options.run.log_level = 0;
    return options;
  }

  TempDir dir_;
  SparseModel model_;
  std::vector<std::string> names_;
  std::string bars_;
};

TEST_F(FindMarkersTest, TheSameForAnyNumberOfThreads) {
  RunReport report;
  const auto one = FindMarkers(dir_ / "images", names_, {kTag}, 1, &report);
  EXPECT_EQ(one.size(), 8u);
  EXPECT_EQ(MarkersCsv(one), MarkersCsv(FindMarkers(dir_ / "images", names_, {kTag}, 3, &report)));
  EXPECT_TRUE(report.left_out.empty());
}

// True length 0.403113 units: three metres a unit.
TEST_F(FindMarkersTest, ABarWithoutAClickGivesTheScale) {
  const ScaledModel scaled = ScaleModel(Scaler());
  const SparseModel metric = ReadSparseModel(dir_ / "out");
  const double baseline = (metric.images[3].cam_from_world.OriginInSource() -
                           metric.images[0].cam_from_world.OriginInSource())
                              .norm();
  const double in_model = (model_.images[3].cam_from_world.OriginInSource() -
                           model_.images[0].cam_from_world.OriginInSource())
                              .norm();
  EXPECT_NEAR(baseline / in_model, 3, 0.002 * 3);
  EXPECT_NE(scaled.text.find("target tag36h11:20: 4 of 4 marks"), std::string::npos);
}

TEST_F(FindMarkersTest, MarkersNeedPicturesOrTheirTable) {
  ModelScalerOptions options = Scaler();
  options.image_path.clear();
  EXPECT_THROW(ScaleModel(options), UsageError);
  RunReport report;
  options.markers_path = (dir_ / "m.csv").string();
  WriteBytes(options.markers_path,
             MarkersCsv(FindMarkers(dir_ / "images", names_, {kTag}, 1, &report)));
  const std::string text = ScaleModel(options).text;
  const size_t at = text.find("scale: ");
  ASSERT_NE(at, std::string::npos) << text;
  EXPECT_NEAR(std::stod(text.substr(at + 7)), 3, 0.002 * 3);
}

TEST_F(FindMarkersTest, AnUnreadablePictureIsNamedAndTheRestGoesOn) {
  WriteBytes(dir_ / "images/img1.png", "no picture");
  MarkerFinderOptions options;
  options.image_path = (dir_ / "images").string();
  options.output_path = (dir_ / "m.csv").string();
  const CommandResult result = RunMarkerFinder(options);
  EXPECT_FALSE(result.is_complete);
  EXPECT_EQ(result.text, "tag36h11:20: in 3 pictures\ntag36h11:21: in 3 pictures\n");
  EXPECT_EQ(ReadMarkersCsv(options.output_path).size(), 6u);
  WriteBytes(options.output_path, "mine\n");
  EXPECT_ERROR(RunMarkerFinder(options), "m.csv");
  options.families = "circles";
  EXPECT_THROW(RunMarkerFinder(options), UsageError);
}

TEST_F(FindMarkersTest, TheStageIsDoneOnceAndGoesWhenNothingAsksForIt) {
  const Workspace workspace((dir_ / "images").string(), (dir_ / "ws").string());
  WorkspaceState state(workspace.root, workspace.Names());
  MarkerSearch search{{kTag}, {}, 1};
  for (const std::string& name : names_) {
    search.pictures.push_back(DescribeInput(name, dir_ / ("images/" + name)));
  }
  RunReport report;
  EXPECT_EQ(FindMarkersOnce(search, workspace, &state, &report).size(), 8u);
  // What a second search would not find any more is still known.
  for (const std::string& name : names_) WriteBytes(dir_ / ("images/" + name), "gone");
  EXPECT_EQ(FindMarkersOnce(search, workspace, &state, &report).size(), 8u);
  search.families.clear();
  EXPECT_TRUE(FindMarkersOnce(search, workspace, &state, &report).empty());
  EXPECT_FALSE(std::filesystem::exists(workspace.markers));
}

class MarkerSheetTest : public testing::Test {
 protected:
  // What is found in the pages at 100 dots an inch.
  std::vector<MarkerSighting> FindInPrint(const PrintMarkersOptions& options) const {
    RunPrintMarkers(options);
    const std::string pages = (dir_ / "pages").string();
    std::filesystem::create_directories(pages);
    const std::string command =
        "pdftoppm -r 100 -gray '" + options.output_path + "' '" + pages + "/page'";
    EXPECT_EQ(std::system(command.c_str()), 0);
    RunReport report;
    return FindMarkers(pages, ListImages(pages), *ParseMarkerFamilies(options.family), 1, &report);
  }
  PrintMarkersOptions Options() const {
    PrintMarkersOptions options;
    options.output_path = (dir_ / "sheet.pdf").string();
    return options;
  }

  TempDir dir_;
};

TEST_F(MarkerSheetTest, WhatIsPrintedIsFoundInItsSize) {
  for (const char* family : {"tag36h11", "DICT_4X4", "DICT_5X5", "DICT_6X6"}) {
    PrintMarkersOptions options = Options();
    options.family = family;
    options.first_id = 40;
    options.num_markers = 7;
    options.size = 0.05;
    const auto found = FindInPrint(options);
    ASSERT_EQ(found.size(), 7u) << family;
    for (size_t k = 0; k < found.size(); ++k) {
      EXPECT_EQ(found[k].marker, family + (":" + std::to_string(40 + k)));
      EXPECT_NEAR((found[k].corners[1] - found[k].corners[0]).norm(), 50 / 25.4 * 100, 0.7);
    }
  }
}

TEST_F(MarkerSheetTest, TheSheetsOfABarAddUpToItsLength) {
  PrintMarkersOptions options = Options();
  options.num_markers = 2;
  options.bar_length = 1;
  const auto found = FindInPrint(options);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NE(found[0].image, found[1].image);
  const std::string first = ReadBytes(options.output_path);
  const CommandResult again = RunPrintMarkers(options);
  EXPECT_EQ(again.text, "name1,name2,length_m\ntag36h11:0,tag36h11:1,1.0000\n");
  EXPECT_EQ(ReadBytes(options.output_path), first);
}

TEST_F(MarkerSheetTest, WhatCannotBePrintedIsRefused) {
  PrintMarkersOptions options = Options();
  options.size = 0.2;
  EXPECT_THROW(RunPrintMarkers(options), UsageError);
  options = Options();
  options.first_id = 585;
  EXPECT_THROW(RunPrintMarkers(options), UsageError);
  options = Options();
  options.bar_length = 0.1;
  EXPECT_THROW(RunPrintMarkers(options), UsageError);
  options.bar_length = 1;
  options.num_markers = 3;
  EXPECT_THROW(RunPrintMarkers(options), UsageError);
  options = Options();
  WriteBytes(options.output_path, "%PDF-1.4 somebody else's\n");
  EXPECT_ERROR(RunPrintMarkers(options), "sheet.pdf");
}

}  // namespace
}  // namespace colmap_seapoint
