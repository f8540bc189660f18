#include "examples/benchmarks/densify/measure_densify.h"

#include <malloc.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <map>
#include <set>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/report/pairs_csv.h"
#include "densify/densify_pair.h"
#include "densify/densify_sequence.h"
#include "examples/benchmarks/densify/cloud_measures.h"
#include "examples/benchmarks/densify/cpu_seconds.h"
#include "examples/benchmarks/densify/hold_out.h"
#include "examples/benchmarks/densify/memory_pictures.h"
#include "examples/benchmarks/densify/new_area.h"
#include "examples/benchmarks/feature/pair_measures.h"
#include "examples/survey/score.h"

namespace colmap_seapoint {
namespace {

constexpr double kLayerCell = 3;  // spacings of samples
constexpr double kNearCover = 2;  // the same

// The set with its paths filled in, and what it holds.
struct LoadedSet {
  DensifySet set;
  SparseModel model;
  std::optional<SurveyTruth> truth;
  bool truth_poses = false;
  double spacing = 0;  // between samples on the ground, model units
};

LoadedSet Load(const DensifySet& set, const PartialDensificationOptions& densification) {
  LoadedSet loaded;
  loaded.set = WithPaths(set);
  loaded.truth_poses = set.input_path.empty();
  if (!set.survey_path.empty()) loaded.truth = ReadSurveyTruth(set.survey_path);
  loaded.model = ReadSparseModel(loaded.set.input_path);
  if (loaded.model.images.empty()) {
    throw Error(loaded.set.input_path.string(), "holds no pictures", "give another model");
  }
  const Camera& camera = loaded.model.cameras.at(loaded.model.images.front().camera_id);
  loaded.spacing = MedianGsd(loaded.model) * SampleStep(camera, densification.step);
  return loaded;
}

// A line of /proc/self/status, in megabytes; kNotMeasured where there is none.
double StatusMegabytes(const std::string& key) {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind(key + ":", 0) == 0)
      return std::strtod(line.c_str() + key.size() + 1, nullptr) / 1e3;
  }
  return kNotMeasured;
}

struct Run {
  SequenceReport report;
  PairedCloud cloud;
  WorkSeconds seconds;
  double match_cpu = 0;
  double memory_mb = kNotMeasured;
};

Run RunOnce(const SparseModel& model, MemoryPictures* pictures,
            const PartialDensificationOptions& options, int num_threads) {
  Run run;
  malloc_trim(0);  // what an earlier run left behind would hide this one's growth
  std::ofstream("/proc/self/clear_refs") << "5";
  const double before = StatusMegabytes("VmRSS");
  const double match_before = pictures->MatchCpuSeconds();
  std::vector<std::vector<Eigen::Vector3f>> parts;  // as they come: no growing vector is copied
  SequenceCallbacks callbacks;
  callbacks.sink = [&](const PartialCloud& part) {
    parts.emplace_back();
    parts.back().reserve(part.points.size());
    for (const DensePoint& point : part.points) parts.back().push_back(point.xyz);
  };
  callbacks.progress = [](int64_t, int64_t) {};
  run.seconds = SecondsOf([&] {
    run.report =
        DensifySequence(model, pictures, options, EffectiveNumThreads(num_threads), callbacks);
  });
  // A chain's database holds the matches, as it does the SeaPoints.
  run.match_cpu = pictures->MatchCpuSeconds() - match_before;
  run.seconds.cpu -= run.match_cpu;
  run.seconds.wall -= run.match_cpu;  // one thread matches, while the others wait
  const double peak = StatusMegabytes("VmHWM");
  for (size_t i = 0; i < parts.size(); ++i) {
    run.cloud.points.insert(run.cloud.points.end(), parts[i].begin(), parts[i].end());
    run.cloud.pair_idx.resize(run.cloud.points.size(), static_cast<int>(i));
  }
  const size_t cloud_bytes = run.cloud.points.size() * sizeof(Eigen::Vector3f);
  run.memory_mb = std::max(0.0, peak - before - 1e-6 * static_cast<double>(cloud_bytes));
  return run;
}

PartialDensificationOptions OptionsOf(const DensifyVariant& variant,
                                      PartialDensificationOptions options) {
  options.mode = variant.mode;
  options.redundancy = variant.redundancy;
  return options;
}

void WriteDebug(const std::filesystem::path& dir, const std::string& name, const LoadedSet& set,
                const Run& run) {
  if (dir.empty()) return;
  std::filesystem::create_directories(dir);
  WritePairsCsv(dir / (name + "_pairs.csv"), set.model, run.report);
  CloudWriter writer(dir / (name + ".ply"));
  for (const Eigen::Vector3f& point : run.cloud.points) {
    writer.Add({point, Eigen::Vector3f::Zero(), {200, 200, 200}}, nullptr, 0);
  }
  writer.Finish();
}

using PairKey = std::array<int, 2>;

PairKey KeyOf(const PairReport& pair) { return {pair.image_idx1, pair.image_idx2}; }

std::vector<PairReport> Densified(const Run& run) {
  std::vector<PairReport> pairs;
  for (const PairReport& pair : run.report.pairs) {
    if (pair.skipped.empty() && pair.image_idx2 >= 0) pairs.push_back(pair);
  }
  return pairs;
}

void AddPairFigures(const Run& run, DensifyRow* row) {
  std::vector<double> pair_seconds;
  double later = 0, new_share = 0, rea = 0, labels = 0, failed = 0;
  for (const PairReport& pair : Densified(run)) {
    ++row->pairs;
    row->completion_pairs += pair.pass == "completion";
    row->rectification += pair.rectification_seconds;
    row->propagation += pair.propagation_seconds;
    row->seeds += pair.num_seeds;
    failed += pair.num_failed_seeds;
    if (row->pairs == 1 || pair.pass == "completion") continue;
    ++later;
    new_share += 1 - pair.overlap;
    rea += pair.num_rea;
    labels += pair.num_oa + pair.num_na + pair.num_rea;
    pair_seconds.push_back(pair.total_seconds);
  }
  row->passed_over = static_cast<double>(run.report.pairs.size()) - row->pairs;
  if (row->seeds > 0) row->seeds_failed = failed / row->seeds;
  if (later > 0) row->new_share = new_share / later;
  if (labels > 0) row->rea_share = rea / labels;
  if (!pair_seconds.empty()) row->pair_seconds = Median(pair_seconds);
}

void AddTrueNewShare(const LoadedSet& set, const Run& run, const DensifyVariant& variant,
                     int num_threads, DensifyRow* row) {
  std::map<std::string, size_t> position;
  for (size_t i = 0; i < set.truth->model.images.size(); ++i) {
    position[set.truth->model.images[i].name] = i;
  }
  const auto position_of = [&](int image_idx) {
    return position.at(set.model.images.at(static_cast<size_t>(image_idx)).name);
  };
  std::vector<std::array<size_t, 2>> pairs;
  for (const PairReport& pair : Densified(run)) {
    pairs.push_back({position_of(pair.image_idx1), position_of(pair.image_idx2)});
  }
  if (pairs.empty()) return;
  const Against against =
      std::string(variant.redundancy) == "all" ? Against::kAllPairs : Against::kPreviousPair;
  const std::vector<PairArea> areas = NewAreas(*set.truth, pairs, against, num_threads);
  double seen = 0, fresh = 0, later = 0;
  for (size_t i = 0; i < areas.size(); ++i) {
    seen += areas[i].seen;
    fresh += areas[i].fresh;
    if (i > 0 && areas[i].seen > 0) later += areas[i].fresh / areas[i].seen;
  }
  if (seen > 0) row->true_new_share = fresh / seen;
  if (areas.size() > 1) row->true_new_later = later / static_cast<double>(areas.size() - 1);
}

void AddAgainstBaseline(const LoadedSet& set, const Run& run, const Run& baseline,
                        DensifyRow* row) {
  std::map<PairKey, double> seeds;
  const std::vector<PairReport> baseline_pairs = Densified(baseline);
  for (const PairReport& pair : baseline_pairs) seeds[KeyOf(pair)] = pair.num_seeds;
  double same = 0, kept = 0, of = 0;
  for (const PairReport& pair : Densified(run)) {
    const auto match = seeds.find(KeyOf(pair));
    if (match == seeds.end()) continue;
    ++same;
    if (same == 1 || pair.pass == "completion") continue;
    kept += pair.num_seeds;
    of += match->second;
  }
  if (!baseline_pairs.empty()) row->same_pairs = same / static_cast<double>(baseline_pairs.size());
  if (of > 0) row->seeds_kept = kept / of;
  row->kept_cover = ShareNear(baseline.cloud.points, run.cloud.points, kNearCover * set.spacing);
}

void AddScore(const LoadedSet& set, const Run& run, int num_threads, DensifyRow* row) {
  ScoreOptions options;
  options.truth_poses = set.truth_poses;
  options.num_threads = num_threads;
  const SurveyScore score = ScoreSurvey(*set.truth, set.model, {run.cloud.points, {}}, options);
  row->within_1gsd = score.accuracy.share_1gsd;
  row->within_2gsd = score.accuracy.share_2gsd;
  row->within_4gsd = score.accuracy.share_4gsd;
  row->median_gsd = score.accuracy.median_gsd;
  row->coverage_2gsd = score.coverage_2gsd;
  row->coverage_4gsd = score.coverage_4gsd;
  row->points_per_cm2 = score.points_per_cm2;
  row->points_per_gsd2 = score.points_per_gsd2;
  row->redundancy = score.redundancy;
}

DensifyRow MakeRow(const LoadedSet& set, const MemoryPictures& pictures,
                   const DensifyVariant& variant, const Run& run, int num_threads) {
  DensifyRow row;
  row.set = set.set.name;
  row.variant = variant.name;
  row.pictures = static_cast<double>(set.model.images.size());
  row.megapixels = pictures.Megapixels();
  row.threads = EffectiveNumThreads(num_threads);
  row.cpu = run.seconds.cpu;
  row.wall = run.seconds.wall;
  row.match_cpu = run.match_cpu;
  row.seapoint_cpu = pictures.SeaPointCpuSeconds();
  row.memory_mb = run.memory_mb;
  row.points = static_cast<double>(run.cloud.points.size());
  AddPairFigures(run, &row);
  row.layers = MeanLayers(run.cloud, kLayerCell * set.spacing);
  if (set.truth) {
    AddTrueNewShare(set, run, variant, num_threads, &row);
    if (!run.cloud.points.empty()) AddScore(set, run, num_threads, &row);
  }
  return row;
}

}  // namespace

DensifySet WithPaths(DensifySet set) {
  if (set.survey_path.empty()) return set;
  if (set.image_path.empty()) set.image_path = set.survey_path / "images";
  if (set.input_path.empty()) set.input_path = set.survey_path / "truth" / "sparse";
  return set;
}

std::vector<DensifyRow> MeasureDensify(const DensifyMeasureOptions& options) {
  const LoadedSet set = Load(options.set, options.densification);
  std::fprintf(stderr, "%s: decoding %zu pictures\n", set.set.name.c_str(),
               set.model.images.size());
  MemoryPictures pictures(set.model, set.set.image_path, set.set.database_path,
                          options.num_threads);
  std::map<std::string, Run> runs;
  std::map<std::string, std::vector<double>> cpu, wall;
  for (int repeat = 0; repeat < options.num_repeats; ++repeat) {
    for (const std::string& name : options.variants) {
      std::fprintf(stderr, "%s: %s\n", set.set.name.c_str(), name.c_str());
      Run run = RunOnce(set.model, &pictures, OptionsOf(FindVariant(name), options.densification),
                        options.num_threads);
      cpu[name].push_back(run.seconds.cpu);
      wall[name].push_back(run.seconds.wall);
      if (repeat == 0) runs[name] = std::move(run);
    }
  }
  std::vector<DensifyRow> rows;
  for (const std::string& name : options.variants) {
    Run& run = runs.at(name);
    run.seconds = {Median(cpu[name]), Median(wall[name])};
    const DensifyVariant& variant = FindVariant(name);
    rows.push_back(MakeRow(set, pictures, variant, run, options.num_threads));
    const auto baseline = runs.find(variant.baseline == nullptr ? "" : variant.baseline);
    if (baseline != runs.end()) AddAgainstBaseline(set, run, baseline->second, &rows.back());
    WriteDebug(options.debug_path, name, set, run);
  }
  return rows;
}

HoldOutRow MeasureHoldOut(const HoldOutOptions& options) {
  const LoadedSet set = Load(options.set, options.densification);
  MemoryPictures pictures(set.model, set.set.image_path, set.set.database_path,
                          options.num_threads);
  const HoldOut held = HoldOutPoints(set.model, options.every, options.densification);
  for (const auto& [image_idx, places] : held.places) pictures.DropSeaPoints(image_idx, places, 1);
  const Run run =
      RunOnce(held.model, &pictures, OptionsOf(FindVariant(options.variant), options.densification),
              options.num_threads);
  HoldOutRow row;
  row.set = set.set.name;
  row.variant = options.variant;
  row.every = options.every;
  row.points = static_cast<double>(set.model.points3D.size());
  row.held = static_cast<double>(held.num_held);
  row.cloud_points = static_cast<double>(run.cloud.points.size());
  ScoreHoldOut(held.eligible, run.cloud.points, &row);
  LoadedSet without = set;
  without.model = held.model;
  WriteDebug(options.debug_path, "holdout", without, run);
  return row;
}

}  // namespace colmap_seapoint
