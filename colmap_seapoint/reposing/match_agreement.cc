#include "colmap_seapoint/reposing/match_agreement.h"

#include <algorithm>
#include <map>
#include <optional>

#include "colmap_seapoint/io/colmap/database_matches.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kMaxMatchesOfPair = 64;
constexpr double kMaxError = 4;  // pixels; COLMAP's own limit of a reprojection error
constexpr int kMinMatches = 20;

// Whether `image` sees the point that the other picture's keypoint observes where it has its own
// keypoint; nothing to count when that keypoint observes none.
void CountMatch(const SparseModel& model, const PosedImage& image, uint32_t keypoint,
                const PosedImage& other, uint32_t others_keypoint, MatchAccount* account) {
  if (keypoint >= image.points2D.size() || others_keypoint >= other.point3D_ids.size()) return;
  const auto point = model.points3D.find(other.point3D_ids[others_keypoint]);
  if (point == model.points3D.end()) return;
  const Eigen::Vector3d in_cam = image.cam_from_world * point->second.xyz;
  const auto pixel = model.cameras.at(image.camera_id).ImgFromCam(in_cam);
  ++account->num_matches;
  account->num_agreeing +=
      pixel && (*pixel - image.points2D[keypoint]).squaredNorm() <= kMaxError * kMaxError;
}

void CountMatches(const SparseModel& model, const FeatureMatches& matches, PairAgreement* pair) {
  const PosedImage& image1 = model.images[pair->image_idx1];
  const PosedImage& image2 = model.images[pair->image_idx2];
  const size_t step = (matches.size() + kMaxMatchesOfPair - 1) / kMaxMatchesOfPair;
  for (size_t i = 0; i < matches.size(); i += step) {
    const auto [idx1, idx2] = matches[i];
    CountMatch(model, image1, idx1, image2, idx2, &pair->account1);
    CountMatch(model, image2, idx2, image1, idx1, &pair->account2);
  }
}

bool IsBad(const MatchAccount& account) {
  return account.num_matches >= kMinMatches && 2 * account.num_agreeing < account.num_matches;
}

double Share(const MatchAccount& account) {
  return static_cast<double>(account.num_agreeing) / account.num_matches;
}

void Add(const MatchAccount& part, MatchAccount* sum) {
  sum->num_matches += part.num_matches;
  sum->num_agreeing += part.num_agreeing;
}

std::optional<uint32_t> WorstPicture(const std::vector<PairAgreement>& pairs, size_t num_images) {
  std::vector<MatchAccount> accounts(num_images);
  for (const PairAgreement& pair : pairs) {
    Add(pair.account1, &accounts[pair.image_idx1]);
    Add(pair.account2, &accounts[pair.image_idx2]);
  }
  std::optional<uint32_t> worst;
  for (uint32_t i = 0; i < num_images; ++i) {
    if (!IsBad(accounts[i])) continue;
    if (!worst || Share(accounts[i]) < Share(accounts[*worst])) worst = i;
  }
  return worst;
}

}  // namespace

std::vector<PairAgreement> CheckMatches(const ColmapDatabase& database, const SparseModel& model) {
  std::map<uint32_t, uint32_t> idx_of_id;
  for (uint32_t i = 0; i < model.images.size(); ++i) idx_of_id[model.images[i].image_id] = i;
  std::vector<PairAgreement> pairs;
  for (const ImagePair& ids : ReadVerifiedPairs(database)) {
    const auto image1 = idx_of_id.find(ids.first), image2 = idx_of_id.find(ids.second);
    if (image1 == idx_of_id.end() || image2 == idx_of_id.end()) continue;
    PairAgreement pair{image1->second, image2->second, {}, {}};
    CountMatches(model, ReadTwoViewGeometry(database, ids).inliers, &pair);
    pairs.push_back(pair);
  }
  return pairs;
}

std::vector<uint32_t> MisplacedPictures(std::vector<PairAgreement> pairs, size_t num_images) {
  std::vector<uint32_t> misplaced;
  while (const std::optional<uint32_t> worst = WorstPicture(pairs, num_images)) {
    misplaced.push_back(*worst);
    const auto is_of_worst = [&](const PairAgreement& pair) {
      return pair.image_idx1 == *worst || pair.image_idx2 == *worst;
    };
    pairs.erase(std::remove_if(pairs.begin(), pairs.end(), is_of_worst), pairs.end());
  }
  return misplaced;
}

}  // namespace colmap_seapoint
