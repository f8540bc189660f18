// A model as bundle adjustment wants it: flat tables of observations, and apart from them the
// values that are adjusted. Pictures, lenses and points are counted from zero; what cannot take
// part (see MakeBundle) is not in it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "colmap_seapoint/adjustment/equations/lens_jacobian.h"
#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

// What of a camera's lens is adjusted.
struct LensFreedom {
  uint32_t held_params = 0;  // bit k: params[k], in COLMAP's order, stays as it is
  bool ties_focals = false;  // fx = fy, from their mean on
  // Standard deviation of the principal point about where it was, pixels; 0: it moves freely.
  double principal_point_sigma = 0;
  // Standard deviation of the focal lengths about `focal_prior`, pixels; 0: they are free.
  double focal_prior = 0, focal_sigma = 0;

  bool Holds(size_t param) const { return (held_params >> param & 1) != 0; }
};

// All of all lenses, by camera id.
std::map<uint32_t, LensFreedom> AllLensesHeld(const SparseModel& model);

struct BundleLens {
  CameraModel model = CameraModel::kSimplePinhole;
  std::array<int, kMaxLensParams> slots{};  // which free value a parameter is; -1: none, it stays
  int num_free = 0;
  // Where a prior wants focal lengths and principal point, and how much: 1 / pixels^2.
  LensParams prior{}, prior_weights{};
};

struct BundlePose {  // cam_from_world
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const { return rotation * x + translation; }
};

struct BundleValues {
  std::vector<BundlePose> poses;  // of each picture
  std::vector<LensParams> lenses;
  std::vector<Eigen::Vector3d> points;
};

struct Bundle {
  std::vector<BundleLens> lenses;
  std::vector<uint32_t> lens_of_picture;
  std::vector<bool> holds_pose;  // of each picture: it stays where it is
  // Of each observation; those of a point stand together, in the order of the pictures.
  std::vector<Eigen::Vector2d> pixels;
  std::vector<uint32_t> picture_of, point_of;
  std::vector<uint32_t> point_begin;  // observations of point p: [point_begin[p], point_begin[p+1])
  // The observations of picture i, in ascending order: of_picture[picture_begin[i] ...].
  std::vector<uint32_t> picture_begin, of_picture;
  // The lenses that see point p, ascending: share_lens[share_begin[p] ...].
  std::vector<uint32_t> share_begin, share_lens;
  // Where they come from.
  std::vector<uint32_t> image_idx;  // of each picture, in SparseModel::images
  std::vector<uint32_t> camera_id;  // of each lens
  std::vector<uint64_t> point_id;   // of each point

  size_t NumPictures() const { return lens_of_picture.size(); }
  size_t NumPoints() const { return point_id.size(); }
  size_t NumObservations() const { return pixels.size(); }
};

// The model's observations of points that lie before their cameras and are seen by two pictures or
// more; the others would say nothing of the poses. Passed over are, further, pictures without a
// camera or through an equirectangular one (it has no lens), features of points that the model does
// not hold, and whatever is not finite. Lenses that `freedom` does not name are adjusted in full;
// pictures of `held_images` (image_ids) keep their poses.
Bundle MakeBundle(const SparseModel& model, const std::map<uint32_t, LensFreedom>& freedom,
                  const std::set<uint32_t>& held_images = {});

// The model's values, with tied focal lengths already equal.
BundleValues ReadValues(const Bundle& bundle, const std::map<uint32_t, LensFreedom>& freedom,
                        const SparseModel& model);
// Held poses are not touched.
void WriteValues(const Bundle& bundle, const BundleValues& values, SparseModel* model);

}  // namespace colmap_seapoint
