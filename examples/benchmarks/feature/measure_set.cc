#include "examples/benchmarks/feature/measure_set.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/natural_order.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "densify/densify_pair.h"
#include "densify/partial_densification_options.h"
#include "examples/benchmarks/densify/cpu_seconds.h"
#include "examples/benchmarks/feature/detectors.h"
#include "examples/benchmarks/feature/pair_measures.h"
#include "examples/benchmarks/feature/pair_truth.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kMaxSamples = 5;

using Detectors = std::vector<std::unique_ptr<FeatureDetector>>;

struct MeasuredPicture {
  std::string name;
  Camera camera;  // an uncalibrated guess
  CellGrid grid;
  Texture texture;
  std::vector<DetectedFeatures> features;  // by detector
  std::vector<double> extract_cpu;         // by detector
};

MeasuredPicture MeasurePicture(const MeasureOptions& options, const std::string& name,
                               const Detectors& detectors) {
  const GrayImage grey = ReadGrayImage(options.image_path / name);
  MeasuredPicture picture;
  picture.name = name;
  picture.camera = MakeCamera(CameraModel::kSimpleRadial, 1.2 * std::max(grey.width, grey.height),
                              grey.width, grey.height);
  picture.grid = CellsOf(picture.camera, PartialDensificationOptions().step);
  picture.texture = FindTexture(grey, picture.grid);
  picture.features.resize(detectors.size());
  std::vector<std::vector<double>> seconds(detectors.size());
  for (int repeat = 0; repeat < options.num_repeats; ++repeat) {
    for (size_t d = 0; d < detectors.size(); ++d) {
      seconds[d].push_back(
          CpuSecondsOf([&] { picture.features[d] = detectors[d]->Extract(grey); }));
    }
  }
  for (const auto& repeats : seconds) picture.extract_cpu.push_back(Median(repeats));
  return picture;
}

void AddTruth(const SurveyOracle& oracle, const MeasuredPicture& picture1,
              const MeasuredPicture& picture2, const std::vector<uint8_t>& shared,
              const InfluenceMask& mask, size_t d, const FeatureMatches& matches, FeatureRow* row) {
  const size_t image1 = oracle.ImageIdx(picture1.name), image2 = oracle.ImageIdx(picture2.name);
  const auto& points1 = picture1.features[d].Points();
  const auto& points2 = picture2.features[d].Points();
  row->precision = MatchPrecision(oracle, image1, image2, points1, points2, matches);
  row->repeatability = Repeatability(oracle, image1, image2, points1, points2);
  const OverlapScore score = ScoreOverlap(mask, shared, picture2.texture.textured);
  row->true_overlap = score.true_overlap;
  row->overlap_error = score.error;
  row->textured = score.textured;
  row->recall = score.recall;
  row->area_precision = score.precision;
}

FeatureRow MakeRow(const FeatureDetector& detector, const MeasuredPicture& picture1,
                   const MeasuredPicture& picture2, size_t d, const FeatureMatches& matches,
                   const InfluenceMask& mask) {
  const auto& points1 = picture1.features[d].Points();
  const auto& points2 = picture2.features[d].Points();
  const TwoViewGeometry geometry = detector.Verify(picture1.camera, picture1.features[d],
                                                   picture2.camera, picture2.features[d], matches);
  FeatureRow row;
  row.detector = detector.Name();
  row.setting = detector.Setting();
  row.picture1 = picture1.name;
  row.picture2 = picture2.name;
  row.points1 = static_cast<double>(points1.size());
  row.points2 = static_cast<double>(points2.size());
  row.matches = static_cast<double>(matches.size());
  row.matched_share = MatchedShare(matches.size(), points1.size(), points2.size());
  row.verified = static_cast<double>(geometry.inliers.size());
  row.verified_share = MatchedShare(geometry.inliers.size(), points1.size(), points2.size());
  row.reliable_area = mask.OverlapRate();
  row.extract_cpu1 = picture1.extract_cpu[d];
  row.extract_cpu2 = picture2.extract_cpu[d];
  row.texture_limit = picture2.texture.limit;
  return row;
}

void MeasurePair(const MeasureOptions& options, const Detectors& detectors,
                 const SurveyOracle* oracle, const MeasuredPicture& picture1,
                 const MeasuredPicture& picture2, int gap, std::vector<FeatureRow>* rows) {
  std::vector<FeatureMatches> matches(detectors.size());
  std::vector<std::vector<double>> seconds(detectors.size());
  for (int repeat = 0; repeat < options.num_repeats; ++repeat) {
    for (size_t d = 0; d < detectors.size(); ++d) {
      seconds[d].push_back(CpuSecondsOf(
          [&] { matches[d] = detectors[d]->Match(picture1.features[d], picture2.features[d]); }));
    }
  }
  std::vector<uint8_t> shared;
  if (oracle) {
    shared = TrulyShared(*oracle, oracle->ImageIdx(picture2.name), oracle->ImageIdx(picture1.name),
                         picture2.grid);
  }
  const double radius = PartialDensificationOptions().influence_radius *
                        std::max(picture2.camera.width, picture2.camera.height);
  for (size_t d = 0; d < detectors.size(); ++d) {
    const InfluenceMask mask = MatchedArea(picture2.grid, picture1.features[d].Points().size(),
                                           picture2.features[d].Points(), matches[d], radius);
    FeatureRow row = MakeRow(*detectors[d], picture1, picture2, d, matches[d], mask);
    row.set = options.set_name;
    row.gap = gap;
    row.match_cpu = Median(seconds[d]);
    if (oracle) AddTruth(*oracle, picture1, picture2, shared, mask, d, matches[d], &row);
    rows->push_back(row);
  }
}

}  // namespace

std::vector<FeatureRow> MeasureSet(const MeasureOptions& options) {
  std::vector<std::string> names = ListImages(options.image_path);
  std::sort(names.begin(), names.end(), NaturalLess);
  if (names.size() < 2) {
    throw Error(options.image_path.string(), "holds one picture only", "give two or more");
  }
  std::vector<GrayImage> samples;
  const size_t num_samples = options.adjust_thresholds ? std::min(kMaxSamples, names.size()) : 0;
  for (size_t i = 0; i < num_samples; ++i) {
    samples.push_back(ReadGrayImage(options.image_path / names[i * names.size() / num_samples]));
  }
  const Detectors detectors =
      MakeDetectors(options.min_num_features, options.max_num_features, samples);
  SurveyTruth truth;
  std::optional<SurveyOracle> oracle;
  if (options.survey_path) {
    truth = ReadSurveyTruth(*options.survey_path);
    oracle.emplace(truth);
    for (const std::string& name : names) oracle->ImageIdx(name);  // or throws
  }
  std::vector<FeatureRow> rows;
  std::vector<MeasuredPicture> pictures;  // the last three: what a pair can need
  for (size_t i = 0; i < names.size(); ++i) {
    std::fprintf(stderr, "\r%s: picture %zu of %zu", options.set_name.c_str(), i + 1, names.size());
    pictures.push_back(MeasurePicture(options, names[i], detectors));
    if (pictures.size() > 3) pictures.erase(pictures.begin());
    for (size_t gap = 1; gap < pictures.size(); ++gap) {
      MeasurePair(options, detectors, oracle ? &*oracle : nullptr,
                  pictures[pictures.size() - 1 - gap], pictures.back(), static_cast<int>(gap),
                  &rows);
    }
  }
  std::fprintf(stderr, "\n");
  return rows;
}

}  // namespace colmap_seapoint
