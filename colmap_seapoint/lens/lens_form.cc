#include "colmap_seapoint/lens/lens_form.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "colmap_seapoint/adjustment/equations/lens_jacobian.h"

namespace colmap_seapoint {
namespace {

// Places of distortion parameters.
constexpr uint32_t kOpenCVDecentring = 1u << 6 | 1u << 7;
constexpr uint32_t kOpenCVK2 = 1u << 5;
constexpr uint32_t kDenominator = 1u << 9 | 1u << 10 | 1u << 11;  // of FULL_OPENCV: k4, k5, k6

constexpr double kFocalPriorShare = 0.5;
constexpr int kRaster = 12;  // pixels of a side
constexpr int kMaxSteps = 20;

int NumParams(CameraModel model) { return FindCameraModel(static_cast<int>(model))->num_params; }

bool IsZero(const LensForm& form, int param) { return (form.zero_params >> param & 1) != 0; }

bool IsTied(const LensForm& form) { return NumFocals(form.model) == 2 && !form.has_two_focals; }

bool IsFree(const LensForm& form, int param) {
  const int num_focals = NumFocals(form.model);
  if (param == 1 && num_focals == 2) return true;  // tied or not
  const bool is_principal_point = param >= num_focals && param < num_focals + 2;
  return is_principal_point ? form.principal_point == PrincipalPoint::kFree : !IsZero(form, param);
}

struct Sighting {
  Eigen::Vector2d pixel;
  Eigen::Vector3d direction;
};

std::vector<Sighting> RasterOf(const Camera& camera) {
  std::vector<Sighting> raster;
  for (int row = 0; row < kRaster; ++row) {
    for (int column = 0; column < kRaster; ++column) {
      const Eigen::Vector2d pixel(camera.width * (column + 0.5) / kRaster,
                                  camera.height * (row + 0.5) / kRaster);
      if (const auto ray = camera.CamFromImg(pixel)) raster.push_back({pixel, ray->homogeneous()});
    }
  }
  return raster;
}

double SquaredError(CameraModel model, const LensParams& params,
                    const std::vector<Sighting>& raster) {
  double sum = 0;
  for (const Sighting& s : raster) {
    sum += (ProjectThroughLens(model, params, s.direction) - s.pixel).squaredNorm();
  }
  return sum;
}

// One Gauss-Newton step of the free parameters, tied focal lengths as one.
LensParams Step(const LensForm& form, const LensParams& params,
                const std::vector<Sighting>& raster) {
  const bool is_tied = IsTied(form);
  std::vector<int> free;
  for (int k = 0; k < NumParams(form.model); ++k) {
    if (IsFree(form, k) && !(is_tied && k == 1)) free.push_back(k);
  }
  const auto n = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  for (const Sighting& s : raster) {
    const LensJacobian at = DifferentiateLens(form.model, params, s.direction);
    Eigen::Matrix2Xd rows(2, n);
    for (Eigen::Index k = 0; k < n; ++k) {
      rows.col(k) = at.by_params.col(free[static_cast<size_t>(k)]);
    }
    if (is_tied) rows.col(0) += at.by_params.col(1);
    normal += rows.transpose() * rows;
    right += rows.transpose() * (s.pixel - at.pixel);
  }
  normal.diagonal() *= 1 + 1e-9;
  const Eigen::VectorXd step = normal.ldlt().solve(right);
  LensParams moved = params;
  for (Eigen::Index k = 0; k < n; ++k) {
    moved[static_cast<size_t>(free[static_cast<size_t>(k)])] += step[k];
  }
  if (is_tied) moved[1] = moved[0];
  return moved;
}

// Focal lengths and principal point as they are; no distortion.
LensParams Undistorted(const LensForm& form, const Camera& camera) {
  LensParams params{};
  size_t k = 0;
  if (NumFocals(form.model) == 2) {
    params[k++] = form.has_two_focals ? camera.FocalX() : camera.MeanFocal();
    params[k++] = form.has_two_focals ? camera.FocalY() : camera.MeanFocal();
  } else {
    params[k++] = camera.MeanFocal();
  }
  const bool is_centred = form.principal_point == PrincipalPoint::kCentred;
  params[k++] = is_centred ? 0.5 * camera.width : camera.PrincipalX();
  params[k] = is_centred ? 0.5 * camera.height : camera.PrincipalY();
  return params;
}

}  // namespace

std::vector<std::vector<LensForm>> LensFormSteps(PrincipalPoint principal_point) {
  std::vector<std::vector<LensForm>> steps = {{{CameraModel::kSimpleRadial}},
                                              {{CameraModel::kRadial}},
                                              {{CameraModel::kOpenCV},
                                               {CameraModel::kOpenCVFisheye},
                                               {CameraModel::kFullOpenCV, kDenominator}},
                                              {{CameraModel::kFullOpenCV}}};
  for (std::vector<LensForm>& forms : steps) {
    for (LensForm& form : forms) form.principal_point = principal_point;
  }
  return steps;
}

LensForm WithTwoFocals(const LensForm& form) {
  LensForm two = form;
  two.has_two_focals = true;
  if (form.model == CameraModel::kRadial) {
    two.model = CameraModel::kOpenCV;
    two.zero_params = kOpenCVDecentring;
  } else if (form.model == CameraModel::kSimpleRadial) {
    two.model = CameraModel::kOpenCV;
    two.zero_params = kOpenCVDecentring | kOpenCVK2;
  } else if (NumFocals(form.model) != 2) {
    return form;
  }
  return two;
}

int NumFreeParams(const LensForm& form) {
  int count = IsTied(form) ? -1 : 0;
  for (int k = 0; k < NumParams(form.model); ++k) count += IsFree(form, k) ? 1 : 0;
  return count;
}

LensFreedom FreedomOf(const LensForm& form) {
  LensFreedom freedom;
  freedom.ties_focals = IsTied(form);
  for (int k = 0; k < NumParams(form.model); ++k) {
    if (!IsFree(form, k)) freedom.held_params |= 1u << k;
  }
  return freedom;
}

std::map<uint32_t, LensFreedom> FreedomOfLenses(const LensForm& form, const SparseModel& model,
                                                const std::map<uint32_t, double>& prior_focals) {
  std::map<uint32_t, LensFreedom> lenses;
  for (const auto& [id, camera] : model.cameras) {
    LensForm of_camera = form;
    of_camera.model = camera.model;
    LensFreedom& freedom = lenses[id] = FreedomOf(of_camera);
    const auto prior = prior_focals.find(id);
    if (prior == prior_focals.end()) continue;
    freedom.focal_prior = prior->second;
    freedom.focal_sigma = kFocalPriorShare * prior->second;
  }
  return lenses;
}

std::string Describe(const LensForm& form) {
  std::string text = FindCameraModel(static_cast<int>(form.model))->name;
  if (form.zero_params != 0) {
    constexpr const char* kNames[] = {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
    text += " without";
    for (int k = 0; k < 8; ++k) {
      if (IsZero(form, k + 4)) text += std::string(" ") + kNames[k];
    }
  }
  if (form.has_two_focals) text += ", two focal lengths";
  if (form.principal_point == PrincipalPoint::kCentred) text += ", principal point in the middle";
  return text;
}

Camera InForm(const LensForm& form, const Camera& camera) {
  if (camera.model == form.model && form.zero_params == 0 && !IsTied(form) &&
      form.principal_point != PrincipalPoint::kCentred) {
    return camera;
  }
  const std::vector<Sighting> raster = RasterOf(camera);
  LensParams params = Undistorted(form, camera);
  double error = SquaredError(form.model, params, raster);
  for (int step = 0; step < kMaxSteps; ++step) {
    const LensParams moved = Step(form, params, raster);
    const double moved_error = SquaredError(form.model, moved, raster);
    if (!(moved_error < error)) break;
    params = moved;
    error = moved_error;
  }
  Camera converted = camera;
  converted.model = form.model;
  converted.params.assign(params.begin(), params.begin() + NumParams(form.model));
  return converted;
}

SparseModel InForm(const LensForm& form, SparseModel model) {
  for (auto& [id, camera] : model.cameras) camera = InForm(form, camera);
  return model;
}

}  // namespace colmap_seapoint
