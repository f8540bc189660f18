#include "colmap_seapoint/report/debug_figures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/report/debug_canvas.h"
#include "densify/densify_pair.h"
#include "densify/match/rectification.h"

namespace colmap_seapoint {
namespace {

using Pixels = std::vector<Eigen::Vector2d>;

const Rgb kBlue(60, 120, 255), kOrange(255, 150, 0), kRed(255, 40, 40), kGreen(60, 255, 60),
    kGray(230, 230, 230), kYellow(255, 230, 40), kCyan(60, 230, 255);

Pixels PixelsOf(const std::vector<SeaPoint>& points) {
  Pixels pixels;
  for (const SeaPoint& point : points) pixels.emplace_back(point.x, point.y);
  return pixels;
}

// The ends of the interpair matches in either picture; those of REA points stand apart.
struct Interpair {
  Pixels processed0, processed1, revived0, revived1;

  explicit Interpair(const PairDebug& pair) {
    for (const FeatureMatch& match : pair.interpair) {
      const bool is_revived = pair.previous_labels[match.idx1] == SeaPointLabel::kREA;
      const SeaPoint& a = (*pair.previous_points)[match.idx1];
      const SeaPoint& b = (*pair.points1)[match.idx2];
      (is_revived ? revived0 : processed0).emplace_back(a.x, a.y);
      (is_revived ? revived1 : processed1).emplace_back(b.x, b.y);
    }
  }
  Pixels All1() const {
    Pixels all = processed1;
    all.insert(all.end(), revived1.begin(), revived1.end());
    return all;
  }
};

// The samples of a disparity at their places in picture 1.
std::vector<PlacedDisparity> Place(const PairDebug& pair, const PartialDisparity& disparity) {
  std::vector<PlacedDisparity> placed;
  const auto geometry = MakePairGeometry(pair.view1.camera, pair.view1.cam_from_world,
                                         pair.view2.camera, pair.view2.cam_from_world);
  const SampleGrid& grid = disparity.grid;
  if (!geometry || disparity.disparity.empty()) return placed;
  const RectMap map(*geometry, false, grid.window, 1);
  for (int b = 0; b < grid.height; ++b) {
    for (int a = 0; a < grid.width; ++a) {
      const float value =
          disparity.disparity[static_cast<size_t>(b) * static_cast<size_t>(grid.width) +
                              static_cast<size_t>(a)];
      if (value <= 0 || grid.PixelX(a) >= grid.window.width ||
          grid.PixelY(b) >= grid.window.height) {
        continue;
      }
      const auto source = map.Source(grid.PixelX(a), grid.PixelY(b));
      if (source) placed.push_back({*source, value});
    }
  }
  return placed;
}

// The range of the disparities without the smallest and the largest fiftieth of them.
Eigen::Vector2f RangeOf(std::vector<PlacedDisparity> samples) {
  if (samples.empty()) return {0, 1};
  const auto less = [](const PlacedDisparity& a, const PlacedDisparity& b) {
    return a.disparity < b.disparity;
  };
  std::sort(samples.begin(), samples.end(), less);
  const size_t margin = samples.size() / 50;
  return {samples[margin].disparity, samples[samples.size() - 1 - margin].disparity};
}

Canvas BlackCanvas(const PairDebug& pair) {
  return Canvas(pair.view1.camera.width, pair.view1.camera.height);
}

double SizeOf(const PartialDisparity& disparity) { return disparity.grid.step; }

std::string Percent(double share) {
  return std::to_string(static_cast<int>(std::lround(100 * share))) + " percent";
}

std::string WithPercent(const std::string& name, double share) {
  char text[8];
  std::snprintf(text, sizeof(text), "_%03d", static_cast<int>(std::lround(100 * share)));
  return name + text;
}

}  // namespace

void DebugFigures::Write(const PairDebug& pair) {
  ++num_pairs_;
  if (num_pairs_ == 1) CheckWritableDir(folder_);
  const bool has_previous = pair.previous_picture != nullptr;
  if (has_previous) WriteInfluenceAreas(pair);
  WriteMasks(pair);
  WriteDisparities(pair);
  WriteOcclusions(pair);
  if (has_previous) WriteRevived(pair);
}

const std::string& DebugFigures::NameOf(int image_idx) const {
  return model_.images.at(static_cast<size_t>(image_idx)).name;
}

void DebugFigures::WriteFigure(const std::string& name, const Image<uint8_t>& figure) const {
  char number[32];
  std::snprintf(number, sizeof(number), "pair_%04d_", num_pairs_);
  WriteImage(folder_ / (number + name + ".png"), figure);
}

void DebugFigures::WriteInfluenceAreas(const PairDebug& pair) const {
  const Interpair ends(pair);
  Canvas left(*pair.previous_picture, 0.8), right(*pair.picture1, 0.8);
  left.Circles(ends.processed0, pair.influence_radius0, kBlue);
  left.Circles(ends.revived0, pair.influence_radius0, kOrange);
  right.Circles(ends.processed1, pair.influence_radius1, kBlue);
  right.Circles(ends.revived1, pair.influence_radius1, kOrange);
  const std::string counts = std::to_string(pair.interpair.size()) + " interpair SeaPoints";
  WriteFigure("fig10_influence_areas",
              SideBySide(left.WithTitle("V: " + NameOf(pair.previous_image_idx) + ". " + counts +
                                        "; orange: REA"),
                         right.WithTitle("V + 2: " + NameOf(pair.report.image_idx1))));
}

void DebugFigures::WriteMasks(const PairDebug& pair) const {
  const Rgb white(255, 255, 255);
  if (pair.mask.grid.Size() > 0) {
    const double rate = pair.mask.OverlapRate();
    Canvas canvas = BlackCanvas(pair);
    canvas.Tint(CellMask(canvas.Frame(), pair.mask.grid, pair.mask.marked), white, 1);
    WriteFigure(WithPercent("fig11_mask_overlap", rate),
                canvas.WithTitle("mask on V + 2 (" + NameOf(pair.report.image_idx1) +
                                 "): overlap rate " + Percent(rate)));
  }
  if (pair.known.covered_range.empty()) return;
  std::vector<uint8_t> covered;
  for (const float range : pair.known.covered_range) covered.push_back(range > 0 ? 1 : 0);
  const double rate = pair.report.overlap;
  Canvas canvas = BlackCanvas(pair);
  canvas.Tint(CellMask(canvas.Frame(), pair.known.grid, covered), white, 1);
  WriteFigure(WithPercent("fig11_reconstructed", rate),
              canvas.WithTitle(NameOf(pair.report.image_idx1) +
                               ": reconstructed before, by any pair: " + Percent(rate)));
}

void DebugFigures::WriteDisparities(const PairDebug& pair) {
  const auto partial = Place(pair, pair.partial->partial);
  const auto normal = Place(pair, pair.normal->partial);
  const Eigen::Vector2f range = RangeOf(normal.empty() ? partial : normal);
  Canvas right = BlackCanvas(pair);
  right.Disparities(normal, SizeOf(pair.normal->partial), kRed, range);
  right.Disparities(partial, SizeOf(pair.partial->partial), kGreen, range);
  const Image<uint8_t> figure =
      right.WithTitle(NameOf(pair.report.image_idx1) + ", " + NameOf(pair.report.image_idx2) +
                      ": " + std::to_string(partial.size()) + " samples (green); " +
                      std::to_string(normal.size()) + " by normal propagation (red and green)");
  const bool has_previous = pair.report.pass == "sequence" && !previous_disparity_.Empty();
  WriteFigure("fig13_disparity", has_previous ? SideBySide(previous_disparity_, figure) : figure);

  Canvas previous = BlackCanvas(pair);
  previous.Disparities(partial, SizeOf(pair.partial->partial), kGray, range);
  previous.Dots(PixelsOf(*pair.points1), kBlue);
  previous_disparity_ = previous.WithTitle("the pair before: its partial disparity and SeaPoints");
}

void DebugFigures::WriteOcclusions(const PairDebug& pair) const {
  const auto partial = Place(pair, pair.partial->partial);
  Canvas left(*pair.picture1, 0.3);
  left.Disparities(partial, SizeOf(pair.partial->partial), kGray, RangeOf(partial));
  left.Circles(pair.failed_seeds, 0.5 * pair.influence_radius1, kRed);
  left.Dots(pair.failed_seeds, kRed);
  const Image<uint8_t> figure =
      left.WithTitle("intrapair: " + std::to_string(pair.failed_seeds.size()) +
                     " seeds without disparity around them (red)");
  if (pair.previous_picture == nullptr) return WriteFigure("fig15_occlusions", figure);

  const Interpair ends(pair);
  Canvas right(*pair.picture1, 0.8);
  const cv::Mat unmatched = HullMask(right.Frame(), ends.All1()) &
                            ~DiscMask(right.Frame(), ends.All1(), pair.influence_radius1);
  right.Circles(ends.All1(), pair.influence_radius1, kBlue);
  right.Tint(unmatched, kRed, 0.35);
  right.Outline(unmatched, kRed);
  const std::string title = "interpair: inside the overlap without matched SeaPoints (red)";
  WriteFigure("fig15_occlusions", SideBySide(figure, right.WithTitle(title)));
}

void DebugFigures::WriteRevived(const PairDebug& pair) const {
  const auto partial = Place(pair, pair.partial->partial);
  const Interpair ends(pair);
  Canvas left = BlackCanvas(pair);
  // The densifier's mask is made of cells, so that a rim of their size is not hidden by the
  // overlap.
  const double radius = std::max(0.0, pair.influence_radius1 - pair.known.grid.cell);
  const CanvasFrame& frame = left.Frame();
  const cv::Mat overlap = HullMask(frame, ends.All1()) | DiscMask(frame, ends.All1(), radius);
  const cv::Mat around_revived =
      DiscMask(frame, ends.revived1, pair.influence_radius1 + pair.known.grid.cell);
  std::vector<PlacedDisparity> outside, revived, uncovered;
  for (const PlacedDisparity& sample : partial) {
    if (!Holds(frame, overlap, sample.pixel)) {
      outside.push_back(sample);
    } else {
      (Holds(frame, around_revived, sample.pixel) ? revived : uncovered).push_back(sample);
    }
  }
  const Eigen::Vector2f range = RangeOf(partial);
  const double size = SizeOf(pair.partial->partial);
  left.Disparities(outside, size, kGray, range);
  Canvas right = BlackCanvas(pair);
  right.Disparities(outside, size, kGray, range);
  right.Disparities(revived, size, kYellow, range);
  right.Disparities(uncovered, size, kCyan, range);
  const std::string title =
      "with what the overlap hid: near REA SeaPoints (yellow), unmatched (cyan)";
  WriteFigure("fig17_occlusions_handled",
              SideBySide(left.WithTitle("without all of the overlap"), right.WithTitle(title)));
}

}  // namespace colmap_seapoint
