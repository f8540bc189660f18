#include "colmap_seapoint/gaps/gap_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "colmap_seapoint/gaps/gap_colors.h"

namespace colmap_seapoint {
namespace {

constexpr int kLongerSide = 1600;  // pixels
constexpr int kLegendHeight = 96;
// Of so many of the largest gaps the passes and numbers are drawn: more cannot be read.
constexpr size_t kNumDrawn = 25;
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;

cv::Vec3b ColourOf(GapCause cause) {
  const std::array<uint8_t, 3> color = CauseColor(cause);
  return {color[0], color[1], color[2]};
}

struct Frame {
  int x0 = 0, y1 = 0;  // cell of the upper left corner
  double pixels_a_cell = 1;
  cv::Size size;

  cv::Point Place(double x, double y) const {  // in cells
    return {static_cast<int>((x - x0) * pixels_a_cell),
            static_cast<int>((y1 + 1 - y) * pixels_a_cell)};
  }
};

Frame FrameOf(const GroundLayer& layer) {
  constexpr int kSide = TiledGrid<GroundCell>::kSide;
  int x0 = std::numeric_limits<int>::max(), y0 = x0, x1 = std::numeric_limits<int>::min(), y1 = x1;
  for (const TileKey& key : layer.cells.Keys()) {
    const TiledGrid<GroundCell>::Tile& tile = layer.cells.ExistingTile(key);
    for (int i = 0; i < kSide * kSide; ++i) {
      if (!tile[static_cast<size_t>(i)].is_expected) continue;
      const int x = key.x * kSide + i % kSide, y = key.y * kSide + i / kSide;
      x0 = std::min(x0, x);
      x1 = std::max(x1, x);
      y0 = std::min(y0, y);
      y1 = std::max(y1, y);
    }
  }
  Frame frame;
  if (x0 > x1) return frame;
  constexpr int kMargin = 8;
  frame.x0 = x0 - kMargin;
  frame.y1 = y1 + kMargin;
  const double width = x1 - x0 + 1 + 2 * kMargin, height = y1 - y0 + 1 + 2 * kMargin;
  frame.pixels_a_cell = std::min(8.0, kLongerSide / std::max(width, height));
  frame.size = cv::Size(std::max(1, static_cast<int>(width * frame.pixels_a_cell)),
                        std::max(1, static_cast<int>(height * frame.pixels_a_cell)));
  return frame;
}

cv::Vec3b CellColour(const GroundLayer& layer, int x, int y, double cell_side) {
  const GroundCell* cell = layer.cells.Find(x, y);
  if (cell == nullptr || !cell->is_expected) return {0, 0, 0};
  if (!cell->is_covered) return ColourOf(cell->cause);
  const GroundCell* left = layer.cells.Find(x - 2, y + 2);
  const GroundCell* right = layer.cells.Find(x + 2, y - 2);
  double shade = 110;
  if (left != nullptr && right != nullptr && left->count > 0 && right->count > 0) {
    shade += 60 * std::clamp((right->height - left->height) / (4 * cell_side), -1.0, 1.0);
  }
  const auto grey = static_cast<uint8_t>(shade);
  return {grey, grey, grey};
}

void DrawLegend(const Frame& frame, double cell_side, const std::string& unit, cv::Mat* map) {
  const int y = frame.size.height;
  cv::rectangle(*map, cv::Rect(0, y, map->cols, kLegendHeight), cv::Scalar(20, 20, 20), cv::FILLED);
  int x = 10, row = 0;
  for (int c = 1; c < kNumGapCauses; ++c) {
    const auto cause = static_cast<GapCause>(c);
    if (cause == GapCause::kOutOfArea) continue;
    if (x + 150 > map->cols && row < 2) {
      x = 10;
      ++row;
    }
    const int line = y + 10 + 20 * row;
    cv::rectangle(*map, cv::Rect(x, line, 12, 12), cv::Scalar(ColourOf(cause)), cv::FILLED);
    cv::putText(*map, GapCauseName(cause), {x + 18, line + 11}, kFont, 0.42,
                cv::Scalar(255, 255, 255), 1, cv::LINE_AA);
    x += 150;
  }
  const double cells =
      std::pow(10, std::floor(std::log10(0.4 * map->cols * cell_side / frame.pixels_a_cell))) /
      cell_side;
  const int length = static_cast<int>(cells * frame.pixels_a_cell);
  cv::rectangle(*map, cv::Rect(10, y + 76, std::max(1, length), 5), cv::Scalar(255, 255, 255),
                cv::FILLED);
  char text[64];
  std::snprintf(text, sizeof(text), "%g %s", cells * cell_side, unit.c_str());
  cv::putText(*map, text, {16 + length, y + 83}, kFont, 0.42, cv::Scalar(255, 255, 255), 1,
              cv::LINE_AA);
}

// Of a layer.
std::vector<const Gap*> LargestGaps(const CompletenessResult& result, const LayerKey& key) {
  std::vector<const Gap*> gaps;
  for (const Gap& gap : result.gaps) {
    if (!(gap.region.layer < key) && !(key < gap.region.layer)) gaps.push_back(&gap);
  }
  std::sort(gaps.begin(), gaps.end(), [](const Gap* a, const Gap* b) {
    return a->region.area != b->region.area ? a->region.area > b->region.area : a->id < b->id;
  });
  gaps.resize(std::min(gaps.size(), kNumDrawn));
  return gaps;
}

void DrawGaps(const std::vector<const Gap*>& gaps, const GroundLayer& layer, double side,
              const Frame& frame, cv::Mat* map) {
  for (const Gap* gap : gaps) {
    for (size_t i = 0; i + 1 < gap->pass.corners.size(); i += 2) {
      const Eigen::Vector3d a = layer.layer_from_world * gap->pass.corners[i];
      const Eigen::Vector3d b = layer.layer_from_world * gap->pass.corners[i + 1];
      cv::line(*map, frame.Place(a.x() / side, a.y() / side),
               frame.Place(b.x() / side, b.y() / side), cv::Scalar(255, 0, 0), 1, cv::LINE_AA);
    }
  }
  for (const Gap* gap : gaps) {
    const auto& middle = gap->region.cells[gap->region.cells.size() / 2];
    const cv::Point at = frame.Place(middle.first, middle.second);
    const std::string text = std::to_string(gap->id);
    cv::putText(*map, text, at, kFont, 0.5, cv::Scalar(0, 0, 0), 4, cv::LINE_AA);
    cv::putText(*map, text, at, kFont, 0.5, cv::Scalar(255, 255, 255), 1, cv::LINE_AA);
  }
}

}  // namespace

ColorImage DrawGapMap(const CompletenessResult& result, const LayerKey& key,
                      const std::string& unit) {
  const auto place = result.ground.layers.find(key);
  if (place == result.ground.layers.end()) return {};
  const GroundLayer& layer = place->second;
  const Frame frame = FrameOf(layer);
  if (frame.size.empty()) return {};
  ColorImage picture(std::max(640, frame.size.width), frame.size.height + kLegendHeight, 3);
  cv::Mat map(picture.height, picture.width, CV_8UC3, picture.data.data());
  for (int b = 0; b < frame.size.height; ++b) {
    for (int a = 0; a < frame.size.width; ++a) {
      const int x = frame.x0 + static_cast<int>(a / frame.pixels_a_cell);
      const int y = frame.y1 - static_cast<int>(b / frame.pixels_a_cell);
      map.at<cv::Vec3b>(b, a) = CellColour(layer, x, y, result.ground.cell_side);
    }
  }
  DrawGaps(LargestGaps(result, key), layer, result.ground.cell_side, frame, &map);
  DrawLegend(frame, result.ground.cell_side, unit, &map);
  return picture;
}

}  // namespace colmap_seapoint
