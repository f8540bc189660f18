// Attenuation and veil of one channel, from places of unknown colour. For this room only.
#pragma once

#include <cstddef>
#include <vector>

namespace colmap_seapoint {

// One channel of places seen several times; the samples of a place follow one another.
struct ChannelSamples {
  std::vector<double> range;      // over the median range of the survey
  std::vector<double> light;      // linear
  std::vector<size_t> place_end;  // behind the last sample of each place
};

struct ChannelFit {
  double attenuation = 0, veil = 0, veil_rate = 0;  // rates: over the median range
  double attenuation_sigma = 0;                     // standard deviation
  double noise = 0;                                 // robust standard deviation of the light
};

// The a, B, b of I = J exp(-a z) + B (1 - exp(-b z)) that fit best, the colour J of each place with
// them: least squares with weights that fall with the residual (Cauchy), from several starts, by
// damped Gauss-Newton steps on a, B, b alone, since each J follows from these linearly (variable
// projection, Golub and Pereyra 1973). Where a short span of ranges tells only B b, as it does in
// clear water, b is drawn towards a: a prior as weak as one residual. Time linear in the samples, a
// few microseconds each.
ChannelFit FitChannel(const ChannelSamples& samples);

}  // namespace colmap_seapoint
