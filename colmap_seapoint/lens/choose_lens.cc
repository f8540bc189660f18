#include "colmap_seapoint/lens/choose_lens.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <optional>
#include <utility>

#include "colmap_seapoint/adjustment/bundle_adjustment.h"
#include "colmap_seapoint/lens/compact_part.h"
#include "colmap_seapoint/lens/ground_bend.h"
#include "colmap_seapoint/lens/held_out_tracks.h"

namespace colmap_seapoint {
namespace {

// A difference of the costs is believed from so many standard errors on.
constexpr double kNoise = 2;
constexpr double kLossSigmas = 3;
constexpr double kMinSigma = 0.05;  // pixels
constexpr int kMaxIterations = 15, kMaxFirstIterations = 8;
// Observations of an adjustment, so that the choice costs seconds at most; small models are judged
// by more of their tracks, since one in 20 would be a handful.
constexpr size_t kFittedObservations = 12000, kHeldOutObservations = 12000;
constexpr size_t kMaxPictures = 60;  // compact_part.h
constexpr size_t kManyTracks = 20000;
constexpr size_t kEveryOfFew = 4, kEveryOfMany = 20;

// A form, the cameras and poses as a part of the tracks has them with it, and what those kept out
// say of that.
struct JudgedForm {
  LensForm form;
  SparseModel adjusted;
  std::vector<double> costs;  // of each track that was kept out
  double held_out_error = 0;  // root of their mean squared error as far as it counts, pixels
};

// Everything that the adjustments of one choice have in common.
struct Judging {
  const LensChoiceOptions& options;
  SplitTracks tracks;  // adjusted once, so that all begin near the minimum
  double sigma = 0;    // of the observations, pixels
};

BundleAdjustmentOptions AdjustmentOf(const LensChoiceOptions& options, const LensForm& form,
                                     const SparseModel& model) {
  BundleAdjustmentOptions adjustment;
  adjustment.num_threads = options.num_threads;
  adjustment.lenses = FreedomOfLenses(form, model, options.prior_focals);
  return adjustment;
}

// Mean squared error an observation, as far as it counts.
double HeldOutError(const Judging& judging, const std::vector<double>& costs) {
  size_t num_observations = 0;
  for (const auto& [id, point] : judging.tracks.held_out.points3D) {
    num_observations += point.track.size();
  }
  const double sum = std::accumulate(costs.begin(), costs.end(), 0.0);
  const double scale = kLossSigmas * judging.sigma;
  return scale * std::sqrt(2 * sum / static_cast<double>(std::max<size_t>(1, num_observations)));
}

std::optional<JudgedForm> Judge(const Judging& judging, const LensForm& form) {
  const RobustLoss loss = {LossKind::kGemanMcClure, kLossSigmas * judging.sigma};
  BundleAdjustmentOptions adjustment = AdjustmentOf(judging.options, form, judging.tracks.fitted);
  adjustment.loss = loss;
  adjustment.last_loss.reset();
  adjustment.max_num_iterations = kMaxIterations;
  auto adjusted = AdjustBundle(adjustment, InForm(form, judging.tracks.fitted));
  if (!adjusted) return std::nullopt;
  JudgedForm judged = {form, *std::move(adjusted), {}};
  judged.costs =
      HeldOutCosts(judging.tracks.held_out, judged.adjusted, loss, judging.options.num_threads);
  judged.held_out_error = HeldOutError(judging, judged.costs);
  return judged;
}

// Whether the tracks do not tell that `better` is: the sum of the differences against its standard
// error, tracks being independent.
bool IsWithinNoise(const JudgedForm& form, const JudgedForm& better) {
  double sum = 0, squares = 0;
  for (size_t k = 0; k < form.costs.size(); ++k) {
    const double difference = form.costs[k] - better.costs[k];
    sum += difference;
    squares += difference * difference;
  }
  return sum <= kNoise * std::sqrt(squares);
}

double TotalCost(const JudgedForm& form) {
  return std::accumulate(form.costs.begin(), form.costs.end(), 0.0);
}

// The simplest of those within noise of the best; `forms` are not empty.
const JudgedForm& Simplest(const std::vector<JudgedForm>& forms) {
  const auto best = std::min_element(
      forms.begin(), forms.end(),
      [](const JudgedForm& a, const JudgedForm& b) { return TotalCost(a) < TotalCost(b); });
  const JudgedForm* simplest = &*best;
  for (const JudgedForm& form : forms) {
    if (NumFreeParams(form.form) < NumFreeParams(simplest->form) && IsWithinNoise(form, *best)) {
      simplest = &form;
    }
  }
  return *simplest;
}

std::vector<std::vector<LensForm>> StepsOf(const LensChoiceOptions& options,
                                           const SparseModel& model) {
  const auto is_default = [](const auto& camera) {
    return camera.second.model == CameraModel::kOpenCV;
  };
  if (std::all_of(model.cameras.begin(), model.cameras.end(), is_default)) {
    return LensFormSteps(options.principal_point);
  }
  LensForm form = {model.cameras.begin()->second.model};
  form.principal_point = options.principal_point;
  return {{form}};
}

// What may be said against a form: that its camera has two focal lengths, and that its principal
// point is not known better than that it lies in the middle.
std::vector<LensForm> Variants(const LensForm& form) {
  std::vector<LensForm> variants;
  const LensForm two = WithTwoFocals(form);
  if (two.has_two_focals && !form.has_two_focals) variants.push_back(two);
  if (form.principal_point == PrincipalPoint::kFree) {
    variants.push_back(form);
    variants.back().principal_point = PrincipalPoint::kCentred;
  }
  return variants;
}

Judging Prepare(const LensChoiceOptions& options, const SparseModel& model) {
  TrackSplit split;
  split.held_out_every = model.points3D.size() < kManyTracks ? kEveryOfFew : kEveryOfMany;
  split.max_fitted_observations = kFittedObservations;
  split.max_held_out_observations = kHeldOutObservations;
  Judging judging = {options, Split(split, CompactPart(model, kMaxPictures))};
  LensForm as_it_is;
  as_it_is.principal_point = options.principal_point;
  const SparseModel& start = judging.tracks.fitted;
  BundleAdjustmentOptions adjustment = AdjustmentOf(options, as_it_is, start);
  adjustment.max_num_iterations = kMaxFirstIterations;
  auto adjusted = AdjustBundleInFull(adjustment, start);
  if (!adjusted) return judging;
  judging.sigma = std::max(adjusted->error_sigma, kMinSigma);
  judging.tracks.fitted = std::move(adjusted->model);
  return judging;
}

std::string Said(const std::vector<JudgedForm>& forms, const JudgedForm& chosen,
                 size_t num_tracks) {
  char number[64];
  std::snprintf(number, sizeof(number), "%.4f px on %zu tracks kept out", chosen.held_out_error,
                num_tracks);
  std::string text = Describe(chosen.form) + ": " + number + " (";
  for (const JudgedForm& form : forms) {
    if (form.form.model == chosen.form.model && Describe(form.form) == Describe(chosen.form)) {
      continue;
    }
    std::snprintf(number, sizeof(number), " %.4f", form.held_out_error);
    text += (text.back() == '(' ? "" : "; ") + Describe(form.form) + number;
  }
  return text + ")";
}

}  // namespace

LensChoice ChooseLens(const LensChoiceOptions& options, const SparseModel& model) {
  const std::vector<std::vector<LensForm>> steps = StepsOf(options, model);
  LensChoice choice;
  choice.form = steps.front().front();
  const Judging judging = Prepare(options, model);
  std::vector<JudgedForm> judged;
  const auto judge_all = [&](const std::vector<LensForm>& forms) {
    for (const LensForm& form : forms) {
      if (auto one = Judge(judging, form)) judged.push_back(*std::move(one));
    }
  };
  for (const std::vector<LensForm>& forms : steps) {
    if (!(judging.sigma > 0)) break;
    const size_t num_before = judged.size();
    judge_all(forms);
    const bool is_proven = judged.empty() || &Simplest(judged) >= judged.data() + num_before;
    if (!is_proven) break;
  }
  if (judged.empty()) {
    choice.said = Describe(choice.form) + " (too few tracks to judge lenses by)";
    return choice;
  }
  judge_all(Variants(Simplest(judged).form));
  const JudgedForm& chosen = Simplest(judged);
  choice.form = chosen.form;
  choice.said = Said(judged, chosen, chosen.costs.size());
  if (const auto frame = FindGroundFrame(chosen.adjusted)) {
    for (const JudgedForm& other : judged) {
      if (!IsWithinNoise(other, chosen)) continue;
      const double bend = CurvatureBetween(chosen.adjusted, other.adjusted, *frame);
      choice.bend = std::max(choice.bend, std::abs(bend));
    }
  }
  return choice;
}

}  // namespace colmap_seapoint
