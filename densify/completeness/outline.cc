#include "densify/completeness/outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "densify/completeness/judge_ground.h"

namespace colmap_seapoint {
namespace {

constexpr int kMinBlock = 4;             // cells
constexpr double kBlocksARadius = 48;    // the disc is drawn that finely
constexpr double kNotch = 0.2;           // of the radius: narrower is no bay of the outline
constexpr int64_t kMaxBlocks = 1 << 24;  // of the box around all; larger boxes get larger blocks

struct CellBox {
  int x0 = std::numeric_limits<int>::max(), y0 = x0;
  int x1 = std::numeric_limits<int>::min(), y1 = x1;
  void Take(int x, int y) {
    x0 = std::min(x0, x);
    y0 = std::min(y0, y);
    x1 = std::max(x1, x);
    y1 = std::max(y1, y);
  }
  bool IsEmpty() const { return x0 > x1; }
};

// kBay: open to the outside, and yet within the outline.
enum BlockPlace : uint8_t { kOutside = 0, kBay = 1, kInside = 255 };

// Squares of `size` cells; block (0, 0) begins at cell (x0, y0).
struct Blocks {
  int x0 = 0, y0 = 0, size = 1;
  cv::Mat inside;  // 8 bit, BlockPlace

  uint8_t PlaceOf(int x, int y) const {
    const int a = (x - x0) / size, b = (y - y0) / size;
    const bool is_known = a >= 0 && b >= 0 && a < inside.cols && b < inside.rows;
    return is_known ? inside.at<uint8_t>(b, a) : uint8_t{kOutside};
  }
};

// Calls visit(x, y) for all that is expected but for what is covered from so far away that it is
// background: nobody meant to measure between patches of that. Of covered cells distances are known
// of a sample.
template <typename Visitor>
void ForEachMeant(double max_gsd, TiledGrid<GroundCell>* cells, const Visitor& visit) {
  cells->ForEach([&](int x, int y, const GroundCell& cell) {
    if (!cell.is_expected) return;
    const GroundCell* sample = cells->Find(SampledCellOf(x), SampledCellOf(y));
    const float gsd = cell.gsd > 0 || sample == nullptr ? cell.gsd : sample->gsd;
    if (gsd <= max_gsd) visit(x, y);
  });
}

CellBox MeantBox(double max_gsd, TiledGrid<GroundCell>* cells) {
  CellBox box;
  ForEachMeant(max_gsd, cells, [&](int x, int y) { box.Take(x, y); });
  return box;
}

// Blocks of which half was meant, with a margin all round.
Blocks MeantBlocks(const CellBox& box, double radius_cells, double max_gsd,
                   TiledGrid<GroundCell>* cells) {
  Blocks blocks;
  blocks.size = std::max(kMinBlock, static_cast<int>(radius_cells / kBlocksARadius));
  const auto num_blocks = [&] {
    return (int64_t{box.x1} - box.x0) / blocks.size * ((int64_t{box.y1} - box.y0) / blocks.size);
  };
  while (num_blocks() > kMaxBlocks) blocks.size *= 2;
  const int margin = static_cast<int>(radius_cells / blocks.size) + 2;
  blocks.x0 = box.x0 - margin * blocks.size;
  blocks.y0 = box.y0 - margin * blocks.size;
  cv::Mat count((box.y1 - blocks.y0) / blocks.size + margin + 1,
                (box.x1 - blocks.x0) / blocks.size + margin + 1, CV_32S, cv::Scalar(0));
  ForEachMeant(max_gsd, cells, [&](int x, int y) {
    ++count.at<int>((y - blocks.y0) / blocks.size, (x - blocks.x0) / blocks.size);
  });
  blocks.inside = count * 2 >= blocks.size * blocks.size;
  return blocks;
}

// What no way from outside leads to, be it as narrow as it may.
cv::Mat Holes(const cv::Mat& inside) {
  cv::Mat outside = ~inside;  // with a margin all round: all that is outside hangs together there
  cv::floodFill(outside, cv::Point(0, 0), 0, nullptr, 0, 0, 4);
  return outside;
}

void Close(double radius_blocks, cv::Mat* inside) {
  const cv::Mat holes = Holes(*inside);
  cv::Mat distance;
  cv::distanceTransform(~*inside, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  cv::Mat grown = distance <= radius_blocks;
  cv::distanceTransform(grown, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  cv::Mat added = (distance > radius_blocks) & ~*inside;
  // Between the corners of pictures lie notches that are no holes.
  const int notch = 2 * static_cast<int>(kNotch * radius_blocks / 2) + 1;
  cv::morphologyEx(added, added, cv::MORPH_OPEN,
                   cv::getStructuringElement(cv::MORPH_RECT, cv::Size(notch, notch)));
  const cv::Mat bays = added & ~holes;
  added |= holes;
  // The outermost blocks are expected in part: beyond is no hole.
  *inside |= added;
  cv::erode(*inside, *inside, cv::Mat(), cv::Point(-1, -1), 1, cv::BORDER_CONSTANT, 0);
  *inside |= added;
  inside->setTo(cv::Scalar(kBay), bays);
}

Blocks AskedBlocks(const Ground& ground, const AskedArea& asked) {
  CellBox box;
  for (const Ring& ring : asked.rings) {
    for (const Eigen::Vector2d& p : ring) box.Take(ground.CellOf(p.x()), ground.CellOf(p.y()));
  }
  Blocks blocks;
  const auto num_blocks = [&] {
    return ((int64_t{box.x1} - box.x0) / blocks.size + 1) *
           ((int64_t{box.y1} - box.y0) / blocks.size + 1);
  };
  while (num_blocks() > kMaxBlocks) blocks.size *= 2;
  blocks.x0 = box.x0;
  blocks.y0 = box.y0;
  blocks.inside = cv::Mat((box.y1 - box.y0) / blocks.size + 1, (box.x1 - box.x0) / blocks.size + 1,
                          CV_8U, cv::Scalar(0));
  for (int b = 0; b < blocks.inside.rows; ++b) {
    for (int a = 0; a < blocks.inside.cols; ++a) {
      const Eigen::Vector2d middle((blocks.x0 + (a + 0.5) * blocks.size) * ground.cell_side,
                                   (blocks.y0 + (b + 0.5) * blocks.size) * ground.cell_side);
      if (asked.Contains(middle)) blocks.inside.at<uint8_t>(b, a) = 255;
    }
  }
  return blocks;
}

// So that every block inside has its cells.
void MakeTiles(const Blocks& blocks, TiledGrid<GroundCell>* cells) {
  for (int b = 0; b < blocks.inside.rows; ++b) {
    for (int a = 0; a < blocks.inside.cols; ++a) {
      if (blocks.inside.at<uint8_t>(b, a) == 0) continue;
      const int x = blocks.x0 + a * blocks.size, y = blocks.y0 + b * blocks.size;
      for (int ty = y >> 5; ty <= (y + blocks.size - 1) >> 5; ++ty) {
        for (int tx = x >> 5; tx <= (x + blocks.size - 1) >> 5; ++tx) cells->TileAt({tx, ty});
      }
    }
  }
}

}  // namespace

void JudgeUnseen(const OutlineLimits& limits, const AskedArea* asked, const LostSight& lost,
                 Ground* ground) {
  GroundLayer& top = ground->LayerAt({Side::kTop, 0});
  const CellBox box = MeantBox(limits.max_gsd, &top.cells);
  if (asked == nullptr && box.IsEmpty()) return;
  const double radius_cells = limits.radius / ground->cell_side;
  Blocks blocks;
  if (asked != nullptr) {
    blocks = AskedBlocks(*ground, *asked);
  } else {
    blocks = MeantBlocks(box, radius_cells, limits.max_gsd, &top.cells);
    Close(radius_cells / blocks.size, &blocks.inside);
  }
  MakeTiles(blocks, &top.cells);
  top.cells.ForEach([&](int x, int y, GroundCell& cell) {
    if (cell.is_expected || cell.cause == GapCause::kOutOfArea) return;
    const uint8_t at = blocks.PlaceOf(x, y);
    const bool is_background = cell.cause != GapCause::kNone;
    if (at == kOutside || (at == kBay && is_background)) return;
    const Eigen::Vector2d middle((x + 0.5) * ground->cell_side, (y + 0.5) * ground->cell_side);
    if (asked != nullptr && !asked->Contains(middle)) return;
    cell.is_expected = true;
    if (is_background) return;
    PredictCell(*ground, top, x, y, &cell);
    const bool is_lost = lost.RunThatSaw(ground->PlaceOf(top, x, y, cell.height)) >= 0;
    cell.cause = is_lost ? GapCause::kPoseLost : GapCause::kNeverImaged;
  });
}

}  // namespace colmap_seapoint
