// What became of one observation.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace colmap_seapoint {

enum class MeasurementOutcome : uint8_t {
  kUnmeasured,  // stays as it is
  kReference,   // stays: the others are measured against it
  kMoved,
  kUnlike,  // taken out, as are the next
  kDiverged,
  kUnsure,
  kElsewhere,
  kTwice,
  kUnseen,
};

inline bool IsTakenOut(MeasurementOutcome outcome) {
  return outcome >= MeasurementOutcome::kUnlike;
}

struct Measurement {
  MeasurementOutcome outcome = MeasurementOutcome::kUnmeasured;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  // when kMoved
};

using ImageMeasurements = std::vector<Measurement>;  // by point2D_idx

}  // namespace colmap_seapoint
