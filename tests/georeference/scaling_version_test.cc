// kScalingVersion's guard: a hash of similarities that exact and disturbed surveys give. When it
// fails because a result has changed on purpose, raise kScalingVersion, and set both constants at
// the end anew.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "colmap_seapoint/georeference/estimate_similarity.h"
#include "colmap_seapoint/io/files/content_hash.h"

namespace colmap_seapoint {
namespace {

Similarity3d Truth() {
  Similarity3d truth;
  truth.scale = 3.7;
  truth.rotation = Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, -2, 0.5).normalized());
  truth.translation = {52, -40, -12.5};
  return truth;
}

// `count` positions of `num_strips` strips, each off by about `noise` metres, without a random
// number; every seventh by 5 m more where there are outliers.
SimilarityProblem Survey(int num_strips, int count, double noise, bool has_outliers) {
  const Similarity3d truth = Truth();
  SimilarityProblem problem;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d metres(50 + 0.6 * (i / num_strips), -50 + 1.2 * (i % num_strips),
                                 -10 + 0.1 * (i % 5));
    PositionMeasurement position;
    position.in_model = truth.rotation.conjugate() * (metres - truth.translation) / truth.scale;
    const double phase = 2.3 * i;
    position.metres = metres + noise * Eigen::Vector3d(std::sin(phase), std::cos(1.9 * phase),
                                                       std::sin(phase + 2));
    if (has_outliers && i % 7 == 3) position.metres.x() += 5;
    problem.positions.push_back(position);
  }
  problem.down_in_model = truth.rotation.conjugate() * -Eigen::Vector3d::UnitZ();
  problem.seed = 1;
  return problem;
}

void AddBars(double wrong_by, SimilarityProblem* problem) {
  for (const double metres : {0.5, 1.2, 0.8, 1.0}) {
    problem->lengths.push_back({metres / 3.7, 1e-4, metres + 0.0003 * metres, 0.001});
  }
  problem->lengths[1].metres += wrong_by;
}

// To a millionth of a metre and of the scale: another processor's last bits do not count.
std::string TextOf(const SimilarityEstimate& estimate) {
  const Similarity3d& s = estimate.metric_from_model;
  const Eigen::Vector3d moved = s * Eigen::Vector3d(1, 2, 3);
  char numbers[200];
  std::snprintf(numbers, sizeof(numbers), "%.6f %.6f %.5f %.5f %.5f %.6f %.4f ", s.scale,
                estimate.scale_sigma, moved.x(), moved.y(), moved.z(), estimate.position_rms,
                estimate.rotation_sigma_deg);
  std::string text = numbers + estimate.problem + (estimate.is_levelled ? " levelled " : " ");
  for (const bool used : estimate.position_used) text += used ? '+' : '-';
  for (const bool used : estimate.length_used) text += used ? '1' : '0';
  for (const std::string& warning : estimate.warnings) text += "\n  " + warning;
  return text + "\n";
}

std::string AllEstimates() {
  std::string text;
  for (const bool has_outliers : {false, true}) {
    for (const double noise : {0.003, 0.2}) {
      text += TextOf(EstimateSimilarity(Survey(3, 24, noise, has_outliers)));  // every sample
      text += TextOf(EstimateSimilarity(Survey(4, 60, noise, has_outliers)));  // drawn ones
      SimilarityProblem with_bars = Survey(3, 24, noise, has_outliers);
      AddBars(has_outliers ? 0.2 : 0, &with_bars);
      text += TextOf(EstimateSimilarity(with_bars));
      SimilarityProblem line = Survey(1, 12, noise, has_outliers);
      text += TextOf(EstimateSimilarity(line));
    }
    SimilarityProblem bars;
    AddBars(has_outliers ? 0.2 : 0, &bars);
    text += TextOf(EstimateSimilarity(bars));
  }
  return text;
}

constexpr char kVersionOfTheHash[] = "1";  // to be raised together with the hash
constexpr char kHash[] = "xxh3-50eb52445162a88c";

TEST(ScalingVersionTest, TheSameSimilaritiesAsWhenTheVersionWasGiven) {
  EXPECT_STREQ(kScalingVersion, kVersionOfTheHash);
  const std::string estimates = AllEstimates();
  EXPECT_EQ(HashText(estimates), kHash) << "of:\n" << estimates;
}

}  // namespace
}  // namespace colmap_seapoint
