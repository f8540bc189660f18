// Results and kDensificationVersion change together: runs that were stored under a version are only
// taken up again while that version still gives the same clouds.
#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "hwy/targets.h"
#include "tests/densify/test_survey.h"

namespace colmap_seapoint {
namespace {

// What this version gives. When this test fails and the change is meant, raise
// kDensificationVersion and take over version and hashes together.
constexpr char kGoldenVersion[] = "9";
constexpr uint64_t kGoldenPartial = 4746184949282076585u;
constexpr uint64_t kGoldenComplete = 13849971665450050520u;

// Two strips of a seabed with a block on it. Only sums, products, quotients and square roots make
// it: what a mathematics library rounds differently elsewhere would be another survey there.
class ExactSurvey : public TestSurvey {
 public:
  ExactSurvey() : TestSurvey(Seabed(), TestCamera()) {
    for (int strip = 0; strip < 2; ++strip) {
      for (int i = 0; i < 5; ++i) {
        const double sway = 0.01 * ((3 * i + strip) % 5 - 2);
        AddPicture(std::to_string(10 * strip + i) + ".png",
                   Above({0.375 * i, 0.875 * strip + sway, sway}, 0.5 * sway));
      }
    }
    AddLandmarks(1200, {-1, 2.5}, {-0.9, 1.8});
  }

 private:
  static Camera TestCamera() { return MakeCamera(CameraModel::kPinhole, 180, 200, 150); }
  static World Seabed() {
    return World(
        {{{0, 0, 2}, {50, 0, 0}, {0, 50, 0}}, {{0.75, 0.25, 1.75}, {0.25, 0, 0}, {0, 0.25, 0}}},
        NoiseTexture(42, 0.16, 4));
  }
  static Viewpoint Above(const Eigen::Vector3d& center, double turn) {
    const Eigen::Quaterniond rotation =
        Eigen::Quaterniond(1, turn, -2 * turn, 3 * turn).normalized();
    return {TestCamera(), {rotation, -(rotation * center)}};
  }
};

// FNV-1a over the bytes of values without padding.
class Hash {
 public:
  template <typename Value>
  void Add(const Value& value) {
    static_assert(std::is_trivially_copyable_v<Value>);
    unsigned char bytes[sizeof(Value)];
    std::memcpy(bytes, &value, sizeof(Value));
    for (const unsigned char byte : bytes) AddByte(byte);
  }
  void Add(const std::string& text) {
    for (const char c : text) AddByte(static_cast<unsigned char>(c));
    AddByte(0);
  }
  uint64_t Value() const { return value_; }

 private:
  void AddByte(unsigned char byte) { value_ = (value_ ^ byte) * 1099511628211u; }

  uint64_t value_ = 14695981039346656037u;
};

void AddRow(const PairReport& row, Hash* hash) {
  hash->Add(row.pass);
  hash->Add(row.skipped);
  for (const double value : {row.baseline, row.overlap}) hash->Add(value);
  for (const int value : {row.image_idx1, row.image_idx2, row.num_oa, row.num_na, row.num_rea,
                          row.num_seeds, row.num_failed_seeds}) {
    hash->Add(value);
  }
  hash->Add(row.num_points);
}

uint64_t HashOf(const Outcome& outcome) {
  Hash hash;
  for (const PairReport& row : outcome.report.pairs) AddRow(row, &hash);
  for (const PartialCloud& cloud : outcome.clouds) {
    for (const DensePoint& point : cloud.points) {
      for (int k = 0; k < 3; ++k) hash.Add(point.xyz[k]);
      for (int k = 0; k < 3; ++k) hash.Add(point.normal[k]);
      hash.Add(point.rgb);
      hash.Add(point.confidence);
    }
  }
  return hash.Value();
}

uint64_t HashInMode(const std::string& mode) {
  ExactSurvey survey;
  PartialDensificationOptions options;
  options.mode = mode;
  const Outcome outcome = Densify(&survey, options);
  EXPECT_GT(outcome.NumPoints(), 50000);
  bool has_completion = false, has_labels = false;
  for (const PairReport& row : outcome.report.pairs) {
    has_completion = has_completion || (row.pass == "completion" && row.skipped.empty());
    has_labels = has_labels || row.num_oa > 0;
  }
  EXPECT_TRUE(has_completion && has_labels) << "the survey no longer shows every stage";
  return HashOf(outcome);
}

TEST(DensificationVersionTest, GuardsTheResults) {
  EXPECT_STREQ(kDensificationVersion, kGoldenVersion);
  EXPECT_EQ(HashInMode("partial"), kGoldenPartial)
      << "raise kDensificationVersion and this hash together";
  EXPECT_EQ(HashInMode("complete"), kGoldenComplete)
      << "raise kDensificationVersion and this hash together";
}

// So the hashes above hold on every machine.
TEST(DensificationVersionTest, EveryInstructionSetGivesTheSame) {
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    EXPECT_EQ(HashInMode("partial"), kGoldenPartial) << hwy::TargetName(target);
  }
  hwy::SetSupportedTargetsForTest(0);
}

}  // namespace
}  // namespace colmap_seapoint
