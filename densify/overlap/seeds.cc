#include "densify/overlap/seeds.h"

namespace colmap_seapoint {

std::vector<PixelPair> SeedsFromMatches(const std::vector<SeaPoint>& points1,
                                        const std::vector<SeaPoint>& points2,
                                        const FeatureMatches& matches,
                                        const std::vector<SeaPointLabel>& labels1) {
  std::vector<PixelPair> seeds;
  for (const FeatureMatch& match : matches) {
    if (!labels1.empty() && labels1[match.idx1] == SeaPointLabel::kOA) continue;
    const SeaPoint& a = points1[match.idx1];
    const SeaPoint& b = points2[match.idx2];
    seeds.push_back({{a.x, a.y}, {b.x, b.y}});
  }
  return seeds;
}

std::vector<PixelPair> SeedsFromModel(const SparseModel& model, const PosedImage& image1,
                                      const View& view1, const View& view2) {
  std::vector<PixelPair> seeds;
  for (const uint64_t id : image1.point3D_ids) {
    if (id == kNoPoint3D) continue;
    const Eigen::Vector3d& xyz = model.points3D.at(id).xyz;
    const auto pixel1 = view1.camera.ImgFromCam(view1.cam_from_world * xyz);
    const auto pixel2 = view2.camera.ImgFromCam(view2.cam_from_world * xyz);
    if (!pixel1 || !pixel2 || !view1.camera.InImage(*pixel1) || !view2.camera.InImage(*pixel2)) {
      continue;
    }
    seeds.push_back({*pixel1, *pixel2});
  }
  return seeds;
}

}  // namespace colmap_seapoint
