// What a picture itself tells of why nothing came out of a part of it: cheap measures of texture,
// sharpness and exposure, on cells of kPictureCell pixels.
#pragma once

#include <cstdint>
#include <vector>

#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {

// Of MeasurePicture(): raised when it says something else of a picture.
inline constexpr char kPictureFactsVersion[] = "1";

inline constexpr int kPictureCell = 16;  // pixels

enum PictureCellFlag : uint8_t { kMaskedCell = 1, kBadlyExposedCell = 2 };

struct PictureFacts {
  int width = 0, height = 0;  // cells
  // Deviation of brightness within the cell from one that rises evenly, as a lamp's light does; in
  // quarters of a level.
  std::vector<uint8_t> texture;
  std::vector<uint8_t> flags;  // PictureCellFlag
  double sharpness = 0;  // of the picture: contrast of neighbours over that of cells, their median
  bool is_bad = false;   // blurred or badly exposed as a whole (JudgePictures)

  bool Empty() const { return texture.empty(); }
  // Of a pixel position, clamped into the picture.
  size_t CellAt(double x, double y) const;
};

// `mask`: of the same size, 0 where hidden; or empty. Brightness is averaged over 2 x 2 pixels
// before anything is measured, so that the sensor's noise counts half. About 1 ns a pixel.
PictureFacts MeasurePicture(const GrayImage& luma, const GrayImage& mask);

// Sets is_bad: a picture whose sharpness is below half of what is usual in the survey (median of
// all, and of the six around it in the order of the vector), or most of which is black or burnt.
void JudgePictures(std::vector<PictureFacts>* pictures);

}  // namespace colmap_seapoint
