// Pictures, cameras and models without lens distortion, as COLMAP's dense tools want them.
#pragma once

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

// A PINHOLE with the same focal lengths whose picture is the largest that needs no pixel beyond the
// source's borders (as COLMAP's blank_pixels 0), up to 72 degrees aside, between a fifth and twice
// the source's size. A PINHOLE stays as it is, a SIMPLE_PINHOLE but for its name. Not for
// kEquirectangular. Cost: some ms.
Camera UndistortedCamera(const Camera& camera);

// Bilinear; black where the source shows nothing. `to` is a PINHOLE. About 10 ns a pixel.
Image<uint8_t> UndistortPicture(const Image<uint8_t>& picture, const Camera& from,
                                const Camera& to);

// The model of the undistorted pictures, in the order of their image ids (so that a picture's place
// in the file and its rank by id are one: COLMAP's versions differ in which of the two they mean).
// Only triangulated features are kept; one that the lens cannot undistort lies where its point
// projects. `model` as read with ModelContent::kTriangulated or kAll.
SparseModel UndistortedModel(const SparseModel& model);

}  // namespace colmap_seapoint
