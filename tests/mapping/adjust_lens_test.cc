// With a triangulator that changes nothing, unless a test says what it leaves.
#include "colmap_seapoint/mapping/adjust_lens.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "tests/io/test_files.h"
#include "tests/mapping/exact_survey.h"
#include "tests/mapping/scripted_colmap.h"
#include "tests/mapping/survey_database.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr char kTriangulator[] = "point_triangulator";

class AdjustLensTest : public testing::Test {
 protected:
  void SetUp() override {
    WriteSurveyDatabase(exact_, dir_ / "database.db");
    WriteTinyPictures(exact_, dir_ / "images");
  }

  LensAdjustment Adjust(const SparseModel& model, bool frees_distortion = true,
                        bool frees_principal_point = true) {
    WriteSparseModelBinary(folder_, model);
    AdjustmentJob job;
    job.database_path = dir_ / "database.db";
    job.image_path = dir_ / "images";
    job.log_path = dir_ / "lens";
    job.holds_lens = holds_lens_;
    job.frees_distortion = frees_distortion;
    job.frees_principal_point = frees_principal_point;
    return AdjustLens(colmap_.Program(), job, folder_);
  }

  std::string ModelBytes() const {
    return ReadBytes(folder_ / "cameras.bin") + ReadBytes(folder_ / "images.bin") +
           ReadBytes(folder_ / "points3D.bin");
  }

  // What a triangulation is refused for.
  SparseModel WithAPictureLost() const {
    SparseModel model = exact_;
    model.images.pop_back();
    for (auto& [id, point] : model.points3D) point.track.clear();
    return model;
  }

  bool holds_lens_ = false;
  TempDir dir_;
  const fs::path folder_ = dir_ / "model";
  ScriptedColmap colmap_{dir_ / "bin"};
  const SparseModel exact_ = ExactSurvey(ExactLens(), 5);
};

TEST_F(AdjustLensTest, FindsTheLensAndWritesIt) {
  const SparseModel start = Disturbed(exact_);
  ASSERT_GT(LargestDifference(start.cameras.at(1), ExactLens()), 10);
  const LensAdjustment adjustment = Adjust(start);
  EXPECT_TRUE(adjustment.distortion_is_sound);
  EXPECT_LT(LargestDifference(adjustment.model.cameras.at(1), ExactLens()), 0.5);
  EXPECT_EQ(adjustment.outcome.find("focal length 936.8 -> 90"), 0u) << adjustment.outcome;
  EXPECT_EQ(adjustment.outcome.find("refused"), std::string::npos) << adjustment.outcome;
  // What is returned is what lies there.
  const SparseModel written = ReadSparseModel(folder_);
  EXPECT_EQ(written.cameras.at(1).params, adjustment.model.cameras.at(1).params);
  EXPECT_EQ(written.images[3].cam_from_world.translation,
            adjustment.model.images[3].cam_from_world.translation);
  EXPECT_TRUE(fs::exists(dir_ / "lens_triangulation.log"));
  EXPECT_FALSE(fs::exists(folder_.string() + ".triangulated"));
}

TEST_F(AdjustLensTest, TriangulatesWithTheAdjustedLens) {
  Adjust(Disturbed(exact_));
  ASSERT_EQ(colmap_.NumCalls(kTriangulator), 1);
  EXPECT_EQ(colmap_.Value(kTriangulator, 1, "input_path"), folder_.string());
  EXPECT_EQ(colmap_.Value(kTriangulator, 1, "database_path"), (dir_ / "database.db").string());
  // The second adjustment starts from what the triangulator left, here another model altogether.
  colmap_.Leaves(kTriangulator, 2, "", exact_);
  const LensAdjustment adjustment = Adjust(Disturbed(exact_));
  EXPECT_LT(ReprojectionError(adjustment.model), 1e-6);
  EXPECT_LT(LargestDifference(adjustment.model.cameras.at(1), ExactLens()), 1e-5);
}

TEST_F(AdjustLensTest, APictureThatStandsWrongIsBroughtBack) {
  SparseModel start = Disturbed(exact_);
  // The triangulator of these tests leaves all as it is: so do the points.
  start.images[4].cam_from_world.translation += Eigen::Vector3d(0.3, 0.5, 0);
  const LensAdjustment adjustment = Adjust(start);
  EXPECT_EQ(adjustment.num_contradicted, 0u);
  const Eigen::Vector3d now = adjustment.model.images[4].cam_from_world.OriginInSource() -
                              adjustment.model.images[3].cam_from_world.OriginInSource();
  const Eigen::Vector3d exact = exact_.images[4].cam_from_world.OriginInSource() -
                                exact_.images[3].cam_from_world.OriginInSource();
  EXPECT_LT((now - exact).norm(), 0.02);
}

TEST_F(AdjustLensTest, APictureThatCannotBeReadAnyMoreEndsIt) {
  std::filesystem::remove(dir_ / "images" / "img3.jpg");
  EXPECT_THROW(Adjust(Disturbed(exact_)), Error);
}

TEST_F(AdjustLensTest, APictureThatNoPoseMakesAgreeWithItsMatchesIsCounted) {
  {
    ColmapDatabase database(dir_ / "database.db", ColmapDatabase::Mode::kReadWrite);
    for (const ImagePair& pair : ReadVerifiedPairs(database)) {
      if (pair.first != 5 && pair.second != 5) continue;
      TwoViewGeometry geometry = ReadTwoViewGeometry(database, pair);
      // Every match goes to its neighbour's place.
      for (size_t i = 1; i < geometry.inliers.size(); ++i) {
        std::swap(geometry.inliers[i - 1].idx1, geometry.inliers[i].idx1);
      }
      WriteMatches(&database, pair.first, pair.second, geometry.inliers, geometry);
    }
    database.Finish();
  }
  EXPECT_EQ(Adjust(Disturbed(exact_)).num_contradicted, 1u);
}

TEST_F(AdjustLensTest, AFailedTriangulationLeavesNothingToUse) {
  colmap_.Ends(kTriangulator, 1, "no", 1);
  EXPECT_FALSE(Adjust(Disturbed(exact_)).is_usable);
}

TEST_F(AdjustLensTest, ARefusedTriangulationIsSaidAndTheLensIsStillFound) {
  colmap_.Leaves(kTriangulator, 1, "", WithAPictureLost());
  const LensAdjustment adjustment = Adjust(Disturbed(exact_));
  EXPECT_TRUE(adjustment.is_usable);
  EXPECT_NE(
      adjustment.outcome.find("; triangulation kept as the mapper left it: pictures were lost"),
      std::string::npos)
      << adjustment.outcome;
  EXPECT_LT(LargestDifference(adjustment.model.cameras.at(1), ExactLens()), 0.5);
}

TEST_F(AdjustLensTest, AGivenLensIsHeldAndThePosesAreAdjusted) {
  SparseModel start = Disturbed(exact_);
  start.cameras = exact_.cameras;
  holds_lens_ = true;
  const LensAdjustment adjustment = Adjust(start, false);
  EXPECT_EQ(adjustment.model.cameras.at(1).params, ExactLens().params);
  EXPECT_GT(ReprojectionError(start), 1);
  EXPECT_LT(ReprojectionError(adjustment.model), 1e-3);
  EXPECT_EQ(adjustment.outcome.find("refused"), std::string::npos) << adjustment.outcome;
}

TEST_F(AdjustLensTest, PicturesComeInTheOrderOfTheirIds) {
  SparseModel start = Disturbed(exact_);
  std::reverse(start.images.begin(), start.images.end());
  const LensAdjustment adjustment = Adjust(start);
  for (size_t i = 0; i < adjustment.model.images.size(); ++i) {
    EXPECT_EQ(adjustment.model.images[i].image_id, i + 1);
  }
}

TEST_F(AdjustLensTest, AnUnsoundLensIsRefused) {
  // The truth lies 90 pixels beside the centre: more than a twentieth of 1000.
  Camera lens = ExactLens();
  lens.params[2] += 90;
  const SparseModel start = Disturbed(ExactSurvey(lens, 5));
  colmap_.Leaves(kTriangulator, 1, "", WithAPictureLost());
  const LensAdjustment adjustment = Adjust(start);
  EXPECT_FALSE(adjustment.distortion_is_sound);
  EXPECT_NE(adjustment.outcome.find(
                "; lens kept as the mapper left it: the principal point moved too far"),
            std::string::npos)
      << adjustment.outcome;
  EXPECT_EQ(adjustment.model.cameras.at(1).params, start.cameras.at(1).params);
  const std::string bytes = ModelBytes();
  WriteSparseModelBinary(folder_, start);
  EXPECT_EQ(ModelBytes(), bytes);
  // Where the mapper had the distortion free, it counts as sound whatever becomes of ours.
  EXPECT_TRUE(Adjust(start, false).distortion_is_sound);
}

TEST_F(AdjustLensTest, AFocalLengthThatMovesTooFarIsRefused) {
  // A lens of 2.2 times the focal length, and all else as a mapper would fit it to that.
  SparseModel start = exact_;
  Camera& camera = start.cameras.at(1);
  camera.params = {2.2 * 900, 2.2 * 900, 504.6, 372, 0, 0, 0, 0};
  for (PosedImage& image : start.images) image.cam_from_world.translation.z() += 1.2 * 2;
  const LensAdjustment adjustment = Adjust(start);
  EXPECT_FALSE(adjustment.distortion_is_sound);
  EXPECT_NE(
      adjustment.outcome.find("; lens kept as the mapper left it: the focal length moved too far"),
      std::string::npos)
      << adjustment.outcome;
}

TEST_F(AdjustLensTest, TwoPicturesSayTooLittle) {
  SparseModel start = exact_;
  start.images.resize(2);
  for (auto& [id, point] : start.points3D) point.track.clear();
  const LensAdjustment adjustment = Adjust(start);
  EXPECT_NE(adjustment.outcome.find(
                "; lens kept as the mapper left it: it takes three pictures at least"),
            std::string::npos);
  EXPECT_EQ(adjustment.model.cameras.at(1).params, ExactLens().params);
}

TEST_F(AdjustLensTest, HoldsThePrincipalPointWhenTold) {
  const LensAdjustment adjustment = Adjust(Disturbed(exact_), true, false);
  EXPECT_EQ(adjustment.model.cameras.at(1).PrincipalX(), 500);
  EXPECT_EQ(adjustment.model.cameras.at(1).PrincipalY(), 375);
  EXPECT_NE(adjustment.model.cameras.at(1).params[4], 0);
}

TEST(ReprojectionErrorTest, RootMeanSquareOverWhatIsTriangulated) {
  SparseModel model = ExactSurvey(ExactLens(), 3);
  EXPECT_LT(ReprojectionError(model), 1e-9);
  for (PosedImage& image : model.images) {
    for (Eigen::Vector2d& pixel : image.points2D) pixel += Eigen::Vector2d(3, -4);
  }
  EXPECT_NEAR(ReprojectionError(model), 5, 1e-9);
  // Half of the pictures are exact: sqrt(25 / 2) where they see as many points.
  const Camera& camera = model.cameras.at(1);
  double count = 0, wrong = 0;
  for (size_t k = 0; k < model.images.size(); ++k) {
    PosedImage& image = model.images[k];
    for (size_t i = 0; i < image.points2D.size(); ++i) {
      const Eigen::Vector3d xyz = model.points3D.at(image.point3D_ids[i]).xyz;
      if (k % 2 == 0) image.points2D[i] = *camera.ImgFromCam(image.cam_from_world * xyz);
      ++count;
      wrong += k % 2;
    }
  }
  EXPECT_NEAR(ReprojectionError(model), 5 * std::sqrt(wrong / count), 1e-9);
  for (PosedImage& image : model.images) {
    image.point3D_ids.assign(image.point3D_ids.size(), kNoPoint3D);
  }
  EXPECT_EQ(ReprojectionError(model), 0);
}

}  // namespace
}  // namespace colmap_seapoint
