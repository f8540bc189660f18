// Which of the exact surface a cloud covers.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "examples/survey/survey.h"

namespace colmap_seapoint {

enum SampleState : uint8_t { kNotSeen = 0, kBare, kCovered4, kCovered2, kNumSampleStates };
using StateAreas = std::array<double, kNumSampleStates>;  // m^2 by state

// The surface in squares of kSampleStep cells.
inline constexpr int kSampleStep = 2;

struct SurfaceSamples {
  int nx = 0, ny = 0;           // of the ground
  std::vector<uint8_t> ground;  // state by square, in mean GSD
  // Of ground and object: what is seen twice, in mean GSD; what two pictures see kMinParallaxDeg
  // apart, in GSD of the best such pair.
  StateAreas twice_seen = {}, parallax = {};
};

// `points`: in the truth's frame.
SurfaceSamples SampleSurface(const SurveyTruth& truth, const std::vector<Eigen::Vector3f>& points,
                             int num_threads);

// Share of the seen area whose samples have at least this state.
double CoveredShare(const StateAreas& areas, SampleState state);
double SeenArea(const StateAreas& areas);

}  // namespace colmap_seapoint
