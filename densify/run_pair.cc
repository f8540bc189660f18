#include "densify/run_pair.h"

#include <algorithm>

#include "colmap_seapoint/base/timer.h"
#include "densify/overlap/seeds.h"
#include "densify/pair_debug.h"
#include "densify/sequence/partners.h"

namespace colmap_seapoint {

namespace {

// The columns that are known before the pair is densified.
PairReport NewRow(const SequenceContext& context, const PairTask& task) {
  PairReport row;
  row.image_idx1 = context.track.ImageIdx(task.first);
  row.image_idx2 = context.track.ImageIdx(task.second);
  row.pass = task.pass;
  row.baseline = (context.track.Image(task.first).cam_from_world.OriginInSource() -
                  context.track.Image(task.second).cam_from_world.OriginInSource())
                     .norm();
  for (const SeaPointLabel label : task.overlap.labels) {
    row.num_oa += label == SeaPointLabel::kOA;
    row.num_na += label == SeaPointLabel::kNA;
    row.num_rea += label == SeaPointLabel::kREA;
  }
  return row;
}

// Pictures besides the pair's own that say what they see of its surface.
constexpr size_t kMaxFurther = 2;

// The pair's own may be null: they cannot be read.
struct PairPictures {
  std::shared_ptr<const Picture> picture1, picture2;
  std::vector<std::pair<int, std::shared_ptr<const Picture>>> further;  // position
};

PairPictures PicturesOf(const SequenceContext& context, const PairTask& task) {
  PairPictures pictures{context.pictures->Get(context.track.ImageIdx(task.first)),
                        context.pictures->Get(context.track.ImageIdx(task.second)),
                        {}};
  for (const int partner : BestPartners(context.track, context.covisibility, task.first)) {
    if (pictures.further.size() == kMaxFurther) break;
    if (partner == task.second) continue;
    if (auto picture = context.pictures->Get(context.track.ImageIdx(partner))) {
      pictures.further.emplace_back(partner, std::move(picture));
    }
  }
  return pictures;
}

PairInput InputOf(const SequenceContext& context, const PairTask& task,
                  const PairPictures& pictures) {
  PairInput input;
  input.view1 = context.track.ViewOf(task.first);
  input.view2 = context.track.ViewOf(task.second);
  input.picture1 = pictures.picture1.get();
  input.luma2 = &pictures.picture2->luma;
  input.mask2 = &pictures.picture2->mask;
  for (const auto& [position, picture] : pictures.further) {
    input.further.push_back({context.track.ViewOf(position), &picture->luma, &picture->mask});
  }
  input.seeds = task.seeds;
  input.known = task.overlap.known;
  input.mode = context.mode;
  return input;
}

std::vector<Eigen::Vector2d> FailedSeeds(const PairInput& input, const PairResult& result) {
  constexpr float kHardlyFilled = 0.1f;
  std::vector<Eigen::Vector2d> failed;
  for (const PixelPair& seed : input.seeds) {
    const size_t cell = input.known.grid.IndexOf(seed.pixel1.x(), seed.pixel1.y());
    if (input.known.IsNew(cell) && result.filled[cell] < kHardlyFilled) {
      failed.push_back(seed.pixel1);
    }
  }
  return failed;
}

// The seeds that labels have kept out, too, and nothing counts as known.
PairResult DensifyInFull(const SequenceContext& context, const PairTask& task, PairInput input) {
  const auto all = SeedsFromMatches(context.SeaPoints(task.first)->points,
                                    context.SeaPoints(task.second)->points,
                                    *context.Matches(task.first, task.second), {});
  input.seeds.insert(input.seeds.end(), all.begin(), all.end());
  input.mode = DensificationMode::kComplete;
  return DensifyPair(input, context.options, context.num_threads);
}

// Hands the pair to callbacks.debug, after densifying it in full for comparison. `memory` is that
// of before the pair.
void ShowPair(const SequenceContext& context, const SequenceMemory& memory, const PairTask& task,
              const PairOutcome& pair) {
  const PairPictures pictures = PicturesOf(context, task);
  const auto points = context.SeaPoints(task.first);
  const PairInput input = InputOf(context, task, pictures);
  PairDebug debug;
  debug.report = pair.row;
  debug.view1 = input.view1;
  debug.view2 = input.view2;
  debug.picture1 = input.picture1;
  debug.points1 = &points->points;
  debug.labels1 = task.overlap.labels;
  debug.influence_radius1 = context.InfluenceRadius(task.first);
  debug.known = input.known;
  debug.partial = &pair.result;
  debug.failed_seeds = FailedSeeds(input, pair.result);
  std::shared_ptr<const Picture> previous;
  std::shared_ptr<const Features> previous_points;
  if (task.overlap.mask.grid.Size() > 0) {
    debug.previous_image_idx = context.track.ImageIdx(memory.previous_first);
    previous = context.pictures->Get(debug.previous_image_idx);
    previous_points = context.SeaPoints(memory.previous_first);
    debug.previous_picture = previous.get();
    debug.previous_points = &previous_points->points;
    debug.previous_labels = memory.previous.labels;
    debug.interpair = *context.Matches(memory.previous_first, task.first);
    debug.mask = task.overlap.mask;
    debug.influence_radius0 = context.InfluenceRadius(memory.previous_first);
  }
  const PairResult normal = DensifyInFull(context, task, input);
  debug.normal = &normal;
  context.callbacks.debug(debug);
}

}  // namespace

std::vector<PixelPair> FormSeeds(const SequenceContext& context, int first, int second,
                                 const std::vector<SeaPointLabel>& labels) {
  const Track& track = context.track;
  std::vector<PixelPair> seeds =
      SeedsFromMatches(context.SeaPoints(first)->points, context.SeaPoints(second)->points,
                       *context.Matches(first, second), labels);
  const std::vector<PixelPair> of_model =
      SeedsFromModel(context.model, track.Image(first), track.ViewOf(first), track.ViewOf(second));
  seeds.insert(seeds.end(), of_model.begin(), of_model.end());
  return seeds;
}

PairOutcome RunPair(const SequenceContext& context, const PairTask& task) {
  const Timer timer;
  PairOutcome pair{NewRow(context, task), {}};
  PairReport& row = pair.row;
  const PairPictures pictures = PicturesOf(context, task);
  if (!pictures.picture1 || !pictures.picture2) {
    row.skipped = pair.result.failure = "a picture cannot be read";
    return pair;
  }
  PartialDensificationOptions options = context.options;
  options.min_confidence = task.min_confidence;
  pair.result = DensifyPair(InputOf(context, task, pictures), options, context.num_threads);
  row.overlap = task.overlap.rate;
  row.skipped = pair.result.failure;
  row.num_seeds = pair.result.num_seeds;
  row.num_failed_seeds = pair.result.num_failed_seeds;
  row.num_points = static_cast<int64_t>(pair.result.cloud.points.size());
  row.rectification_seconds = pair.result.rectification_seconds;
  row.propagation_seconds = pair.result.propagation_seconds;
  row.total_seconds = timer.WallSeconds();
  return pair;
}

void Deliver(const SequenceContext& context, const PairTask& task, const PairOutcome& pair,
             SequenceMemory* memory, SequenceReport* report) {
  memory->tried_pairs.insert(std::minmax(task.first, task.second));
  report->pairs.push_back(pair.row);
  if (!pair.result.failure.empty()) return;
  report->num_points += pair.row.num_points;
  memory->footprints.emplace_back(pair.result.footprint);
  context.callbacks.sink(pair.result.cloud);
  if (context.callbacks.debug) ShowPair(context, *memory, task, pair);
}

PairReport SkippedRow(const SequenceContext& context, int first, const std::string& why) {
  PairReport row;
  row.image_idx1 = context.track.ImageIdx(first);
  row.pass = "sequence";
  row.skipped = why;
  return row;
}

}  // namespace colmap_seapoint
