#include "densify/densify_sequence.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "densify/overlap/coverage.h"
#include "densify/run_pair.h"
#include "densify/sequence/best_view.h"
#include "densify/sequence/completion.h"
#include "densify/sequence/covisibility.h"
#include "densify/sequence/open_surface.h"
#include "densify/sequence/pair_selection.h"
#include "densify/sequence/partners.h"
#include "densify/sequence/picture_order.h"
#include "densify/sequence/triangulate_matches.h"
#include "densify/sequence_scope.h"

namespace colmap_seapoint {

namespace {

// Of a picture in the completion pass: partners that it may have, and that it gets.
constexpr size_t kMaxCandidates = 12;
constexpr int kMaxPartners = 3;

// Where a last round comes back for the rest, points must be surer than that at first, so that
// another pair may measure better what one is unsure of.
constexpr double kSureAtFirst = 0.6;

// What is covered is known only where all earlier views count.
bool Completes(const SequenceContext& context) {
  return context.options.completion && context.redundancy == Redundancy::kAll;
}

double FirstConfidence(const SequenceContext& context) {
  const double least = context.options.min_confidence;
  return Completes(context) ? std::max(least, kSureAtFirst) : least;
}

// Where influence areas put the overlap of a picture with the first one of the pair before (paper
// 2.5, Figures 10 and 11).
InfluenceMask MaskOn(const SequenceContext& context, const SequenceMemory& memory, int candidate) {
  return MakeInfluenceMask(context.Cells(candidate), context.SeaPoints(candidate)->points,
                           *context.Matches(memory.previous_first, candidate), memory.previous,
                           context.InfluenceRadius(candidate));
}

// What all pairs so far have covered of a picture (ours).
ViewCoverage CoverageOf(const SequenceContext& context, const SequenceMemory& memory,
                        int position) {
  const View view = context.track.ViewOf(position);
  return ProjectCoverage(memory.footprints, view.camera, view.cam_from_world,
                         context.Cells(position));
}

// Mask and labels against the pair before (paper 2.5, 2.7), or against all that is known (ours).
PairOverlap AssessOverlap(const SequenceContext& context, const SequenceMemory& memory, int first) {
  const auto seapoints = context.SeaPoints(first);
  const CellGrid cells = context.Cells(first);
  PairOverlap overlap = WithoutPrevious(cells, seapoints->points);
  if (memory.previous_first >= 0) {
    overlap = OverlapWithPrevious(MaskOn(context, memory, first), seapoints->points,
                                  *context.Matches(memory.previous_first, first), memory.previous,
                                  context.InfluenceRadius(first));
  }
  if (context.redundancy == Redundancy::kSequential) return overlap;
  return OverlapWithAll(std::move(overlap), CoverageOf(context, memory, first), seapoints->points);
}

// Paper 2.6: SeaPoints in the overlap area form no seeds. Against surface that is known (ours) the
// pair itself decides, since a new object may stand in front of it.
std::vector<SeaPointLabel> LabelsThatCount(const SequenceContext& context,
                                           const PairOverlap& overlap) {
  const bool by_label =
      context.mode == DensificationMode::kPartial && context.redundancy == Redundancy::kSequential;
  return by_label ? overlap.labels : std::vector<SeaPointLabel>();
}

// Paper 2.7: which SeaPoints of the pair's first picture are processed, and which ones the next
// pair shall try again. What was known before counts as filled, though not by this pair.
void Remember(const SequenceContext& context, const PairTask& task, std::vector<float> filled,
              SequenceMemory* memory) {
  const KnownCells& known = task.overlap.known;
  filled.resize(known.grid.Size(), 0.0f);
  for (size_t cell = 0; cell < filled.size(); ++cell) {
    if (!known.IsNew(cell)) filled[cell] = 1;
  }
  memory->previous_first = task.first;
  memory->previous.points = context.SeaPoints(task.first)->points;
  memory->previous.labels = RelabelProcessed(known.grid, filled, memory->previous.points,
                                             context.InfluenceRadius(task.first));
  memory->previous.grid = known.grid;
  memory->previous.filled = std::move(filled);
}

// The partners that a picture may have, best first.
std::vector<int> PartnersOf(const SequenceContext& context, int position) {
  std::vector<int> partners = BestPartners(context.track, context.covisibility, position);
  partners.resize(std::min(partners.size(), kMaxCandidates));
  return partners;
}

// What a picture may measure of each cell before better pairs have had their turn (ours).
std::vector<double> AdmissibleIn(const SequenceContext& context, int position,
                                 const std::vector<double>& predicted_range) {
  std::vector<View> others;
  for (const int partner : PartnersOf(context, position)) {
    others.push_back(context.track.ViewOf(partner));
  }
  return AdmissibleUncertainty(context.track.ViewOf(position), others, context.Cells(position),
                               predicted_range);
}

// Where a completion pass comes back for it, a place is left to the pair that measures it best.
void LeaveToBetterPairs(const SequenceContext& context, PairTask* task) {
  if (!Completes(context) || context.mode != DensificationMode::kPartial) return;
  const Track& track = context.track;
  KnownCells& known = task->overlap.known;
  const std::vector<double> ranges =
      PredictRanges(context.model, track.Image(task->first), track.ViewOf(task->first),
                    {known.grid, known.covered_range});
  LeaveToBetterPairs(track.ViewOf(task->first), track.ViewOf(task->second), ranges,
                     AdmissibleIn(context, task->first, ranges), &known);
}

// Overlap, labels, seeds, propagation, reprojection (paper 2.5 to 2.7). Whether the pair gave
// something.
bool DensifyNewAreas(const SequenceContext& context, int first, int second, SequenceMemory* memory,
                     SequenceReport* report) {
  // Decoded while this pair is densified: most often they are the next pair.
  for (const int ahead : {second + 1, second + 2}) {
    if (second > first && ahead < context.track.Length()) {
      context.pictures->Prefetch(context.track.ImageIdx(ahead));
    }
  }
  PairTask task{first,      second,
                "sequence", AssessOverlap(context, *memory, first),
                {},         FirstConfidence(context)};
  LeaveToBetterPairs(context, &task);
  task.seeds = FormSeeds(context, first, second, LabelsThatCount(context, task.overlap));
  PairOutcome pair = RunPair(context, task);
  Deliver(context, task, pair, memory, report);
  Remember(context, task, std::move(pair.result.filled), memory);
  return pair.result.failure.empty();
}

// Figure 3: pair by pair along the track.
void DensifyTrack(const SequenceContext& context, const std::function<void(int64_t)>& progress,
                  SequenceMemory* memory, SequenceReport* report) {
  const PartialDensificationOptions& options = context.options;
  const SecondRules rules{options.min_num_seeds, options.min_mean_motion};
  int first = 0;
  while (context.track.CanStartPair(first)) {
    const SecondChoice second =
        SelectSecond(context.model, context.track, first, rules, context.pictures);
    if (second.position >= 0) {
      DensifyNewAreas(context, first, second.position, memory, report);
      const NextChoice next = SelectNext(
          context.track, first, second.position, options.max_overlap,
          [&](int candidate) { return MaskOn(context, *memory, candidate).OverlapRate(); });
      for (const int skipped : next.passed_over) {
        report->pairs.push_back(
            SkippedRow(context, skipped, "overlaps too much with the pair before"));
      }
      first = next.position;
    } else {
      report->pairs.push_back(SkippedRow(context, first, second.why_none));
      ++first;
    }
    progress(first);
  }
}

// A picture before it is decided whether it starts a pair.
struct SequenceView {
  // What pairs have covered of it, and what the last one saw of it.
  ViewCoverage coverage;
  std::vector<double> predicted_range;  // PredictRanges
};

SequenceView LookAtNext(const SequenceContext& context, const SequenceMemory& memory,
                        const std::pair<int, int>& last_pair, int position) {
  const View view = context.track.ViewOf(position);
  SequenceView seen;
  seen.coverage = CoverageOf(context, memory, position);
  seen.predicted_range =
      PredictRanges(context.model, context.track.Image(position), view, seen.coverage);
  if (last_pair.first >= 0) {
    MarkSeenByBoth(view, seen.predicted_range, context.track.ViewOf(last_pair.first),
                   context.track.ViewOf(last_pair.second), &seen.coverage);
  }
  return seen;
}

// The picture that completes the pair of `first` best, for what is open in it.
SecondChoice SelectAmongAll(const SequenceContext& context, const SequenceView& seen, int first) {
  const Track& track = context.track;
  std::vector<int> partners = BestPartners(track, context.covisibility, first);
  partners.erase(std::remove_if(partners.begin(), partners.end(),
                                [&](int partner) { return partner >= track.Length(); }),
                 partners.end());
  return SelectBestSecond(
      track, first,
      RankForOpenSurface(track, track.ViewOf(first), seen.coverage, seen.predicted_range, partners),
      context.options.min_num_seeds, context.pictures);
}

// The same where a completion pass comes back for the rest (ours): whatever picture makes the best
// pair completes it, and coverage tells which pictures need none.
void DensifyByCoverage(const SequenceContext& context, const std::function<void(int64_t)>& progress,
                       SequenceMemory* memory, SequenceReport* report) {
  std::pair<int, int> last_pair(-1, -1);
  for (int first = 0; first < context.track.Length(); ++first) {
    if (!context.IsInScope(first)) continue;
    const SequenceView seen = LookAtNext(context, *memory, last_pair, first);
    const bool is_between = first <= last_pair.second && last_pair.second < context.track.Length();
    SecondChoice second{-1, "overlaps too much with the pairs before"};
    if (seen.coverage.CoveredShare() <= MaxCoveredShare(is_between, context.options.max_overlap)) {
      second = SelectAmongAll(context, seen, first);
    }
    if (second.position >= 0) {
      if (DensifyNewAreas(context, first, second.position, memory, report)) {
        last_pair = {first, second.position};
      }
    } else {
      report->pairs.push_back(SkippedRow(context, first, second.why_none));
    }
    progress(first + 1);
  }
}

std::vector<CompletionCandidate> CandidatesOf(const SequenceContext& context, int position,
                                              const SequenceMemory& memory) {
  std::vector<CompletionCandidate> candidates;
  for (const int partner : PartnersOf(context, position)) {
    if (memory.tried_pairs.count(std::minmax(position, partner)) > 0) continue;
    candidates.push_back({partner, context.track.ViewOf(partner)});
  }
  return candidates;
}

void Drop(int position, std::vector<CompletionCandidate>* candidates) {
  candidates->erase(
      std::find_if(candidates->begin(), candidates->end(),
                   [&](const auto& candidate) { return candidate.position == position; }));
}

// All matches and triangulated points of the pair are seeds, and the rim of what is covered.
PairTask TaskOf(const SequenceContext& context, int position, const CompletionTarget& target,
                const CompletionView& seen, double min_confidence) {
  PairTask task{position, target.partner, "completion", {}, {}, min_confidence};
  task.overlap.rate = seen.coverage.CoveredShare();
  task.overlap.known = {seen.coverage.grid, target.closed, {}, {}};
  task.seeds = FormSeeds(context, position, target.partner, {});
  const std::vector<PixelPair> rim =
      SeedsAlongRim(context.track.ViewOf(position), context.track.ViewOf(target.partner), seen);
  task.seeds.insert(task.seeds.end(), rim.begin(), rim.end());
  return task;
}

// Which of a picture's cells its pairs may measure.
enum class CompletionRound { kBestViews, kTheRest };

void CompletePicture(const SequenceContext& context, int position, CompletionRound round,
                     GivenUp* given_up, SequenceMemory* memory, SequenceReport* report) {
  const View view = context.track.ViewOf(position);
  std::vector<CompletionCandidate> candidates = CandidatesOf(context, position, *memory);
  CompletionView seen = LookAt(view, context.Cells(position), memory->footprints, *given_up);
  for (int tries = 0; tries < kMaxPartners && !candidates.empty(); ++tries) {
    seen.predicted_range =
        PredictRanges(context.model, context.track.Image(position), view, seen.coverage);
    if (round == CompletionRound::kBestViews) {
      seen.admissible = AdmissibleIn(context, position, seen.predicted_range);
    }
    const CompletionTarget target = SelectCompletionPartner(view, seen, candidates);
    if (target.partner < 0) return;
    Drop(target.partner, &candidates);
    const PairTask task =
        TaskOf(context, position, target, seen,
               round == CompletionRound::kBestViews ? FirstConfidence(context)
                                                    : context.options.min_confidence);
    const PairOutcome pair = RunPair(context, task);
    Deliver(context, task, pair, memory, report);
    if (pair.result.failure.empty()) {
      AddCoverage(memory->footprints.back(), view.camera, view.cam_from_world, &seen.coverage);
    }
    NoteFailures(view, target, pair.result.filled, &seen, given_up);
  }
}

// The completion pass (ours): picture by picture, each with up to three partners, what two pictures
// see, of whatever strip, and no pair has covered. First each place by the pair that measures it
// best, then what is left by whatever pair measures it.
void CompleteSequence(const SequenceContext& context, const std::function<void(int64_t)>& progress,
                      SequenceMemory* memory, SequenceReport* report) {
  const int num_pictures = context.track.NumPictures();
  int64_t done = 0;
  for (const auto round : {CompletionRound::kBestViews, CompletionRound::kTheRest}) {
    GivenUp given_up;
    for (int position = 0; position < num_pictures; ++position) {
      if (!context.IsInScope(position)) continue;
      CompletePicture(context, position, round, &given_up, memory, report);
      progress(++done);
    }
    memory->tried_pairs.clear();  // they were not tried on all that they see
  }
}

}  // namespace

bool CanBeDensifiedInParts(const PartialDensificationOptions& options) {
  return options.completion && options.AgainstWhat() == Redundancy::kAll &&
         options.Mode() == DensificationMode::kPartial && !options.write_maps &&
         !options.write_debug;
}

SequenceReport DensifySequence(const SparseModel& model, PictureSource* source,
                               const PartialDensificationOptions& options, int num_threads,
                               const SequenceCallbacks& callbacks, const StereoRig& rig) {
  return DensifyInScope(model, source, options, num_threads, callbacks, rig, {});
}

SequenceReport DensifyInScope(const SparseModel& given_model, PictureSource* source,
                              const PartialDensificationOptions& options, int num_threads,
                              const SequenceCallbacks& callbacks, const StereoRig& rig,
                              const SequenceScope& scope) {
  PictureCache pictures(source);
  SequenceReport report;
  std::optional<SparseModel> with_points;
  if (!HasSharedPoints(given_model)) {
    with_points = WithTriangulatedMatches(given_model, &pictures);
    report.num_triangulated =
        static_cast<int64_t>(with_points->points3D.size() - given_model.points3D.size());
  }
  const SparseModel& model = with_points ? *with_points : given_model;
  const Covisibility covisibility = MeasureCovisibility(model);
  const Track track(model, OrderPictures(model, covisibility), rig);
  const SequenceContext context{
      model,       covisibility, track,     options, options.Mode(), options.AgainstWhat(),
      num_threads, callbacks,    &pictures, scope};
  const int64_t num_pictures = track.NumPictures();
  const int64_t total = num_pictures * (Completes(context) ? 3 : 1);
  const auto progress = [&](int64_t done) {
    if (callbacks.progress) callbacks.progress(done, total);
  };
  SequenceMemory memory;
  memory.footprints = scope.earlier.footprints;
  if (Completes(context)) {
    DensifyByCoverage(context, progress, &memory, &report);
    CompleteSequence(
        context, [&](int64_t done) { progress(num_pictures + done); }, &memory, &report);
  } else {
    DensifyTrack(context, progress, &memory, &report);
  }
  report.left_out = pictures.LeftOut();
  return report;
}

}  // namespace colmap_seapoint
