#include "densify/completeness/self_check/check_by_hiding.h"

#include <cmath>

#include "densify/completeness/self_check/hidden_pictures.h"

namespace colmap_seapoint {
namespace {

struct Areas {
  double beyond = 0;    // covered before, and now beyond the outline of what is left
  double lost = 0;      // of the rest: covered before, and no longer
  double found = 0;     // of it: said to be missing
  double said = 0;      // said to be missing, and was not before
  double not_lost = 0;  // of it: no part of the survey, as all pictures together tell

  void Add(const Areas& other) {
    beyond += other.beyond;
    lost += other.lost;
    found += other.found;
    said += other.said;
    not_lost += other.not_lost;
  }
};

bool IsMissing(const GroundCell& cell) { return cell.is_expected && !cell.is_covered; }

Areas CompareLayer(const GroundLayer& all, const GroundLayer* rest) {
  Areas areas;
  all.cells.ForEach([&](int x, int y, const GroundCell& cell) {
    if (!cell.is_expected || !cell.is_covered) return;
    const GroundCell* left = rest == nullptr ? nullptr : rest->cells.Find(x, y);
    if (left != nullptr && left->is_covered) return;
    // No picture that is left shows it, nor is it among those that do.
    const bool is_beyond =
        left == nullptr || (!left->is_expected && left->cause == GapCause::kNone);
    (is_beyond ? areas.beyond : areas.lost) += cell.area;
    if (left != nullptr && IsMissing(*left)) areas.found += cell.area;
  });
  if (rest == nullptr) return areas;
  rest->cells.ForEach([&](int x, int y, const GroundCell& left) {
    if (!IsMissing(left)) return;
    const GroundCell* cell = all.cells.Find(x, y);
    if (cell != nullptr && IsMissing(*cell)) return;
    areas.said += left.area;
    if (cell == nullptr || !cell->is_expected) areas.not_lost += left.area;
  });
  return areas;
}

Areas CompareGrounds(const Ground& all, const Ground& rest) {
  Areas areas;
  for (const auto& [key, layer] : all.layers) {
    const auto place = rest.layers.find(key);
    areas.Add(CompareLayer(layer, place == rest.layers.end() ? nullptr : &place->second));
  }
  return areas;
}

Areas CheckFold(const CompletenessInput& input, const CompletenessOptions& options,
                const SurveySetting& setting, const Ground& ground, int fold, int num_threads) {
  const std::vector<bool> is_hidden = HiddenInFold(*input.model, fold);
  const SparseModel rest = WithoutHidden(*input.model, is_hidden);
  const JudgedSurvey judged = JudgeSurvey(InputWithoutHidden(input, rest, is_hidden), options,
                                          setting, MakeViews(rest, setting.max_range), num_threads);
  return CompareGrounds(ground, judged.ground);
}

}  // namespace

SelfCheck CheckByHiding(const CompletenessInput& input, const CompletenessOptions& options,
                        const SurveySetting& setting, const Ground& ground, int num_threads) {
  SelfCheck check;
  if (input.model->images.size() < kMinPicturesToHide) return check;
  Areas sum;
  double squares = 0;
  for (int fold = 0; fold < kNumFolds; ++fold) {
    const Areas areas = CheckFold(input, options, setting, ground, fold, num_threads);
    if (!(areas.lost > 0)) continue;
    const double error = areas.said / areas.lost - 1;
    squares += error * error;
    sum.Add(areas);
    ++check.num_folds;
  }
  if (check.num_folds == 0) return check;
  check.hidden_area = sum.lost + sum.beyond;
  check.beyond_share = sum.beyond / check.hidden_area;
  check.found_share = sum.found / sum.lost;
  check.false_share = sum.said > 0 ? sum.not_lost / sum.said : 0;
  check.area_error = std::sqrt(squares / check.num_folds);
  return check;
}

}  // namespace colmap_seapoint
