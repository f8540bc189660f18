#include "densify/sequence/sequence_state.h"

#include <algorithm>
#include <cmath>

#include "colmap_seapoint/base/timer.h"
#include "densify/sequence/completion.h"
#include "densify/sequence/pair_debug.h"
#include "densify/sequence/pair_selection.h"

namespace colmap_seapoint {

namespace {

constexpr int kMaxSecondTries = 4;        // pictures tried as the second one of a pair
constexpr double kMinParallaxDeg = 1.0;   // ours: motion can be mere rotation
constexpr double kMaxParallaxDeg = 30.0;  // a wider pair is not preferred: it sees two surfaces
constexpr double kMinSharedShare = 0.6;   // of the first picture, in the preferred second one

std::pair<int, int> Ordered(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

}  // namespace

SequenceState::SequenceState(const SparseModel& model, std::vector<int> order, const StereoRig& rig,
                             PictureSource* source, const PartialDensificationOptions& options,
                             int num_threads, const SequenceCallbacks& callbacks)
    : model_(model),
      order_(std::move(order)),
      options_(options),
      num_threads_(num_threads),
      callbacks_(callbacks),
      cache_(source),
      covisible_(CovisiblePictures(model, order_)) {
  std::vector<int> position_of(order_.size());
  for (int position = 0; position < NumPictures(); ++position) {
    position_of[static_cast<size_t>(ImageIdxAt(position))] = position;
  }
  for (const int image_idx : order_) {
    const int right = rig.right_of.empty() ? -1 : rig.right_of[static_cast<size_t>(image_idx)];
    right_of_.push_back(right < 0 ? -1 : position_of[static_cast<size_t>(right)]);
    num_track_ += rig.is_right.empty() || rig.is_right[static_cast<size_t>(image_idx)] == 0;
  }
}

bool SequenceState::CanStartPair(int first) const {
  return first + 1 < num_track_ || (first < num_track_ && RightOf(first) >= 0);
}

const PosedImage& SequenceState::ImageAt(int position) const {
  return model_.images[static_cast<size_t>(ImageIdxAt(position))];
}

View SequenceState::ViewAt(int position) const {
  const PosedImage& image = ImageAt(position);
  return {ImageIdxAt(position), model_.cameras.at(image.camera_id), image.cam_from_world};
}

double SequenceState::LongerSide(int position) const {
  const Camera& camera = model_.cameras.at(ImageAt(position).camera_id);
  return std::max(camera.width, camera.height);
}

CellGrid SequenceState::CellsAt(int position) const {
  return CellsOf(model_.cameras.at(ImageAt(position).camera_id), options_);
}

std::shared_ptr<const Features> SequenceState::SeaPointsAt(int position) {
  return cache_.GetSeaPoints(ImageIdxAt(position));
}

std::shared_ptr<const FeatureMatches> SequenceState::MatchesOf(int position1, int position2) {
  return cache_.GetMatches(ImageIdxAt(position1), ImageIdxAt(position2));
}

// The paper asks for a good baseline (2.6): the picture after the next one gives a better one, but
// sees less; ours: that is worth it where the completion pass comes back for what it does not see.
std::vector<SequenceState::SecondCandidate> SequenceState::SecondCandidates(int first) const {
  std::vector<SecondCandidate> candidates;
  const int end = std::min(num_track_, first + 1 + kMaxSecondTries);
  for (int second = first + 1; second < end; ++second) {
    candidates.push_back({second, MedianParallaxDeg(model_, ImageAt(first), ImageAt(second))});
  }
  if (!options_.completion || options_.redundancy != "all") return candidates;
  const auto wide = std::stable_partition(
      candidates.begin(), candidates.end(), [&](const SecondCandidate& candidate) {
        return candidate.parallax_deg <= kMaxParallaxDeg &&
               SharedShare(model_, ImageAt(first), ViewAt(candidate.position)) >= kMinSharedShare;
      });
  std::stable_sort(candidates.begin(), wide,
                   [](const auto& a, const auto& b) { return a.parallax_deg > b.parallax_deg; });
  return candidates;
}

int SequenceState::SelectSecond(int first) {
  PairReport report = NewReport(first, -1, "sequence");
  const int right = RightOf(first);
  if (right >= 0) cache_.Prefetch(ImageIdxAt(right));
  if (!cache_.Get(ImageIdxAt(first))) {
    report.skipped = "the picture cannot be read";
    report_.pairs.push_back(report);
    return NumPictures();
  }
  if (right >= 0 && cache_.Get(ImageIdxAt(right))) return right;
  report.skipped = "no following picture matches it";
  for (const auto& [second, parallax] : SecondCandidates(first)) {
    if (!cache_.Get(ImageIdxAt(second))) continue;
    const auto matches = MatchesOf(first, second);
    if (static_cast<int>(matches->size()) < options_.min_num_seeds) continue;
    const double motion = MeanMotion(SeaPointsAt(first)->points, SeaPointsAt(second)->points,
                                     *matches, LongerSide(first));
    if (motion >= options_.min_mean_motion && parallax >= kMinParallaxDeg) return second;
    report.skipped = "the viewpoint hardly changes in the pictures that follow";
  }
  report_.pairs.push_back(report);
  return NumPictures();
}

double SequenceState::InterpairOverlap(int first, int candidate) {
  const auto points = SeaPointsAt(candidate);
  const auto matches = MatchesOf(first, candidate);
  const double radius = options_.influence_radius * LongerSide(candidate);
  return MakeInfluenceMask(CellsAt(candidate), points->points, *matches, previous_, radius)
      .OverlapRate();
}

int SequenceState::SelectNextFirst(int first, int second) {
  const auto overlap = [&](int candidate) { return InterpairOverlap(first, candidate); };
  const bool simultaneous = second == RightOf(first);
  int next = simultaneous ? SelectNextStereoFirst(first, num_track_, options_.max_overlap, overlap)
                          : colmap_seapoint::SelectNextFirst(second, num_track_,
                                                             options_.max_overlap, overlap);
  // Where the last picture of the track has a simultaneous one, it adds its own pair.
  if (!simultaneous && second == num_track_ - 1 && RightOf(second) >= 0) next = second;
  const int passed_over = (simultaneous ? first : second) + 1;
  for (int skipped = passed_over; skipped < std::min(next, num_track_ - 1); ++skipped) {
    PairReport report = NewReport(skipped, -1, "sequence");
    report.skipped = "overlaps too much with the pair before";
    report_.pairs.push_back(report);
  }
  return next;
}

SequenceState::Overlap SequenceState::AssessOverlap(int first) {
  Overlap overlap;
  const auto points = SeaPointsAt(first);
  const CellGrid cells = CellsAt(first);
  const double radius = options_.influence_radius * LongerSide(first);
  overlap.labels.assign(points->points.size(), SeaPointLabel::kNA);
  if (previous_first_ >= 0) {
    const auto matches = MatchesOf(previous_first_, first);
    overlap.mask = MakeInfluenceMask(cells, points->points, *matches, previous_, radius);
    overlap.labels =
        LabelSeaPoints(overlap.mask, points->points, *matches, previous_.labels, radius);
    overlap.rate = overlap.mask.OverlapRate();
    overlap.closed = overlap.mask.marked;
  }
  if (options_.redundancy == "all") {
    const View view = ViewAt(first);
    const ViewCoverage coverage =
        ProjectCoverage(footprints_, view.camera, view.cam_from_world, cells);
    for (size_t i = 0; i < overlap.labels.size(); ++i) {
      const SeaPoint& point = points->points[i];
      const bool covered = coverage.range[cells.IndexOf(point.x, point.y)] > 0;
      if (covered) overlap.labels[i] = SeaPointLabel::kOA;
      if (!covered && overlap.labels[i] == SeaPointLabel::kOA) {
        overlap.labels[i] = SeaPointLabel::kREA;
      }
    }
    overlap.rate = coverage.CoveredShare();
    overlap.covered_range = coverage.range;
    overlap.closed.clear();
  }
  return overlap;
}

std::vector<PixelPair> SequenceState::SeedsFromMatches(int first, int second,
                                                       const std::vector<SeaPointLabel>& labels) {
  const auto points1 = SeaPointsAt(first), points2 = SeaPointsAt(second);
  std::vector<PixelPair> seeds;
  for (const FeatureMatch& match : *MatchesOf(first, second)) {
    if (!labels.empty() && labels[match.idx1] == SeaPointLabel::kOA) continue;
    const SeaPoint& a = points1->points[match.idx1];
    const SeaPoint& b = points2->points[match.idx2];
    seeds.push_back({{a.x, a.y}, {b.x, b.y}});
  }
  return seeds;
}

// Ours: the model's triangulated points are seeds too; their projections obey the poses exactly.
void SequenceState::AppendModelSeeds(int first, int second, std::vector<PixelPair>* seeds) const {
  const View view1 = ViewAt(first), view2 = ViewAt(second);
  for (const uint64_t id : ImageAt(first).point3D_ids) {
    if (id == kNoPoint3D) continue;
    const Eigen::Vector3d& xyz = model_.points3D.at(id).xyz;
    const auto pixel1 = view1.camera.ImgFromCam(view1.cam_from_world * xyz);
    const auto pixel2 = view2.camera.ImgFromCam(view2.cam_from_world * xyz);
    if (!pixel1 || !pixel2 || !view1.camera.InImage(*pixel1) || !view2.camera.InImage(*pixel2)) {
      continue;
    }
    seeds->push_back({*pixel1, *pixel2});
  }
}

PairReport SequenceState::NewReport(int first, int second, const std::string& pass) const {
  PairReport report;
  report.image_idx1 = ImageIdxAt(first);
  report.pass = pass;
  if (second >= 0) {
    report.image_idx2 = ImageIdxAt(second);
    report.baseline = (ImageAt(first).cam_from_world.OriginInSource() -
                       ImageAt(second).cam_from_world.OriginInSource())
                          .norm();
  }
  return report;
}

bool SequenceState::RunPair(int first, int second, const Overlap& overlap,
                            std::vector<PixelPair> seeds, PairReport* report, PairResult* result) {
  const Timer timer;
  densified_pairs_.insert(Ordered(first, second));
  const auto picture1 = cache_.Get(ImageIdxAt(first));
  const auto picture2 = cache_.Get(ImageIdxAt(second));
  if (!picture1 || !picture2) {
    report->skipped = "a picture cannot be read";
    return false;
  }
  PairInput input;
  input.view1 = ViewAt(first);
  input.view2 = ViewAt(second);
  input.picture1 = picture1.get();
  input.luma2 = &picture2->luma;
  input.seeds = std::move(seeds);
  input.cells = CellsAt(first);
  input.closed = overlap.closed;
  input.covered_range = overlap.covered_range;
  input.in_full = options_.mode == "complete";
  *result = DensifyPair(input, options_, num_threads_);
  report->overlap = overlap.rate;
  report->skipped = result->failure;
  report->num_seeds = result->num_seeds;
  report->num_failed_seeds = result->num_failed_seeds;
  report->num_points = static_cast<int64_t>(result->cloud.points.size());
  report->rectification_seconds = result->rectification_seconds;
  report->propagation_seconds = result->propagation_seconds;
  report->total_seconds = timer.WallSeconds();
  if (!result->failure.empty()) return false;
  footprints_.emplace_back(result->footprint);
  report_.num_points += report->num_points;
  callbacks_.sink(result->cloud);
  if (callbacks_.debug) ShowPair(first, second, overlap, *report, std::move(input), *result);
  return true;
}

void SequenceState::ShowPair(int first, int second, const Overlap& overlap,
                             const PairReport& report, PairInput input, const PairResult& result) {
  const auto points = SeaPointsAt(first);
  PairDebug debug;
  debug.report = report;
  debug.view1 = input.view1;
  debug.view2 = input.view2;
  debug.picture1 = input.picture1;
  debug.points1 = &points->points;
  debug.labels1 = overlap.labels;
  debug.influence_radius1 = options_.influence_radius * LongerSide(first);
  debug.cells = input.cells;
  debug.covered_range = overlap.covered_range;
  debug.partial = &result;
  debug.failed_seeds = FailedSeeds(input, result);
  std::shared_ptr<const Picture> previous;
  std::shared_ptr<const Features> previous_points;
  if (overlap.mask.grid.Size() > 0) {
    debug.previous_image_idx = ImageIdxAt(previous_first_);
    previous = cache_.Get(ImageIdxAt(previous_first_));
    previous_points = SeaPointsAt(previous_first_);
    debug.previous_picture = previous.get();
    debug.previous_points = &previous_points->points;
    debug.previous_labels = previous_.labels;
    debug.interpair = *MatchesOf(previous_first_, first);
    debug.mask = overlap.mask;
    debug.influence_radius0 = options_.influence_radius * LongerSide(previous_first_);
  }
  input.in_full = true;
  const std::vector<PixelPair> all_seeds = SeedsFromMatches(first, second, {});
  input.seeds.insert(input.seeds.end(), all_seeds.begin(), all_seeds.end());
  debug.normal = DensifyPair(input, options_, num_threads_);
  callbacks_.debug(debug);
}

void SequenceState::DensifyNewAreas(int first, int second) {
  // Decoded while this pair is densified: most often they are the next pair.
  if (second + 1 < num_track_) cache_.Prefetch(ImageIdxAt(second + 1));
  if (second + 2 < num_track_) cache_.Prefetch(ImageIdxAt(second + 2));
  PairReport report = NewReport(first, second, "sequence");
  const Overlap overlap = AssessOverlap(first);
  for (const SeaPointLabel label : overlap.labels) {
    report.num_oa += label == SeaPointLabel::kOA;
    report.num_na += label == SeaPointLabel::kNA;
    report.num_rea += label == SeaPointLabel::kREA;
  }
  // Paper 2.6: SeaPoints in the overlap area form no seeds. Against surface that is known (ours)
  // the pair itself decides, since a new object may stand in front of it.
  const bool by_label = options_.mode == "partial" && !overlap.closed.empty();
  std::vector<PixelPair> seeds =
      SeedsFromMatches(first, second, by_label ? overlap.labels : std::vector<SeaPointLabel>());
  AppendModelSeeds(first, second, &seeds);
  PairResult result;
  RunPair(first, second, overlap, std::move(seeds), &report, &result);
  report_.pairs.push_back(report);

  // What was closed or covered counts as filled: it is processed, though not by this pair.
  const CellGrid cells = CellsAt(first);
  result.filled.resize(cells.Size(), 0.0f);
  for (size_t cell = 0; cell < cells.Size(); ++cell) {
    const bool done_before = (!overlap.closed.empty() && overlap.closed[cell]) ||
                             (!overlap.covered_range.empty() && overlap.covered_range[cell] > 0);
    if (done_before) result.filled[cell] = 1;
  }
  previous_first_ = first;
  previous_.points = SeaPointsAt(first)->points;
  previous_.labels = RelabelProcessed(cells, result.filled, previous_.points,
                                      options_.influence_radius * LongerSide(first));
  previous_.grid = cells;
  previous_.filled = std::move(result.filled);
}

void SequenceState::Complete(int position) {
  constexpr int kMaxPartners = 3;
  if (options_.redundancy != "all") return;
  const View view = ViewAt(position);
  std::vector<CompletionCandidate> candidates;
  for (const int partner : covisible_[static_cast<size_t>(position)]) {
    if (densified_pairs_.count(Ordered(position, partner)) == 0) {
      candidates.push_back({partner, ViewAt(partner)});
    }
  }
  CompletionView seen = LookAt(view, CellsAt(position), footprints_, given_up_);
  for (int tries = 0; tries < kMaxPartners && !candidates.empty(); ++tries) {
    seen.predicted_range = PredictRanges(model_, ImageAt(position), view, seen.coverage);
    const CompletionTarget target = SelectCompletionPartner(view, seen, candidates);
    if (target.partner < 0) return;
    candidates.erase(std::find_if(candidates.begin(), candidates.end(), [&](const auto& candidate) {
      return candidate.position == target.partner;
    }));
    Overlap overlap;
    overlap.rate = seen.coverage.CoveredShare();
    overlap.closed = target.closed;
    PairReport report = NewReport(position, target.partner, "completion");
    std::vector<PixelPair> seeds = SeedsFromMatches(position, target.partner, {});
    AppendModelSeeds(position, target.partner, &seeds);
    const std::vector<PixelPair> rim = SeedsAlongRim(view, ViewAt(target.partner), seen);
    seeds.insert(seeds.end(), rim.begin(), rim.end());
    PairResult result;
    if (RunPair(position, target.partner, overlap, std::move(seeds), &report, &result)) {
      AddCoverage(footprints_.back(), view.camera, view.cam_from_world, &seen.coverage);
    }
    report_.pairs.push_back(report);
    NoteFailures(view, target, result.filled, &seen, &given_up_);
  }
}

SequenceReport SequenceState::TakeReport() {
  report_.left_out = cache_.LeftOut();
  return std::move(report_);
}

}  // namespace colmap_seapoint
