#include "colmap_seapoint/joining/link_evidence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

namespace colmap_seapoint {
namespace {

constexpr int kCells = 6;           // along each side of a picture
constexpr size_t kMinPoints = 30;   // what COLMAP's mapper asks for to register a picture
constexpr size_t kMinPictures = 2;  // of each model
constexpr size_t kMinCells = 6;     // with a link
constexpr double kMinLinkedShare = 0.4;
constexpr double kMaxRivalShare = 0.3;
constexpr double kMinCosine = 0.94;     // 20 degrees: what SeaPoints are matched across
constexpr double kMaxDepthRatio = 1.5;  // of the two cameras to the place: what they are scaled by
constexpr double kSameDepth = 1.1;

using Cell = std::pair<uint32_t, int>;  // image_idx, number

int CellOf(const Camera& camera, const Eigen::Vector2d& pixel) {
  const auto step = [](double place, auto size) {
    return std::clamp(static_cast<int>(kCells * place / static_cast<double>(size)), 0, kCells - 1);
  };
  return kCells * step(pixel.y(), camera.height) + step(pixel.x(), camera.width);
}

bool IsWithin(double ratio, double limit) { return ratio < limit && 1 < limit * ratio; }

// The depths of a picture's own points, by cell.
std::array<std::vector<double>, kCells * kCells> DepthsOf(const SparseModel& model,
                                                          const PosedImage& image) {
  std::array<std::vector<double>, kCells * kCells> depths;
  const Camera& camera = model.cameras.at(image.camera_id);
  for (size_t i = 0; i < image.points2D.size(); ++i) {
    const auto point = model.points3D.find(image.point3D_ids[i]);
    if (point == model.points3D.end()) continue;
    const double depth = (image.cam_from_world * point->second.xyz).z();
    depths[static_cast<size_t>(CellOf(camera, image.points2D[i]))].push_back(depth);
  }
  return depths;
}

// Adds the cells of a picture of `b` where it shows what `image_a` shows, from about the same side
// and as near, with a point of b's own there.
void AddExpected(const SparseModel& a, const PosedImage& image_a, const SparseModel& b,
                 uint32_t image_idx_b, const Similarity3d& b_from_a, std::set<Cell>* cells) {
  const PosedImage& image_b = b.images[image_idx_b];
  const Camera& camera = b.cameras.at(image_b.camera_id);
  const auto depths = DepthsOf(b, image_b);
  const Eigen::Vector3d center_a = b_from_a * image_a.cam_from_world.OriginInSource();
  const Eigen::Vector3d center_b = image_b.cam_from_world.OriginInSource();
  for (const uint64_t id : image_a.point3D_ids) {
    const auto point = a.points3D.find(id);
    if (point == a.points3D.end()) continue;
    const Eigen::Vector3d xyz = b_from_a * point->second.xyz;
    const Eigen::Vector3d in_camera = image_b.cam_from_world * xyz;
    const auto pixel = camera.ImgFromCam(in_camera);
    if (!pixel || !camera.InImage(*pixel)) continue;
    const Eigen::Vector3d to_a = center_a - xyz, to_b = center_b - xyz;
    if (!IsWithin(to_a.norm() / to_b.norm(), kMaxDepthRatio)) continue;
    if (to_a.dot(to_b) < kMinCosine * to_a.norm() * to_b.norm()) continue;
    const int cell = CellOf(camera, *pixel);
    const std::vector<double>& there = depths[static_cast<size_t>(cell)];
    if (std::any_of(there.begin(), there.end(),
                    [&](double depth) { return IsWithin(depth / in_camera.z(), kSameDepth); })) {
      cells->insert({image_idx_b, cell});
    }
  }
}

std::map<uint32_t, uint32_t> IndicesOf(const SparseModel& model) {
  std::map<uint32_t, uint32_t> indices;
  for (uint32_t i = 0; i < model.images.size(); ++i) indices[model.images[i].image_id] = i;
  return indices;
}

}  // namespace

LinkEvidence WeighLinks(const SparseModel& a, const SparseModel& b, const ModelLinks& links,
                        const LinkConsensus& consensus) {
  std::set<uint64_t> points;
  std::set<uint32_t> pictures_a, pictures_b;
  std::set<Cell> linked;
  for (const size_t i : consensus.inliers) {
    const ModelLink& link = links.links[i];
    points.insert(link.point_a);
    pictures_a.insert(link.image_idx_a);
    pictures_b.insert(link.image_idx_b);
    const Camera& camera = b.cameras.at(b.images[link.image_idx_b].camera_id);
    linked.insert({link.image_idx_b, CellOf(camera, link.pixel_b)});
  }
  std::set<Cell> cells = linked;
  const auto indices_a = IndicesOf(a), indices_b = IndicesOf(b);
  for (const auto& [id_a, id_b] : links.tried) {
    AddExpected(a, a.images[indices_a.at(id_a)], b, indices_b.at(id_b), consensus.b_from_a, &cells);
  }
  return {points.size(), pictures_a.size(), pictures_b.size(), cells.size(), linked.size()};
}

std::string Doubt(const LinkEvidence& evidence, const LinkConsensus& consensus) {
  if (evidence.num_points < kMinPoints) {
    return "only " + std::to_string(evidence.num_points) + " points of both agree";
  }
  if (evidence.num_pictures_a < kMinPictures || evidence.num_pictures_b < kMinPictures) {
    return "a single picture ties them";
  }
  if (evidence.num_linked < kMinCells) return "what ties them lies too close together";
  if (static_cast<double>(consensus.num_rival_links) >
      kMaxRivalShare * static_cast<double>(consensus.inliers.size())) {
    return "two ways to join them have " + std::to_string(consensus.inliers.size()) + " and " +
           std::to_string(consensus.num_rival_links) + " matches, as where places look alike";
  }
  if (static_cast<double>(evidence.num_linked) <
      kMinLinkedShare * static_cast<double>(evidence.num_cells)) {
    return "of " + std::to_string(evidence.num_cells) +
           " parts of pictures that would show the same only " +
           std::to_string(evidence.num_linked) + " have matches, as where places look alike";
  }
  return "";
}

}  // namespace colmap_seapoint
