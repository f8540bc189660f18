#include "densify/overlap/influence_mask.h"

#include <algorithm>
#include <cmath>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {

namespace {

constexpr float kMinFilledCell = 0.75f;  // share of a cell's samples
constexpr double kMinFilled = 0.25;  // share of samples around a SeaPoint that make it "processed"

// Calls visit(cell index) for the cells whose centre lies within `radius` of (x, y).
template <typename Visit>
void ForEachCellAround(const CellGrid& grid, double x, double y, double radius,
                       const Visit& visit) {
  const int a0 = std::max(0, static_cast<int>((x - radius) / grid.cell));
  const int b0 = std::max(0, static_cast<int>((y - radius) / grid.cell));
  const int a1 = std::min(grid.width - 1, static_cast<int>((x + radius) / grid.cell));
  const int b1 = std::min(grid.height - 1, static_cast<int>((y + radius) / grid.cell));
  for (int b = b0; b <= b1; ++b) {
    const double dy = (b + 0.5) * grid.cell - y;
    for (int a = a0; a <= a1; ++a) {
      const double dx = (a + 0.5) * grid.cell - x;
      if (dx * dx + dy * dy > radius * radius) continue;
      visit(static_cast<size_t>(b) * static_cast<size_t>(grid.width) + static_cast<size_t>(a));
    }
  }
}

Eigen::Vector2d PixelOf(const SeaPoint& point) { return {point.x, point.y}; }

bool IsFilled(const ProcessedPicture& picture, const Eigen::Vector2d& pixel) {
  if (picture.filled.empty()) return true;
  const CellGrid& grid = picture.grid;
  return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < grid.width * grid.cell &&
         pixel.y() < grid.height * grid.cell &&
         picture.filled[grid.IndexOf(pixel.x(), pixel.y())] >= kMinFilledCell;
}

bool IsRea(const std::vector<SeaPointLabel>& labels, uint32_t idx) {
  return labels[idx] == SeaPointLabel::kREA;
}

}  // namespace

double InfluenceMask::OverlapRate() const {
  if (marked.empty()) return 0;
  return static_cast<double>(std::count(marked.begin(), marked.end(), 1)) /
         static_cast<double>(marked.size());
}

InfluenceMask MakeInfluenceMask(const CellGrid& grid, const std::vector<SeaPoint>& candidate_points,
                                const FeatureMatches& matches, const ProcessedPicture& previous,
                                double radius) {
  InfluenceMask mask{grid, std::vector<uint8_t>(grid.Size(), 0)};
  for (const bool erasing : {false, true}) {
    for (const FeatureMatch& match : matches) {
      if (IsRea(previous.labels, match.idx1) != erasing) continue;
      const SeaPoint& point = candidate_points[match.idx2];
      Eigen::Vector2d back(0, 0);  // along the match, to the previous picture
      if (!previous.filled.empty()) back = PixelOf(previous.points[match.idx1]) - PixelOf(point);
      ForEachCellAround(grid, point.x, point.y, radius, [&](size_t cell) {
        if (erasing) {
          mask.marked[cell] = 0;
        } else if (mask.marked[cell] == 0 && IsFilled(previous, grid.Center(cell) + back)) {
          mask.marked[cell] = 1;
        }
      });
    }
  }
  return mask;
}

std::vector<SeaPointLabel> LabelSeaPoints(const InfluenceMask& mask,
                                          const std::vector<SeaPoint>& candidate_points,
                                          const FeatureMatches& matches,
                                          const std::vector<SeaPointLabel>& previous_labels,
                                          double radius) {
  std::vector<uint8_t> revived(mask.grid.Size(), 0);
  for (const FeatureMatch& match : matches) {
    if (!IsRea(previous_labels, match.idx1)) continue;
    const SeaPoint& point = candidate_points[match.idx2];
    ForEachCellAround(mask.grid, point.x, point.y, radius, [&](size_t cell) { revived[cell] = 1; });
  }
  std::vector<SeaPointLabel> labels;
  labels.reserve(candidate_points.size());
  for (const SeaPoint& point : candidate_points) {
    const size_t cell = mask.grid.IndexOf(point.x, point.y);
    labels.push_back(mask.marked[cell] ? SeaPointLabel::kOA
                     : revived[cell]   ? SeaPointLabel::kREA
                                       : SeaPointLabel::kNA);
  }
  return labels;
}

std::vector<SeaPointLabel> RelabelProcessed(const CellGrid& grid, const std::vector<float>& filled,
                                            const std::vector<SeaPoint>& points, double radius) {
  SEAPOINT_CHECK(filled.size() == grid.Size());
  std::vector<SeaPointLabel> labels;
  labels.reserve(points.size());
  for (const SeaPoint& point : points) {
    double sum = 0;
    int count = 0;
    ForEachCellAround(grid, point.x, point.y, radius, [&](size_t cell) {
      sum += filled[cell];
      ++count;
    });
    labels.push_back(sum >= kMinFilled * count ? SeaPointLabel::kPA : SeaPointLabel::kREA);
  }
  return labels;
}

}  // namespace colmap_seapoint
