// The forms that a lens may have: a camera model of COLMAP's, and what of it is free.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "colmap_seapoint/adjustment/equations/bundle.h"
#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

enum class PrincipalPoint { kFree, kCentred, kAsItWas };

struct LensForm {
  CameraModel model = CameraModel::kOpenCV;
  uint32_t zero_params = 0;  // bit k: params[k], a distortion, is 0 and stays so
  bool has_two_focals = false;
  PrincipalPoint principal_point = PrincipalPoint::kFree;
};

// In steps, from the simplest form on, each of which is worth a look only where the one before
// proved better than those before it: radial distortion of one term; of two; decentring, and what
// wide lenses and flat ports ask for; all that OpenCV has. Each with one focal length.
std::vector<std::vector<LensForm>> LensFormSteps(PrincipalPoint principal_point);

// The same form with a focal length for each axis; of the models that have but one, that is OPENCV
// without what they lack. The form itself where it has two, or is no form of ours.
LensForm WithTwoFocals(const LensForm& form);

int NumFreeParams(const LensForm& form);
LensFreedom FreedomOf(const LensForm& form);
// Of all cameras of a model, with weak priors of the focal lengths, pixels by camera id. They
// decide where flat ground seen straight down tells nothing of them: a standard deviation of half
// the value, since the guess of a camera that says nothing of itself may be as far off, and water
// makes a third of it.
std::map<uint32_t, LensFreedom> FreedomOfLenses(const LensForm& form, const SparseModel& model,
                                                const std::map<uint32_t, double>& prior_focals);
// "RADIAL", "FULL_OPENCV without k4 k5 k6, two focal lengths, principal point in the middle".
std::string Describe(const LensForm& form);

// The lens of this form that is nearest to `camera` over its picture (least squares of a raster of
// pixels). The camera itself where it has this form already.
Camera InForm(const LensForm& form, const Camera& camera);
SparseModel InForm(const LensForm& form, SparseModel model);

}  // namespace colmap_seapoint
