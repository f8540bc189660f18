// How different two colours look.
#pragma once

#include <Eigen/Core>

namespace colmap_seapoint {

// CIE L*a*b* (D65) of linear light in sRGB's primaries, 1 = white.
Eigen::Vector3d LabFromLinear(const Eigen::Array3d& rgb);
// CIEDE2000 (Sharma, Wu and Dalal 2005); about 1 is just seen.
double DeltaE2000(const Eigen::Vector3d& lab1, const Eigen::Vector3d& lab2);

}  // namespace colmap_seapoint
