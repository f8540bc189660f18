#include "densify/completeness/sight/picture_facts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "colmap_seapoint/base/median.h"

namespace colmap_seapoint {
namespace {

constexpr double kDark = 6, kBurnt = 250;  // mean levels
// Brightness that rises evenly over a cell has that sharpness: as blurred as can be. A picture is
// blurred when it keeps less than this share of what the usual sharpness has beyond.
constexpr double kSmooth = 0.22, kBlurred = 0.5;
constexpr double kTextured = 2;    // levels: below it sharpness is that of the noise
constexpr double kBadShare = 0.5;  // of cells that are badly exposed

// Means of 2 x 2 pixels of one cell, up to 8 x 8 of them.
struct HalvedCell {
  int width = 0, height = 0;
  double value[kPictureCell / 2][kPictureCell / 2];

  HalvedCell(const GrayImage& luma, int x0, int y0) {
    width = std::min(kPictureCell, luma.width - x0) / 2;
    height = std::min(kPictureCell, luma.height - y0) / 2;
    for (int j = 0; j < height; ++j) {
      const uint8_t* top = luma.Row(y0 + 2 * j) + x0;
      const uint8_t* bottom = luma.Row(y0 + 2 * j + 1) + x0;
      for (int i = 0; i < width; ++i) {
        value[j][i] = 0.25 * (top[2 * i] + top[2 * i + 1] + bottom[2 * i] + bottom[2 * i + 1]);
      }
    }
  }
  // Mean squared difference of neighbours, both ways.
  double Contrast() const {
    double sum = 0;
    int count = 0;
    for (int j = 0; j + 1 < height; ++j) {
      for (int i = 0; i + 1 < width; ++i) {
        const double dx = value[j][i + 1] - value[j][i], dy = value[j + 1][i] - value[j][i];
        sum += dx * dx + dy * dy;
        count += 2;
      }
    }
    return count == 0 ? 0 : sum / count;
  }
};

// `texture`: the deviation of what is left when brightness that rises evenly over the cell is taken
// out.
struct CellMeasure {
  double mean = 0, deviation = 0, texture = 0, sharpness = 0;
};

// Variance that an even rise over the cell explains.
double RiseVariance(const HalvedCell& cell) {
  const double middle_x = 0.5 * (cell.width - 1), middle_y = 0.5 * (cell.height - 1);
  double xx = 0, yy = 0, xv = 0, yv = 0;
  for (int j = 0; j < cell.height; ++j) {
    for (int i = 0; i < cell.width; ++i) {
      const double x = i - middle_x, y = j - middle_y;
      xx += x * x;
      yy += y * y;
      xv += x * cell.value[j][i];
      yv += y * cell.value[j][i];
    }
  }
  const double explained = (xx > 0 ? xv * xv / xx : 0) + (yy > 0 ? yv * yv / yy : 0);
  return explained / (cell.width * cell.height);
}

CellMeasure MeasureCell(const HalvedCell& cell) {
  CellMeasure measure;
  const int count = cell.width * cell.height;
  if (count == 0) return measure;
  double sum = 0, squares = 0;
  for (int j = 0; j < cell.height; ++j) {
    for (int i = 0; i < cell.width; ++i) {
      sum += cell.value[j][i];
      squares += cell.value[j][i] * cell.value[j][i];
    }
  }
  measure.mean = sum / count;
  measure.deviation = std::sqrt(std::max(0.0, squares / count - measure.mean * measure.mean));
  measure.texture =
      std::sqrt(std::max(0.0, measure.deviation * measure.deviation - RiseVariance(cell)));
  // White noise: 1. What is smeared in one direction alone loses some of it, too.
  if (measure.deviation > 0) {
    measure.sharpness = std::sqrt(0.5 * cell.Contrast()) / measure.deviation;
  }
  return measure;
}

bool IsMasked(const GrayImage& mask, int x0, int y0) {
  if (mask.Empty()) return false;
  return mask.At(std::min(x0 + kPictureCell / 2, mask.width - 1),
                 std::min(y0 + kPictureCell / 2, mask.height - 1)) == 0;
}

double BadlyExposedShare(const PictureFacts& picture) {
  if (picture.Empty()) return 0;
  const auto num_bad = std::count_if(picture.flags.begin(), picture.flags.end(),
                                     [](uint8_t flag) { return flag & kBadlyExposedCell; });
  return static_cast<double>(num_bad) / static_cast<double>(picture.flags.size());
}

}  // namespace

size_t PictureFacts::CellAt(double x, double y) const {
  const int a = std::clamp(static_cast<int>(x) / kPictureCell, 0, width - 1);
  const int b = std::clamp(static_cast<int>(y) / kPictureCell, 0, height - 1);
  return static_cast<size_t>(b) * static_cast<size_t>(width) + static_cast<size_t>(a);
}

PictureFacts MeasurePicture(const GrayImage& luma, const GrayImage& mask) {
  PictureFacts facts;
  facts.width = (luma.width + kPictureCell - 1) / kPictureCell;
  facts.height = (luma.height + kPictureCell - 1) / kPictureCell;
  std::vector<double> sharpness;
  for (int b = 0; b < facts.height; ++b) {
    for (int a = 0; a < facts.width; ++a) {
      const int x0 = a * kPictureCell, y0 = b * kPictureCell;
      const CellMeasure cell = MeasureCell(HalvedCell(luma, x0, y0));
      const bool is_bad = cell.mean < kDark || cell.mean > kBurnt;
      facts.texture.push_back(static_cast<uint8_t>(std::min(255.0, 4 * cell.texture)));
      facts.flags.push_back(static_cast<uint8_t>((IsMasked(mask, x0, y0) ? kMaskedCell : 0) |
                                                 (is_bad ? kBadlyExposedCell : 0)));
      if (cell.deviation > kTextured && !is_bad) sharpness.push_back(cell.sharpness);
    }
  }
  if (!sharpness.empty()) facts.sharpness = UpperMedian(std::move(sharpness));
  return facts;
}

void JudgePictures(std::vector<PictureFacts>* pictures) {
  std::vector<double> all;
  for (const PictureFacts& picture : *pictures) {
    if (picture.sharpness > 0) all.push_back(picture.sharpness);
  }
  const double usual = all.empty() ? 0 : UpperMedian(std::move(all));
  const int count = static_cast<int>(pictures->size());
  std::vector<double> around;
  for (int i = 0; i < count; ++i) {
    PictureFacts& picture = (*pictures)[static_cast<size_t>(i)];
    around.clear();
    for (int k = std::max(0, i - 3); k <= std::min(count - 1, i + 3); ++k) {
      const double sharpness = (*pictures)[static_cast<size_t>(k)].sharpness;
      if (k != i && sharpness > 0) around.push_back(sharpness);
    }
    const double expected = std::min(usual, around.empty() ? usual : UpperMedian(around));
    picture.is_bad |=
        (picture.sharpness > 0 && picture.sharpness < kSmooth + kBlurred * (expected - kSmooth)) ||
        BadlyExposedShare(picture) > kBadShare;
  }
}

}  // namespace colmap_seapoint
