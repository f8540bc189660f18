#include "colmap_seapoint/mapping/bundle_adjustment.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <map>

#include "colmap_seapoint/base/camera_projection.h"

namespace colmap_seapoint {
namespace {

// Models of more pictures are solved as a sparse system.
constexpr size_t kMaxPicturesOfDense = 50;
// Steps that gain less than this only move single points along their rays: a tolerance a hundred
// times smaller takes twice the time and moves the focal length by less than a hundredth of a
// pixel.
constexpr double kFunctionTolerance = 1e-6;
// The damping never goes below the inverse of this: it is what holds the model's frame.
constexpr double kMaxTrustRegionRadius = 1e8;

size_t NumFocals(CameraModel model) {
  return FindCameraModel(static_cast<int>(model))->has_single_focal ? 1 : 2;
}

struct ReprojectionResidual {
  CameraModel model;
  size_t num_focals;
  Eigen::Vector2d pixel;
  double weight;  // 1 / pixels

  template <typename T>
  bool operator()(const T* rotation, const T* translation, const T* xyz, const T* params,
                  T* residual) const {
    using Vector3 = Eigen::Matrix<T, 3, 1>;
    const Eigen::Map<const Eigen::Quaternion<T>> cam_from_world(rotation);
    const Vector3 in_cam =
        cam_from_world * Eigen::Map<const Vector3>(xyz) + Eigen::Map<const Vector3>(translation);
    const Eigen::Matrix<T, 2, 1> d = DistortedDirection(model, params, in_cam);
    residual[0] = weight * (params[0] * d.x() + params[num_focals] - pixel.x());
    residual[1] = weight * (params[num_focals - 1] * d.y() + params[num_focals + 1] - pixel.y());
    return true;
  }
};

template <int kNumParams>
ceres::CostFunction* MakeCost(const ReprojectionResidual& residual) {
  return new ceres::AutoDiffCostFunction<ReprojectionResidual, 2, 4, 3, 3, kNumParams>(
      new ReprojectionResidual(residual));
}

ceres::CostFunction* MakeReprojectionCost(const Camera& camera, const Eigen::Vector2d& pixel,
                                          double sigma) {
  const ReprojectionResidual residual = {camera.model, NumFocals(camera.model), pixel, 1 / sigma};
  switch (camera.params.size()) {
    case 3:
      return MakeCost<3>(residual);
    case 4:
      return MakeCost<4>(residual);
    case 5:
      return MakeCost<5>(residual);
    case 6:
      return MakeCost<6>(residual);
    case 8:
      return MakeCost<8>(residual);
    case 12:
      return MakeCost<12>(residual);
    default:
      return MakeCost<16>(residual);
  }
}

struct PrincipalPointPrior {
  size_t idx;
  Eigen::Vector2d before;
  double weight;

  template <typename T>
  bool operator()(T const* const* params, T* residual) const {
    residual[0] = weight * (params[0][idx] - before.x());
    residual[1] = weight * (params[0][idx + 1] - before.y());
    return true;
  }
};

// Fills the problem with the model's own memory, which the solver then changes.
class Adjustment {
 public:
  Adjustment(const BundleAdjustmentOptions& options, SparseModel* model)
      : options_(options), model_(model) {}

  bool Run() {
    for (PosedImage& image : model_->images) AddImage(&image);
    if (problem_.NumResidualBlocks() == 0) return false;
    for (auto& [id, camera] : model_->cameras) {
      if (problem_.HasParameterBlock(camera.params.data())) AddCamera(&camera);
    }
    ceres::Solver::Summary summary;
    ceres::Solve(SolverOptions(), &problem_, &summary);
    return summary.IsSolutionUsable();
  }

 private:
  void AddImage(PosedImage* image) {
    Camera& camera = model_->cameras.at(image->camera_id);
    if (camera.model == CameraModel::kEquirectangular) return;  // has no lens
    for (size_t i = 0; i < image->points2D.size(); ++i) {
      if (image->point3D_ids[i] != kNoPoint3D) AddObservation(i, image, &camera);
    }
    Rigid3d& pose = image->cam_from_world;
    if (!problem_.HasParameterBlock(pose.translation.data())) return;
    problem_.SetManifold(pose.rotation.coeffs().data(), new ceres::EigenQuaternionManifold);
    ++num_pictures_;
  }

  void AddObservation(size_t idx, PosedImage* image, Camera* camera) {
    Rigid3d& pose = image->cam_from_world;
    Eigen::Vector3d& xyz = model_->points3D.at(image->point3D_ids[idx]).xyz;
    if (!camera->ImgFromCam(pose * xyz)) return;
    problem_.AddResidualBlock(
        MakeReprojectionCost(*camera, image->points2D[idx], options_.observation_sigma), &loss_,
        pose.rotation.coeffs().data(), pose.translation.data(), xyz.data(), camera->params.data());
  }

  void AddCamera(Camera* camera) {
    if (options_.refine_principal_point) {
      AddPrincipalPointPrior(camera);
    } else {
      HoldPrincipalPoint(camera);
    }
  }

  void HoldPrincipalPoint(Camera* camera) {
    const int idx = static_cast<int>(NumFocals(camera->model));
    const int num_params = static_cast<int>(camera->params.size());
    problem_.SetManifold(camera->params.data(),
                         new ceres::SubsetManifold(num_params, {idx, idx + 1}));
  }

  void AddPrincipalPointPrior(Camera* camera) {
    const double sigma = options_.principal_point_sigma * std::max(camera->width, camera->height);
    auto* cost =
        new ceres::DynamicAutoDiffCostFunction<PrincipalPointPrior>(new PrincipalPointPrior{
            NumFocals(camera->model), {camera->PrincipalX(), camera->PrincipalY()}, 1 / sigma});
    cost->AddParameterBlock(static_cast<int>(camera->params.size()));
    cost->SetNumResiduals(2);
    problem_.AddResidualBlock(cost, nullptr, camera->params.data());
  }

  static ceres::Problem::Options ProblemOptions() {
    ceres::Problem::Options options;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;  // all residuals share one
    return options;
  }

  ceres::Solver::Options SolverOptions() const {
    ceres::Solver::Options options;
    options.linear_solver_type =
        num_pictures_ <= kMaxPicturesOfDense ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
    // The other libraries hand the work to a BLAS, which has threads of its own.
    options.dense_linear_algebra_library_type = ceres::EIGEN;
    options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
    options.num_threads = 1;
    options.max_num_iterations = options_.max_num_iterations;
    options.function_tolerance = kFunctionTolerance;
    options.max_trust_region_radius = kMaxTrustRegionRadius;
    options.logging_type = ceres::SILENT;
    return options;
  }

  BundleAdjustmentOptions options_;
  SparseModel* model_;
  ceres::SoftLOneLoss loss_{1};
  ceres::Problem problem_{ProblemOptions()};
  size_t num_pictures_ = 0;
};

void UpdatePointErrors(SparseModel* model) {
  std::map<uint64_t, double> sums;
  for (const PosedImage& image : model->images) {
    const Camera& camera = model->cameras.at(image.camera_id);
    for (size_t i = 0; i < image.points2D.size(); ++i) {
      const uint64_t id = image.point3D_ids[i];
      if (id == kNoPoint3D) continue;
      const auto pixel = camera.ImgFromCam(image.cam_from_world * model->points3D.at(id).xyz);
      if (pixel) sums[id] += (*pixel - image.points2D[i]).norm();
    }
  }
  for (auto& [id, point] : model->points3D) {
    if (!point.track.empty()) point.error = sums[id] / static_cast<double>(point.track.size());
  }
}

}  // namespace

std::optional<SparseModel> AdjustBundle(const BundleAdjustmentOptions& options,
                                        const SparseModel& model) {
  SparseModel adjusted = model;
  if (!Adjustment(options, &adjusted).Run()) return std::nullopt;
  for (PosedImage& image : adjusted.images) image.cam_from_world.rotation.normalize();
  UpdatePointErrors(&adjusted);
  return adjusted;
}

}  // namespace colmap_seapoint
