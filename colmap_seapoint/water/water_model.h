// What lies between a surface's colour and its picture under water, as one survey has it.
//
// A channel's light is I = c^v (J exp(-a z) + B (1 - exp(-b z))): the surface's own J, weakened
// over the range z, and the water's veil, which grows with it towards B (Akkaynak and Treibitz
// 2018); all of it darker by the power v of the cosine off the camera's axis, as lenses and lamps
// have it (ours: over even ground the edge of a picture is its far part too, and its vignette would
// pass for water). These are the survey's effective values: what its lamps do with the range is in
// them too. For products that a person looks at only: matching gains nothing by it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>

namespace colmap_seapoint {

// A place as one picture shows it.
struct WaterSample {
  uint32_t place = 0;     // the same number: the same place
  uint32_t picture = 0;   // for the order only
  float range = 0;        // from the camera, in the model's unit; positive
  float axis_cosine = 1;  // of the angle between the ray and the camera's axis; above 0
  // Linear light, 1 = white; the mean over the same patch of ground in every picture: where far
  // pictures blur what near ones show, contrast is lost as behind a veil.
  std::array<float, 3> rgb = {0, 0, 0};
};

enum class WaterState {
  kDetermined,
  kTooFewPlaces,  // few places, or none, are seen from two ranges
  kOneRange,      // all ranges of a place are about the same
  kUncertain,     // colours would be wrong by more than a tenth
};

struct WaterModel {
  WaterState state = WaterState::kTooFewPlaces;
  // Red, green, blue. Without kDetermined a and B are 0.
  Eigen::Array3d attenuation = Eigen::Array3d::Zero();  // a, 1/unit
  Eigen::Array3d veil = Eigen::Array3d::Zero();         // B, linear light
  Eigen::Array3d veil_rate = Eigen::Array3d::Zero();    // b, 1/unit
  double falloff = 0;                                   // v
  Eigen::Array3d white = Eigen::Array3d::Ones();        // factors on J: the survey's mean is grey
  // Factors of exp(a z) beyond these would show noise: what lies farther stays as weak as it is.
  Eigen::Array3d max_gain = Eigen::Array3d::Ones();

  bool IsDetermined() const { return state == WaterState::kDetermined; }
};

// The surface's colour in linear light, not below 0; it may be above 1. A range that is unknown
// (not positive, NaN) is taken as 0: then the colour is only balanced.
Eigen::Array3f Restore(const WaterModel& water, const Eigen::Array3f& rgb, float range,
                       float axis_cosine = 1);
// The same of a picture's bytes, which are sRGB, into bytes.
std::array<uint8_t, 3> RestorePixel(const WaterModel& water, const std::array<uint8_t, 3>& rgb,
                                    float range, float axis_cosine = 1);

// "the water is not known: ..." or its values, for a report; one line.
std::string WaterText(const WaterModel& water);

}  // namespace colmap_seapoint
