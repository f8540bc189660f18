// How much an observation's error counts (robust estimation by weights): s is the squared error in
// units of the scale, Cost() what it adds to twice the sum that is made least, and Weight() the
// derivative of that, by which the squared error is weighted in each linear problem.
#pragma once

#include <cmath>

namespace colmap_seapoint {

enum class LossKind {
  kSquares,       // s
  kSoftLOne,      // by its size, far beyond the scale
  kCauchy,        // by the logarithm of its size: hardly more
  kGemanMcClure,  // never more than 1: rejected, far beyond the scale
};

struct RobustLoss {
  LossKind kind = LossKind::kSoftLOne;
  double scale = 0.5;  // pixels

  double Cost(double s) const {
    switch (kind) {
      case LossKind::kSoftLOne:
        return 2 * (std::sqrt(1 + s) - 1);
      case LossKind::kCauchy:
        return std::log1p(s);
      case LossKind::kGemanMcClure:
        return s / (1 + s);
      case LossKind::kSquares:
        break;
    }
    return s;
  }

  double Weight(double s) const {
    switch (kind) {
      case LossKind::kSoftLOne:
        return 1 / std::sqrt(1 + s);
      case LossKind::kCauchy:
        return 1 / (1 + s);
      case LossKind::kGemanMcClure:
        return 1 / ((1 + s) * (1 + s));
      case LossKind::kSquares:
        break;
    }
    return 1;
  }
};

}  // namespace colmap_seapoint
