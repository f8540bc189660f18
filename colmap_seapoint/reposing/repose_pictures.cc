#include "colmap_seapoint/reposing/repose_pictures.h"

#include <algorithm>
#include <map>
#include <optional>

#include "colmap_seapoint/io/colmap/database_matches.h"
#include "colmap_seapoint/reposing/absolute_pose.h"
#include "colmap_seapoint/reposing/match_agreement.h"

namespace colmap_seapoint {
namespace {

constexpr double kMaxError = 4;  // pixels
constexpr int kMinInliers = 20;

// Where the picture's matches with pictures that stand right say that its keypoints lie.
std::vector<SeenPlace> PlacesSeen(const ColmapDatabase& database, const SparseModel& model,
                                  const PosedImage& image,
                                  const std::map<uint32_t, const PosedImage*>& firm_images,
                                  const std::vector<PairAgreement>& pairs) {
  std::vector<SeenPlace> places;
  for (const PairAgreement& pair : pairs) {
    const uint32_t id1 = model.images[pair.image_idx1].image_id;
    const uint32_t id2 = model.images[pair.image_idx2].image_id;
    if (id1 != image.image_id && id2 != image.image_id) continue;
    const auto other = firm_images.find(id1 == image.image_id ? id2 : id1);
    if (other == firm_images.end()) continue;
    const ImagePair ids = std::minmax(id1, id2);
    for (const FeatureMatch& match : ReadTwoViewGeometry(database, ids).inliers) {
      const bool is_first = ids.first == image.image_id;
      const uint32_t own = is_first ? match.idx1 : match.idx2;
      const uint32_t others = is_first ? match.idx2 : match.idx1;
      if (own >= image.points2D.size() || others >= other->second->point3D_ids.size()) continue;
      const uint64_t point_id = other->second->point3D_ids[others];
      if (point_id == kNoPoint3D) continue;
      places.push_back({image.points2D[own], model.points3D.at(point_id).xyz});
    }
  }
  return places;
}

std::optional<Rigid3d> BetterPose(const Camera& camera, const PosedImage& image,
                                  const std::vector<SeenPlace>& places) {
  const auto pose = FindAbsolutePose(camera, places, kMaxError);
  if (!pose) return std::nullopt;
  const int num_now = CountInliers(camera, image.cam_from_world, places, kMaxError);
  const int num_then = CountInliers(camera, *pose, places, kMaxError);
  const bool is_better = num_then >= kMinInliers && num_then >= 2 * num_now &&
                         2 * static_cast<size_t>(num_then) > places.size();
  return is_better ? pose : std::nullopt;
}

// Points that fewer than two observe afterwards stay in nobody's way: the model is triangulated
// anew.
void LetGo(PosedImage* image, SparseModel* model) {
  for (uint64_t& point_id : image->point3D_ids) {
    if (point_id == kNoPoint3D) continue;
    auto& track = model->points3D.at(point_id).track;
    track.erase(std::remove_if(track.begin(), track.end(),
                               [&](const auto& e) { return e.image_id == image->image_id; }),
                track.end());
    point_id = kNoPoint3D;
  }
}

}  // namespace

std::vector<std::string> ReposePictures(const ColmapDatabase& database, SparseModel* model) {
  const std::vector<PairAgreement> pairs = CheckMatches(database, *model);
  const std::vector<uint32_t> misplaced = MisplacedPictures(pairs, model->images.size());
  std::map<uint32_t, const PosedImage*> firm_images;
  for (const PosedImage& image : model->images) firm_images[image.image_id] = &image;
  for (const uint32_t idx : misplaced) firm_images.erase(model->images[idx].image_id);
  // The least wrong one first: it has the most neighbours that stand right, and helps the others.
  std::vector<std::string> moved;
  for (auto idx = misplaced.rbegin(); idx != misplaced.rend(); ++idx) {
    PosedImage& image = model->images[*idx];
    const auto pose = BetterPose(model->cameras.at(image.camera_id), image,
                                 PlacesSeen(database, *model, image, firm_images, pairs));
    if (!pose) continue;
    image.cam_from_world = *pose;
    LetGo(&image, model);
    moved.push_back(image.name);
  }
  return moved;
}

}  // namespace colmap_seapoint
