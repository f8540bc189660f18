// The exact place of a marker whose number is known: its whole pattern is laid over the picture
// (ours).
#pragma once

#include <optional>

#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/markers/detect_markers.h"

namespace colmap_seapoint {

// The corners of the black square at which the print, projected, blurred and lit, is most like the
// picture (least squares over its pixels). The detector's own follow the half-grey level of its
// outer edges, and that level moves them: a camera's tone curve makes white grow, and blur lets the
// white bits within shine through a border of three pixels. Here the tone curve (sRGB, and what it
// is bent beyond that), the blur, black, white and a gradient of the light are unknowns beside the
// place; that the pattern has edges of both kinds tells them apart. Sides of exact pictures of
// markers 25 pixels wide come out within 0.2 %.
// nullopt where the picture is not like the print (sand on it, a glare, a mirror image), or the
// corners would move by more than the detector errs. Cost: about 10 ms.
std::optional<std::array<Eigen::Vector2d, 4>> FitCorners(const GrayImage& picture,
                                                         const DetectedMarker& marker);

}  // namespace colmap_seapoint
