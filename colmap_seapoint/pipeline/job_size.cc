#include "colmap_seapoint/pipeline/job_size.h"

#include <nlohmann/json.hpp>

#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/estimate/needs.h"
#include "colmap_seapoint/estimate/preflight.h"
#include "colmap_seapoint/georeference/marker_search.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/pipeline/intake/take_in.h"

namespace colmap_seapoint {
namespace {

using Options = AutomaticReconstructorOptions;

JobSize SizeOf(const Options& options, int64_t num_pictures, double megapixels) {
  const bool matches_all_pairs = MatchesAllPairs(options, static_cast<size_t>(num_pictures));
  JobSize size;
  size.num_pictures = num_pictures;
  size.megapixels = megapixels;
  size.finds_look_alikes = !matches_all_pairs && options.pairs.loop_detection;
  size.num_pairs = matches_all_pairs
                       ? size.num_pictures * (size.num_pictures - 1) / 2
                       : ExpectedSequentialPairs(size.num_pictures, options.pairs.overlap,
                                                 size.finds_look_alikes);
  size.step = options.densification.step;
  size.writes_maps = options.densification.write_maps;
  size.makes_map = options.makes_map;
  size.reports_completeness = options.report_completeness;
  size.finds_markers = !FamiliesToFind(options.scale).empty();
  size.num_threads = EffectiveNumThreads(options.run.num_threads);
  return size;
}

// Of pictures that are taken as they are the headers tell.
JobSize SizeByHeaders(const Options& options) {
  const JobSize guess = SizeBeforeIntake(options, options.image_path);
  if (guess.num_copies > 0 || guess.video_seconds > 0) return guess;
  RunReport ignored;
  const std::vector<std::string> names = ListPictures(options.image_path, "", &ignored);
  return SizeOf(options, ReadHeaders(options.image_path, names, options.run.num_threads, &ignored));
}

double SecondsOf(const WorkCost& cost) {
  return static_cast<double>(cost.count) * cost.seconds_each;
}

}  // namespace

bool MatchesAllPairs(const Options& options, size_t num_pictures) {
  if (options.matcher != "auto") return options.matcher == "exhaustive";
  return num_pictures <= kMaxImagesForAllPairs;
}

JobSize SizeOf(const Options& options, const std::vector<ReadablePicture>& pictures) {
  double megapixels = 0;
  for (const ReadablePicture& picture : pictures) {
    megapixels += 1e-6 * picture.info.width * picture.info.height;
  }
  return SizeOf(options, static_cast<int64_t>(pictures.size()), megapixels);
}

JobSize SizeBeforeIntake(const Options& options, const std::filesystem::path& given) {
  const IntakeSize intake = ExpectIntake(given);
  JobSize size = SizeOf(options, intake.num_pictures, intake.megapixels);
  size.num_copies = intake.num_copies;
  size.video_seconds = intake.video_seconds;
  size.decoded_megapixels = intake.decoded_megapixels;
  return size;
}

CommandResult EstimateJob(const Options& options) {
  const JobSize size = SizeByHeaders(options);
  const Needs needs = ExpectedNeeds(size);
  const OfWork<WorkCost> costs = CostsHere(size);
  double seconds = 0;
  for (const WorkCost& cost : costs.values) seconds += SecondsOf(cost);
  const nlohmann::ordered_json json = {{"pictures", size.num_pictures},
                                       {"megapixels", size.megapixels},
                                       {"seconds", seconds},
                                       {"intake_seconds", SecondsOf(costs[Work::kIntake])},
                                       {"disk_bytes", needs.disk_bytes},
                                       {"memory_bytes", needs.memory_bytes}};
  return {true, json.dump(2) + "\n"};
}

}  // namespace colmap_seapoint
