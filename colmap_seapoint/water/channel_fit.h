// Attenuation and veil of one channel, from places of unknown colour. For this room only.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace colmap_seapoint {

// One channel of places seen several times; the samples of a place follow one another.
struct ChannelSamples {
  std::vector<double> range;       // over the median range of the survey
  std::vector<double> log_cosine;  // of the angle off the camera's axis; 0 on the axis
  std::vector<double> light;       // linear
  std::vector<size_t> place_end;   // behind the last sample of each place
};

struct ChannelFit {
  double attenuation = 0, veil = 0, veil_rate = 0;  // rates: over the median range
  double falloff = 0;                               // the power of the cosine
  double attenuation_sigma = 0;                     // standard deviation
  double noise = 0;                                 // robust standard deviation of the light
};

// The a, B, b and v of I = c^v (J exp(-a z) + B (1 - exp(-b z))) that fit best, the colour J of
// each place with them: least squares with weights that fall with the residual (Cauchy), from
// several starts, by damped Gauss-Newton steps on these four alone, since each J follows from them
// linearly (variable projection, Golub and Pereyra 1973). `falloff`: v, where it is known already.
//
// What the samples do not tell is left to priors as weak as one residual each: b is drawn towards
// a, since a short span of ranges tells only B b; a and v towards 0, of which over level ground
// only the sum shows. Time linear in the samples, some 10 microseconds each.
ChannelFit FitChannel(const ChannelSamples& samples, std::optional<double> falloff = {});

}  // namespace colmap_seapoint
