#include "tests/mapping/survey_database.h"

#include <gtest/gtest.h>

#include <map>

#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "colmap_seapoint/io/image/image_file.h"

namespace colmap_seapoint {

void WriteSurveyDatabase(const SparseModel& survey, const std::filesystem::path& path) {
  ColmapDatabase database(path, ColmapDatabase::Mode::kCreateIfMissing);
  DatabaseTransaction transaction(&database);
  const uint32_t camera_id = AddCamera(&database, survey.cameras.begin()->second);
  for (const PosedImage& image : survey.images) {
    Features features;
    for (const Eigen::Vector2d& pixel : image.points2D) {
      SeaPoint point;
      point.x = static_cast<float>(pixel.x());
      point.y = static_cast<float>(pixel.y());
      features.points.push_back(point);
    }
    features.descriptors.resize(features.points.size());
    ASSERT_EQ(AddImage(&database, image.name, camera_id), image.image_id);
    WriteFeatures(&database, image.image_id, features, "survey");
  }
  std::map<ImagePair, FeatureMatches> pairs;
  for (const auto& [id, point] : survey.points3D) {
    for (const auto& a : point.track) {
      for (const auto& b : point.track) {
        if (a.image_id >= b.image_id) continue;
        pairs[{a.image_id, b.image_id}].push_back({a.point2D_idx, b.point2D_idx});
      }
    }
  }
  for (const auto& [pair, matches] : pairs) {
    TwoViewGeometry geometry;
    geometry.config = TwoViewConfig::kUncalibrated;
    geometry.F = Eigen::Matrix3d::Identity();
    geometry.inliers = matches;
    WriteMatches(&database, pair.first, pair.second, matches, geometry);
  }
  transaction.Commit();
}

void WriteTinyPictures(const SparseModel& survey, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  for (const PosedImage& image : survey.images) WriteImage(folder / image.name, GrayImage(8, 8));
}

}  // namespace colmap_seapoint
