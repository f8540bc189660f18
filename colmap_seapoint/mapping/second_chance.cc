#include "colmap_seapoint/mapping/second_chance.h"

#include <algorithm>
#include <map>
#include <vector>

#include "colmap_seapoint/base/natural_order.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kStrongPair = 30;  // verified matches

// Ids of the pictures with a strong pair.
std::set<uint32_t> StronglyTied(const ColmapDatabase& database) {
  std::set<uint32_t> tied;
  for (const ImagePair& pair : ReadVerifiedPairs(database)) {
    if (tied.count(pair.first) > 0 && tied.count(pair.second) > 0) continue;
    if (ReadTwoViewGeometry(database, pair).inliers.size() >= kStrongPair) {
      tied.insert({pair.first, pair.second});
    }
  }
  return tied;
}

}  // namespace

std::set<std::string> FindSecondChancePictures(const ColmapDatabase& database) {
  std::vector<DatabaseImage> pictures;
  for (const DatabaseImage& image : ReadImages(database)) {
    const auto features = ReadFeatures(database, image.image_id);
    if (features && !features->points.empty()) pictures.push_back(image);
  }
  std::sort(pictures.begin(), pictures.end(), [](const DatabaseImage& a, const DatabaseImage& b) {
    return NaturalLess(a.name, b.name);
  });
  const std::set<uint32_t> tied = StronglyTied(database);
  std::set<std::string> chosen;
  for (size_t i = 0; i < pictures.size(); ++i) {
    if (tied.count(pictures[i].image_id) > 0) continue;
    chosen.insert(pictures[i].name);
    if (i > 0) chosen.insert(pictures[i - 1].name);
    if (i + 1 < pictures.size()) chosen.insert(pictures[i + 1].name);
  }
  return chosen;
}

}  // namespace colmap_seapoint
