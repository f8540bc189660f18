#include "colmap_seapoint/mapping/second_chance.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kStrongPair = 30;  // verified matches
constexpr size_t kOwnDive = 20;     // pictures

// Groups of pictures, each named by the smallest id in it.
class Groups {
 public:
  explicit Groups(const std::map<uint32_t, std::string>& pictures) {
    for (const auto& [id, name] : pictures) parents_[id] = id;
  }

  uint32_t Of(uint32_t id) const {
    while (parents_.at(id) != id) id = parents_.at(id);
    return id;
  }

  void Tie(uint32_t id1, uint32_t id2) {
    const auto [smaller, larger] = std::minmax({Of(id1), Of(id2)});
    parents_[larger] = smaller;
  }

  std::map<uint32_t, size_t> Sizes() const {
    std::map<uint32_t, size_t> sizes;
    for (const auto& [id, parent] : parents_) ++sizes[Of(id)];
    return sizes;
  }

 private:
  std::map<uint32_t, uint32_t> parents_;
};

std::map<uint32_t, std::string> PicturesWithSeaPoints(const ColmapDatabase& database) {
  std::map<uint32_t, std::string> pictures;
  for (const DatabaseImage& image : ReadImages(database)) {
    const auto features = ReadFeatures(database, image.image_id);
    if (features && !features->points.empty()) pictures[image.image_id] = image.name;
  }
  return pictures;
}

Groups GroupsOf(const ColmapDatabase& database, const std::map<uint32_t, std::string>& pictures) {
  Groups groups(pictures);
  for (const auto& [id1, id2] : ReadVerifiedPairs(database)) {
    if (pictures.count(id1) == 0 || pictures.count(id2) == 0) continue;
    if (groups.Of(id1) == groups.Of(id2)) continue;
    if (ReadTwoViewGeometry(database, {id1, id2}).inliers.size() >= kStrongPair) {
      groups.Tie(id1, id2);
    }
  }
  return groups;
}

std::set<uint32_t> FindUntied(const ColmapDatabase& database,
                              const std::map<uint32_t, std::string>& pictures) {
  const Groups groups = GroupsOf(database, pictures);
  const std::map<uint32_t, size_t> sizes = groups.Sizes();
  const auto largest = std::max_element(
      sizes.begin(), sizes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  std::set<uint32_t> untied;
  for (const auto& [id, name] : pictures) {
    const uint32_t group = groups.Of(id);
    if (group != largest->first && sizes.at(group) < kOwnDive) untied.insert(id);
  }
  return untied;
}

}  // namespace

std::set<std::string> FindSecondChancePictures(const ColmapDatabase& database) {
  const std::map<uint32_t, std::string> pictures = PicturesWithSeaPoints(database);
  const std::set<uint32_t> untied = FindUntied(database, pictures);
  std::set<std::string> chosen;
  for (const uint32_t id : untied) chosen.insert(pictures.at(id));
  for (const auto& [id1, id2] : ReadTriedPairs(database)) {
    if (pictures.count(id1) == 0 || pictures.count(id2) == 0) continue;
    if (untied.count(id1) > 0) chosen.insert(pictures.at(id2));
    if (untied.count(id2) > 0) chosen.insert(pictures.at(id1));
  }
  return chosen;
}

TieCount CountTies(const ColmapDatabase& database) {
  const std::map<uint32_t, std::string> pictures = PicturesWithSeaPoints(database);
  const Groups groups = GroupsOf(database, pictures);
  TieCount count;
  count.num_groups = groups.Sizes().size() + ReadImages(database).size() - pictures.size();
  for (const auto& [id1, id2] : ReadVerifiedPairs(database)) {
    if (pictures.count(id1) == 0 || pictures.count(id2) == 0) continue;
    if (groups.Of(id1) == groups.Of(id2)) continue;
    count.num_between += ReadTwoViewGeometry(database, {id1, id2}).inliers.size();
  }
  return count;
}

bool TiesMore(const TieCount& after, const TieCount& before) {
  if (after.num_groups != before.num_groups) return after.num_groups < before.num_groups;
  return after.num_between > before.num_between;
}

std::map<uint32_t, uint32_t> TiedGroups(const ColmapDatabase& database) {
  const std::map<uint32_t, std::string> pictures = PicturesWithSeaPoints(database);
  const Groups groups = GroupsOf(database, pictures);
  std::map<uint32_t, uint32_t> group_of;
  for (const auto& [id, name] : pictures) group_of[id] = groups.Of(id);
  return group_of;
}

}  // namespace colmap_seapoint
