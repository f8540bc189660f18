#include "examples/benchmarks/densify/new_area.h"

#include "colmap_seapoint/base/parallel.h"
#include "examples/survey/visibility.h"

namespace colmap_seapoint {
namespace {

constexpr int kColumns = 48, kRows = 36;
constexpr double kFarT = 1e3;

}  // namespace

std::vector<PairArea> NewAreas(const SurveyTruth& truth,
                               const std::vector<std::array<size_t, 2>>& pairs, Against against,
                               int num_threads) {
  const SurfaceVisibility visibility(truth);
  std::vector<PairArea> areas(pairs.size());
  ParallelFor(num_threads, static_cast<int64_t>(pairs.size()), [&](int64_t index) {
    const auto p = static_cast<size_t>(index);
    const PosedImage& image = truth.model.images.at(pairs[p][0]);
    const Camera& camera = truth.model.cameras.at(image.camera_id);
    const Rigid3d world_from_cam = image.cam_from_world.Inverse();
    const size_t begin = against == Against::kAllPairs || p == 0 ? 0 : p - 1;
    int num_seen = 0, num_fresh = 0;
    for (int k = 0; k < kColumns * kRows; ++k) {
      const auto ray = camera.CamFromImg({camera.width * (k % kColumns + 0.5) / kColumns,
                                          camera.height * (k / kColumns + 0.5) / kRows});
      if (!ray) continue;
      const Eigen::Vector3d direction = world_from_cam.rotation * ray->homogeneous();
      const auto hit = truth.surface.Trace(world_from_cam.translation, direction, 0, kFarT);
      if (!hit) continue;
      const auto both_see = [&](const std::array<size_t, 2>& pair) {
        return visibility.Project(pair[0], hit->xyz, hit->normal) &&
               visibility.Project(pair[1], hit->xyz, hit->normal);
      };
      if (!both_see(pairs[p])) continue;
      ++num_seen;
      bool seen_before = false;
      for (size_t q = begin; q < p && !seen_before; ++q) seen_before = both_see(pairs[q]);
      num_fresh += !seen_before;
    }
    areas[p] = {static_cast<double>(num_seen) / (kColumns * kRows),
                static_cast<double>(num_fresh) / (kColumns * kRows)};
  });
  return areas;
}

}  // namespace colmap_seapoint
