#include "densify/match/consistency.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace colmap_seapoint {
namespace {

constexpr float kTolerance = 1;  // of disparity between neighbours of one surface, at small steps

PartialDisparity Empty(int width, int height, int step) {
  PartialDisparity partial;
  partial.grid = SampleGrid({-20, 5, width * step, height * step}, step);
  partial.disparity.assign(partial.grid.Size(), 0);
  partial.score.assign(partial.grid.Size(), -1);
  return partial;
}

void Put(int a, int b, float disparity, float score, PartialDisparity* partial) {
  const size_t i = static_cast<size_t>(b * partial->grid.width + a);
  partial->disparity[i] = disparity;
  partial->score[i] = score;
}

float At(const PartialDisparity& partial, int a, int b) {
  return partial.disparity[static_cast<size_t>(b * partial.grid.width + a)];
}

PairGeometry GeometryOfFocal(double focal) {
  PairGeometry geometry;
  geometry.focal = focal;
  geometry.baseline = 1;
  return geometry;
}

Gate OpenGate(const PartialDisparity& partial) {
  return Gate(partial.grid.window, kMinNodeStep, Gate::kOpen);
}

// Two surfaces that see each other's places: of two claims to one place the better stays.
TEST(ConsistencyTest, TheBetterOfTwoClaimsStays) {
  for (const int step : {1, 2, 3}) {
    for (const bool right_is_better : {false, true}) {
      PartialDisparity partial = Empty(60, 3, step);
      const float far = 20, near = 20 + 12 * static_cast<float>(step);  // 12 samples apart
      for (int a = 0; a < 30; ++a) Put(a, 1, far, right_is_better ? 0.8f : 0.9f, &partial);
      for (int a = 30; a < 60; ++a) Put(a, 1, near, right_is_better ? 0.9f : 0.8f, &partial);
      // Sample 30 + k of the right side lies where 18 + k of the left one does.
      RemoveContradictions(OpenGate(partial), 2, &partial);
      for (int a = 0; a < 60; ++a) {
        const bool contested = a >= 18 && a < 42;
        const bool loses = contested && (a < 30) == right_is_better;
        const size_t i = static_cast<size_t>(60 + a);
        ASSERT_EQ(partial.disparity[i], loses ? 0 : a < 30 ? far : near) << a;
        ASSERT_EQ(partial.score[i] == -1, loses) << a;
      }
    }
  }
}

// Steep, but one surface: neighbours that fall on the same place by rounding both stay.
TEST(ConsistencyTest, OneSurfaceDoesNotContradictItself) {
  PartialDisparity partial = Empty(50, 2, 1);
  for (int a = 0; a < 50; ++a) Put(a, 0, 30 + 0.9f * static_cast<float>(a), 0.9f, &partial);
  const PartialDisparity before = partial;
  RemoveContradictions(OpenGate(partial), 1, &partial);
  EXPECT_EQ(partial.disparity, before.disparity);
}

// Random rows: whoever went had a better rival at its place; of the rest no two at one place are
// clearly apart, unless a third one hung together with both.
TEST(ConsistencyTest, RandomClaims) {
  std::mt19937 generator(1);
  int num_removed = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const int step = 1 + trial % 3;
    PartialDisparity partial = Empty(80, 1, step);
    for (int a = 0; a < 80; ++a) {
      if (generator() % 4 == 0) continue;
      const float level = 10 + 25 * static_cast<float>(generator() % 4);
      Put(a, 0, level, 0.5f + static_cast<float>(generator() % 1000) / 2000, &partial);
    }
    const PartialDisparity before = partial;
    RemoveContradictions(OpenGate(partial), 1, &partial);
    const float largest = *std::max_element(before.disparity.begin(), before.disparity.end());
    const auto place = [&](int a) {
      return a + static_cast<int>(
                     std::floor((largest - At(before, a, 0)) / static_cast<float>(step) + 0.5f));
    };
    for (int a = 0; a < 80; ++a) {
      const float d = At(before, a, 0);
      if (d == 0) continue;
      // The levels are clearly apart, so exactly the best of a place stays.
      bool best = true;
      for (int other = 0; other < 80; ++other) {
        if (other == a || At(before, other, 0) == 0 || place(other) != place(a)) continue;
        const float mine = before.score[static_cast<size_t>(a)];
        const float theirs = before.score[static_cast<size_t>(other)];
        best = best && (mine > theirs || (mine == theirs && a < other));
      }
      ASSERT_EQ(At(partial, a, 0), best ? d : 0) << trial << " " << a;
      num_removed += !best;
    }
  }
  EXPECT_GT(num_removed, 500);
}

TEST(ConsistencyTest, WhatTheGateDoesNotAdmitGoes) {
  for (const int step : {1, 2, 4, 7}) {
    PartialDisparity partial = Empty(40, 20, step);
    Gate gate = OpenGate(partial);
    for (size_t node = 0; node < gate.Nodes().Size(); ++node) {
      if (node % 4 == 1) gate.Close(node);
      if (node % 4 == 2) gate.Cover(node, {50, 50});
      if (node % 4 == 3) gate.Cover(node, {80, 80});
    }
    for (int b = 0; b < 20; ++b) {
      for (int a = 0; a < 40; ++a) Put(a, b, 53, 0.9f, &partial);
    }
    RemoveContradictions(gate, 3, &partial);
    int num_left = 0, num_gone = 0;
    for (int b = 0; b < partial.grid.height; ++b) {
      for (int a = 0; a < partial.grid.width; ++a) {
        const size_t node = gate.Nodes().IndexAt(partial.grid.PixelX(a), partial.grid.PixelY(b));
        const bool admitted = node % 4 == 0 || node % 4 == 3;
        ASSERT_EQ(At(partial, a, b), admitted ? 53 : 0);
        ++(admitted ? num_left : num_gone);
      }
    }
    EXPECT_GT(num_left, 100);
    EXPECT_GT(num_gone, 100);
  }
}

// A square of 6 x 6 nodes at `disparity`, on nothing.
PartialDisparity Square(int size, float disparity) {
  PartialDisparity partial = Empty(30, 30, 1);
  for (int b = 10; b < 10 + size; ++b) {
    for (int a = 10; a < 10 + size; ++a) Put(a, b, disparity, 0.9f, &partial);
  }
  return partial;
}

int Count(const PartialDisparity& partial) {
  return static_cast<int>(std::count_if(partial.disparity.begin(), partial.disparity.end(),
                                        [](float d) { return d > 0; }));
}

TEST(ConsistencyTest, SpecksGoAndSurfacesStay) {
  PartialDisparity speck = Square(3, 40);
  RemoveInconsistent(OpenGate(speck), &speck);
  EXPECT_EQ(Count(speck), 0);
  PartialDisparity surface = Square(4, 40);
  RemoveInconsistent(OpenGate(surface), &surface);
  EXPECT_EQ(Count(surface), 16);
}

TEST(ConsistencyTest, LonersGo) {
  PartialDisparity partial = Square(8, 40);
  Put(13, 13, 40 + 2 * kTolerance, 0.99f, &partial);  // disagrees with its neighbours
  Put(18, 11, 40, 0.99f, &partial);                   // three of them agree
  Put(25, 25, 40, 0.99f, &partial);                   // has none
  Put(14, 9, 40, 0.99f, &partial);
  Put(10, 18, 40, 0.99f, &partial);  // two agree
  RemoveInconsistent(OpenGate(partial), &partial);
  EXPECT_EQ(At(partial, 13, 13), 0);
  EXPECT_EQ(At(partial, 18, 11), 40);
  EXPECT_EQ(At(partial, 25, 25), 0);
  EXPECT_EQ(At(partial, 14, 9), 40);
  EXPECT_EQ(At(partial, 10, 18), 0);
  EXPECT_EQ(Count(partial), 64 - 1 + 2);
}

// A speck at the rim of what is reconstructed already is no speck; one at another depth is.
TEST(ConsistencyTest, WhatIsReconstructedSupports) {
  for (const float gate_disparity : {40.0f, 60.0f}) {
    PartialDisparity partial = Square(3, 40);
    Gate gate(partial.grid.window, kMinNodeStep, Gate::kOpen);
    for (int y = 8; y < 16; y += kMinNodeStep) {
      for (int x = 0; x < 12; x += kMinNodeStep) {
        gate.Cover(gate.Nodes().IndexAt(x, y), {gate_disparity, gate_disparity});
      }
    }
    RemoveInconsistent(gate, &partial);
    EXPECT_EQ(Count(partial), gate_disparity == 40 ? 9 : 0);
  }
}

TEST(ConsistencyTest, UnsupportedSurfaceGoes) {
  PartialSurface surface;
  surface.grid = SampleGrid({0, 0, 10, 1}, 1);
  surface.disparity.assign(10, 33);
  for (uint8_t n = 0; n < 10; ++n) surface.support.push_back(n);
  surface.confidence.assign(10, 0.8f);
  RemoveUnsure(GeometryOfFocal(100), 0.8f, 2, &surface);
  for (size_t n = 0; n < 10; ++n) EXPECT_EQ(surface.disparity[n], n < 6 ? 0 : 33);
}

TEST(ConsistencyTest, UnsureSurfaceGoes) {
  PartialSurface surface;
  surface.grid = SampleGrid({0, 0, 10, 1}, 1);
  surface.disparity.assign(10, 33);
  surface.support.assign(10, 25);
  for (int n = 0; n < 10; ++n) surface.confidence.push_back(0.1f * static_cast<float>(n));
  PartialSurface all = surface;
  RemoveUnsure(GeometryOfFocal(100), 0.45f, 2, &surface);
  for (size_t n = 0; n < 10; ++n) EXPECT_EQ(surface.disparity[n], n < 5 ? 0 : 33);
  RemoveUnsure(GeometryOfFocal(100), 0, 2, &all);
  for (size_t n = 0; n < 10; ++n) EXPECT_EQ(all.disparity[n], 33);
}

TEST(ConsistencyTest, SameWithAnyNumberOfThreads) {
  std::mt19937 generator(2);
  PartialDisparity partial = Empty(120, 100, 2);
  for (int b = 0; b < 100; ++b) {
    for (int a = 0; a < 120; ++a) {
      Put(a, b, static_cast<float>(10 + generator() % 90),
          0.5f + static_cast<float>(generator() % 500) / 1000, &partial);
    }
  }
  PartialDisparity one = partial;
  RemoveContradictions(OpenGate(one), 1, &one);
  EXPECT_LT(Count(one), Count(partial));
  for (const int num_threads : {2, 5}) {
    PartialDisparity many = partial;
    RemoveContradictions(OpenGate(many), num_threads, &many);
    EXPECT_EQ(many.disparity, one.disparity);
    EXPECT_EQ(many.score, one.score);
  }
}

// Towards the epipole, far along x, the same disparity is an ever smaller angle between the rays.
TEST(ConsistencyTest, RaysThatHardlyMeetMeasureNothing) {
  PartialSurface surface;
  surface.grid = SampleGrid(RectWindow{0, -4, 2000, 8}, 8);
  surface.disparity.assign(surface.grid.Size(), 20);
  surface.support.assign(surface.grid.Size(), 25);
  const double focal = 500;
  surface.confidence.assign(surface.grid.Size(), 1);
  RemoveUnsure(GeometryOfFocal(focal), 0.5f, 2, &surface);
  for (int a = 0; a < surface.grid.width; ++a) {
    // Two pinholes a baseline of 1 apart, the point in the plane y = 0.
    const double x = surface.grid.RectX(a), depth = focal / 20;
    const double angle = std::atan(x / focal) - std::atan((x * depth / focal - 1) / depth);
    const float disparity = surface.disparity[static_cast<size_t>(a)];
    if (angle * 180 / M_PI > 2.03) {
      EXPECT_EQ(disparity, 20) << x;
    }
    if (angle * 180 / M_PI < 1.97) {
      EXPECT_EQ(disparity, 0) << x;
    }
  }
}

}  // namespace
}  // namespace colmap_seapoint
