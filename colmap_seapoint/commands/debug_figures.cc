#include "colmap_seapoint/commands/debug_figures.h"

#include <cmath>
#include <cstdio>
#include <utility>

#include "colmap_seapoint/io/image_file.h"

namespace colmap_seapoint {
namespace {

using Pixels = std::vector<Eigen::Vector2d>;

const Rgb kBlue(60, 120, 255), kOrange(255, 150, 0), kRed(255, 40, 40);

// Ends of the interpair matches in either picture, those of REA points apart.
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

Canvas BlackCanvas(const PairDebug& pair) {
  return Canvas(pair.view1.camera.width, pair.view1.camera.height);
}

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
  std::filesystem::create_directories(folder_);
  const bool has_previous = pair.previous_color != nullptr;
  if (has_previous) WriteInfluenceAreas(pair);
  WriteMasks(pair);
  if (has_previous) WriteOcclusions(pair);
}

const std::string& DebugFigures::NameOf(int image_idx) const {
  return model_.images.at(static_cast<size_t>(image_idx)).name;
}

void DebugFigures::WriteFigure(const std::string& name, const Canvas& canvas) const {
  char number[32];
  std::snprintf(number, sizeof(number), "pair_%04d_", num_pairs_);
  WriteImage(folder_ / (number + name + ".png"), canvas.ToImage());
}

void DebugFigures::WriteInfluenceAreas(const PairDebug& pair) const {
  const Interpair ends(pair);
  Canvas left(*pair.previous_color, 0.8), right(*pair.color1, 0.8);
  left.Circles(ends.processed0, pair.influence_radius0, kBlue);
  left.Circles(ends.revived0, pair.influence_radius0, kOrange);
  right.Circles(ends.processed1, pair.influence_radius1, kBlue);
  right.Circles(ends.revived1, pair.influence_radius1, kOrange);
  left.Title("V: " + NameOf(pair.previous_image_idx) + ". " +
             std::to_string(pair.interpair.size()) + " interpair SeaPoints; orange: REA");
  right.Title("V + 2: " + NameOf(pair.report.image_idx1));
  WriteFigure("fig10_influence_areas", left.Beside(right));
}

void DebugFigures::WriteMasks(const PairDebug& pair) const {
  const Rgb white(255, 255, 255);
  if (pair.mask.grid.Size() > 0) {
    const double rate = pair.mask.OverlapRate();
    Canvas canvas = BlackCanvas(pair);
    canvas.Tint(canvas.Cells(pair.mask.grid, pair.mask.marked), white, 1);
    canvas.Title("mask on V + 2 (" + NameOf(pair.report.image_idx1) + "): overlap rate " +
                 Percent(rate));
    WriteFigure(WithPercent("fig11_mask_overlap", rate), canvas);
  }
  if (pair.covered_range.empty()) return;
  std::vector<uint8_t> covered;
  for (const float range : pair.covered_range) covered.push_back(range > 0 ? 1 : 0);
  const double rate = pair.report.overlap;
  Canvas canvas = BlackCanvas(pair);
  canvas.Tint(canvas.Cells(pair.cells, covered), white, 1);
  canvas.Title(NameOf(pair.report.image_idx1) +
               ": reconstructed before, by any pair: " + Percent(rate));
  WriteFigure(WithPercent("fig11_reconstructed", rate), canvas);
}

void DebugFigures::WriteOcclusions(const PairDebug& pair) const {
  const Interpair ends(pair);
  Canvas right(*pair.color1, 0.8);
  const cv::Mat unmatched =
      right.Hull(ends.All1()) & ~right.Discs(ends.All1(), pair.influence_radius1);
  right.Circles(ends.All1(), pair.influence_radius1, kBlue);
  right.Tint(unmatched, kRed, 0.35);
  right.Outline(unmatched, kRed);
  right.Title("interpair: inside the overlap without matched SeaPoints (red)");
  WriteFigure("fig15_occlusions", right);
}

}  // namespace colmap_seapoint
