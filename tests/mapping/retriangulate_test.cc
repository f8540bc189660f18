#include "colmap_seapoint/mapping/retriangulate.h"

#include <gtest/gtest.h>

#include <iterator>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "tests/io/test_files.h"
#include "tests/mapping/exact_survey.h"
#include "tests/mapping/scripted_colmap.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr char kTriangulator[] = "point_triangulator";

class RetriangulateTest : public testing::Test {
 protected:
  RetriangulateTest() { WriteSparseModelBinary(folder_, before_); }

  Triangulation Run(const MapperOptions& options = {}) {
    return Retriangulate(
        colmap_.Program(),
        {dir_ / "database.db", dir_ / "images", options, dir_ / "lens", must_succeed_}, folder_,
        before_);
  }

  // The model without its last pictures and points.
  SparseModel Without(size_t num_images, size_t num_points) const {
    SparseModel model = before_;
    model.images.resize(model.images.size() - num_images);
    for (size_t i = 0; i < num_points; ++i) model.points3D.erase(std::prev(model.points3D.end()));
    for (auto& [id, point] : model.points3D) point.track.clear();
    for (PosedImage& image : model.images) {
      image.points2D.clear();
      image.point3D_ids.clear();
    }
    return model;
  }

  bool must_succeed_ = false;
  TempDir dir_;
  const fs::path folder_ = dir_ / "model";
  ScriptedColmap colmap_{dir_ / "bin"};
  const SparseModel before_ = ExactSurvey(ExactLens(), 3);
};

TEST_F(RetriangulateTest, ReturnsWhatColmapLeftAndTouchesNothing) {
  const std::string bytes = ReadBytes(folder_ / "points3D.bin");
  colmap_.Leaves(kTriangulator, 1, "", Without(0, before_.points3D.size() / 2));
  const Triangulation result = Run();
  ASSERT_TRUE(result.model);
  EXPECT_EQ(result.fault, "");
  EXPECT_EQ(result.model->points3D.size(), (before_.points3D.size() + 1) / 2);
  EXPECT_EQ(ReadBytes(folder_ / "points3D.bin"), bytes);
  EXPECT_FALSE(fs::exists(folder_.string() + ".triangulated"));
}

TEST_F(RetriangulateTest, LostPicturesOrPointsAreRefused) {
  colmap_.Leaves(kTriangulator, 1, "", Without(1, 0));
  colmap_.Leaves(kTriangulator, 2, "", Without(0, before_.points3D.size() / 2 + 1));
  Triangulation result = Run();
  EXPECT_FALSE(result.model);
  EXPECT_EQ(result.fault, "pictures were lost");
  result = Run();
  EXPECT_FALSE(result.model);
  EXPECT_EQ(result.fault, "points were lost");
}

TEST_F(RetriangulateTest, AProgramThatFailsOrLeavesNothingIsRefused) {
  colmap_.Ends(kTriangulator, 1, "cannot", 3);
  colmap_.Ends(kTriangulator, 2, "", 0);
  testing::internal::CaptureStderr();
  const Triangulation result = Run();
  EXPECT_TRUE(result.has_failed);
  EXPECT_EQ(result.fault, "the triangulation failed (exit code 3)");
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find((dir_ / "lens_triangulation.log").string()), std::string::npos) << said;
  EXPECT_NE(ReadBytes(dir_ / "lens_triangulation.log").find("cannot"), std::string::npos);
  EXPECT_EQ(Run().fault, "the triangulation failed (it left no model)");
  EXPECT_FALSE(fs::exists(folder_.string() + ".triangulated"));
}

// COLMAP does not look whether its last bytes found room.
TEST_F(RetriangulateTest, AModelThatIsCutShortIsAFailure) {
  colmap_.Leaves(kTriangulator, 1, "", before_);
  const fs::path points = dir_ / "bin" / "point_triangulator.1.output" / "points3D.bin";
  fs::resize_file(points, fs::file_size(points) / 2);
  const Triangulation result = Run();
  EXPECT_TRUE(result.has_failed);
  EXPECT_FALSE(result.model);
  EXPECT_EQ(result.fault.find("the triangulation failed (it left a model that "), 0u)
      << result.fault;
}

TEST_F(RetriangulateTest, AFailureWhereItMustSucceedIsAnErrorWithLogAndRemedy) {
  must_succeed_ = true;
  colmap_.Ends(kTriangulator, 1, "No space left on device", 1);
  const std::string text = ErrorOf([&] { Run(); });
  EXPECT_NE(text.find((dir_ / "lens_triangulation.log").string()), std::string::npos) << text;
  EXPECT_NE(text.find("run the same command again"), std::string::npos) << text;
  // That it finds little is none.
  colmap_.Leaves(kTriangulator, 2, "", Without(0, before_.points3D.size()));
  const Triangulation result = Run();
  EXPECT_FALSE(result.has_failed);
  EXPECT_EQ(result.fault, "points were lost");
}

// As COLMAP 3.8 ends when no point is left.
TEST_F(RetriangulateTest, ThatNothingIsFoundIsNoFailure) {
  must_succeed_ = true;
  colmap_.Ends(kTriangulator, 1,
               "F20261129 sfm.cc:473] Check failed: bundle_adjuster.Solve(&reconstruction) ", 134);
  const Triangulation result = Run();
  EXPECT_FALSE(result.has_failed);
  EXPECT_FALSE(result.model);
  EXPECT_EQ(result.fault, "no point was found");
}

TEST_F(RetriangulateTest, LeftoversOfAnEarlierRunDoNotCount) {
  WriteSparseModelBinary(folder_.string() + ".triangulated", before_);
  colmap_.Ends(kTriangulator, 1, "", 0);
  EXPECT_FALSE(Run().model);
}

TEST_F(RetriangulateTest, ErrorLimitsUnlessTheUserGivesThem) {
  Run();
  EXPECT_EQ(colmap_.Value(kTriangulator, 1, "clear_points"), "1");
  EXPECT_EQ(colmap_.Value(kTriangulator, 1, "Mapper.filter_max_reproj_error"), "1.5");
  // This COLMAP does not know the other two limits.
  EXPECT_EQ(colmap_.Value(kTriangulator, 1, "Mapper.tri_merge_max_reproj_error"), "");
  Run({{"Mapper.filter_max_reproj_error", "2.5"}, {"Mapper.num_threads", "1"}});
  EXPECT_EQ(colmap_.Value(kTriangulator, 2, "Mapper.filter_max_reproj_error"), "2.5");
  EXPECT_EQ(colmap_.Value(kTriangulator, 2, "Mapper.num_threads"), "1");
}

}  // namespace
}  // namespace colmap_seapoint
