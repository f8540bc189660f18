// Guards kRetrievalVersion: a change of the loop pairs of an exact dive fails here. If the change
// is meant, raise the version and correct the constant in one commit.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "feature/descriptor/rbrief_descriptor.h"
#include "feature/descriptor/rbrief_pattern.h"
#include "feature/retrieval/loop_candidates.h"
#include "feature/retrieval/seapoint_retrieval.h"
#include "tests/feature/golden.h"

namespace colmap_seapoint {
namespace {

constexpr int kSide = 1000;       // of a picture, pixels
constexpr int kStep = 250;        // between neighbouring pictures
constexpr int kStripLength = 20;  // pictures out, and as many back
constexpr int kOverlap = 5;       // neighbours in the sequence that are matched anyway
constexpr size_t kNumRetrieved = 100;

// The bits of std::mt19937 alone: the distributions differ from one C++ library to another.
int Below(std::mt19937* random, int end) {
  return static_cast<int>((*random)() % static_cast<unsigned>(end));
}

struct GroundPoint {
  int x, y, angle_step;  // pixels; 1/64ths of a turn
  Descriptor descriptor;
};

std::vector<GroundPoint> ExactGround(std::mt19937* random) {
  std::vector<GroundPoint> ground(400 * (kStripLength / 4 + 1));
  for (GroundPoint& point : ground) {
    point.x = Below(random, kSide + kStep * kStripLength);
    point.y = Below(random, kSide);
    point.angle_step = Below(random, 64);
    for (uint8_t& byte : point.descriptor) byte = static_cast<uint8_t>(Below(random, 256));
  }
  return ground;
}

void Append(int x, int y, int angle_step, const Descriptor& descriptor, Features* features) {
  SeaPoint point;
  point.x = static_cast<float>(x) + 0.25f;
  point.y = static_cast<float>(y) + 0.25f;
  point.orientation = static_cast<float>((angle_step + 0.25) * kTurnStep / 2);
  features->points.push_back(point);
  features->descriptors.push_back(descriptor);
}

// What a camera sees whose left edge is at `begin`, upside down on the way back: each descriptor
// with up to 40 bits wrong, and half as many SeaPoints again that are nowhere else.
Features ExactView(const std::vector<GroundPoint>& ground, int begin, bool upside_down,
                   std::mt19937* random) {
  Features view;
  for (const GroundPoint& point : ground) {
    const int x = point.x - begin;
    if (x < 0 || x >= kSide) continue;
    Descriptor seen = TurnDescriptor(point.descriptor, upside_down ? kNumTurns / 2 : 0);
    for (int flips = Below(random, 41); flips > 0; --flips) {
      const auto bit = static_cast<size_t>(Below(random, 256));
      seen[bit / 8] = static_cast<uint8_t>(seen[bit / 8] ^ (1u << bit % 8));
    }
    if (upside_down) {
      Append(kSide - 1 - x, kSide - 1 - point.y, (point.angle_step + 32) % 64, seen, &view);
    } else {
      Append(x, point.y, point.angle_step, seen, &view);
    }
    if (Below(random, 2) == 0) continue;
    for (uint8_t& byte : seen) byte = static_cast<uint8_t>(Below(random, 256));
    const int other_x = Below(random, kSide), other_y = Below(random, kSide);
    Append(other_x, other_y, Below(random, 64), seen, &view);
  }
  return view;
}

// Out along a strip and back over it.
std::vector<Features> ExactDive() {
  std::mt19937 random(3);
  const std::vector<GroundPoint> ground = ExactGround(&random);
  std::vector<Features> dive;
  for (int i = 0; i < kStripLength; ++i) {
    dive.push_back(ExactView(ground, kStep * i, false, &random));
  }
  for (int i = kStripLength - 1; i >= 0; --i) {
    dive.push_back(ExactView(ground, kStep * i + kStep / 3, true, &random));
  }
  return dive;
}

std::vector<LoopCandidate> FindLoops(const std::vector<Features>& dive) {
  std::vector<Descriptor> sample;
  size_t num_points = 0;
  for (const Features& features : dive) {
    AppendSample(features, &sample);
    num_points += features.points.size();
  }
  SeaPointIndex index(SeaPointVocabulary(std::move(sample), NumWordsFor(num_points), 0),
                      num_points);
  for (const Features& features : dive) index.Add(index.MakeEntries(features));
  index.Finish();
  std::vector<std::vector<RetrievedPicture>> retrieved;
  for (int i = 0; i < static_cast<int>(dive.size()); ++i) {
    std::vector<uint32_t> excluded;
    for (int j = std::max(0, i - kOverlap);
         j <= std::min(static_cast<int>(dive.size()) - 1, i + kOverlap); ++j) {
      excluded.push_back(static_cast<uint32_t>(j));
    }
    retrieved.push_back(index.Query(dive[static_cast<size_t>(i)], excluded, kNumRetrieved, 1));
  }
  return ChooseLoopCandidates(retrieved, kOverlap, 4);
}

constexpr char kVersionOfTheHash[] = "2";  // to be raised together with the hash
constexpr uint64_t kLoops = 0xD449C3549D92BE26;

TEST(RetrievalVersion, StandsForTheSameLoops) {
  ASSERT_STREQ(kRetrievalVersion, kVersionOfTheHash);
  const std::vector<LoopCandidate> loops = FindLoops(ExactDive());
  GoldenHash hash;
  int num_true = 0;
  for (const LoopCandidate& loop : loops) {
    hash.Add(loop.first);
    hash.Add(loop.second);
    hash.Add(loop.support);
    const int back = 2 * kStripLength - 1 - static_cast<int>(loop.second);
    num_true += std::abs(static_cast<int>(loop.first) - back) <= 4 ? 1 : 0;
  }
  EXPECT_GE(num_true, kStripLength);
  EXPECT_EQ(hash.Value(), kLoops) << std::hex << hash.Value() << std::dec << " of " << loops.size();
}

}  // namespace
}  // namespace colmap_seapoint
