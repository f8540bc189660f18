#include "densify/kernels/plane_kernels.h"

#include <algorithm>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "densify/kernels/plane_kernels.cc"
#include "hwy/foreach_target.h"  // before highway.h: compiles the part below once a target
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace colmap_seapoint {
namespace plane {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using DF = hn::CappedTag<float, 16>;
using VF = hn::Vec<DF>;

// Sums over the samples that agree with the centre, offsets (u, v) in samples from it.
struct Sums {
  VF n, u, v, uu, uv, vv, d, ud, vd, dd;
};

HWY_INLINE Sums SumAround(const float* const* rows, int at, int radius, VF center, VF tolerance) {
  const DF df;
  const VF zero = hn::Zero(df), one = hn::Set(df, 1.0f);
  Sums sums = {zero, zero, zero, zero, zero, zero, zero, zero, zero, zero};
  for (int u = -radius; u <= radius; ++u) {
    VF n = zero, v1 = zero, v2 = zero, d1 = zero, vd = zero;  // of this column
    for (int v = -radius; v <= radius; ++v) {
      const VF value = hn::LoadU(df, rows[v + radius] + at + u);
      const VF difference = hn::Sub(value, center);
      const auto agrees = hn::And(hn::Gt(value, zero), hn::Le(hn::Abs(difference), tolerance));
      const VF weight = hn::IfThenElseZero(agrees, one);
      const VF d = hn::IfThenElseZero(agrees, difference);
      const VF offset = hn::Set(df, static_cast<float>(v));
      n = hn::Add(n, weight);
      v1 = hn::Add(v1, hn::Mul(weight, offset));
      v2 = hn::Add(v2, hn::Mul(weight, hn::Mul(offset, offset)));
      d1 = hn::Add(d1, d);
      vd = hn::Add(vd, hn::Mul(d, offset));
      sums.dd = hn::Add(sums.dd, hn::Mul(d, d));
    }
    const VF offset = hn::Set(df, static_cast<float>(u));
    sums.n = hn::Add(sums.n, n);
    sums.u = hn::Add(sums.u, hn::Mul(n, offset));
    sums.uu = hn::Add(sums.uu, hn::Mul(n, hn::Mul(offset, offset)));
    sums.v = hn::Add(sums.v, v1);
    sums.uv = hn::Add(sums.uv, hn::Mul(v1, offset));
    sums.vv = hn::Add(sums.vv, v2);
    sums.d = hn::Add(sums.d, d1);
    sums.ud = hn::Add(sums.ud, hn::Mul(d1, offset));
    sums.vd = hn::Add(sums.vd, vd);
  }
  return sums;
}

// The rows around `row`, each with kMaxRadius missing samples before and a vector's behind.
class PaddedRows {
 public:
  PaddedRows(const Map& map, int radius)
      : map_(map),
        radius_(radius),
        stride_(static_cast<size_t>(map.width) + kMaxRadius + 32),
        data_(stride_ * static_cast<size_t>(2 * radius + 1), 0.0f) {}

  // rows[k] points to the first sample of row + k - radius.
  void Around(int row, const float** rows) {
    for (int y = row - radius_; y <= row + radius_; ++y) {
      const size_t slot = static_cast<size_t>((y + 2 * radius_ + 1) % (2 * radius_ + 1));
      float* to = data_.data() + slot * stride_ + kMaxRadius;
      if (y > filled_) {
        if (y >= 0 && y < map_.height) {
          std::copy_n(map_.value + static_cast<size_t>(y) * static_cast<size_t>(map_.width),
                      map_.width, to);
        } else {
          std::fill_n(to, map_.width, 0.0f);
        }
        filled_ = y;
      }
      rows[y - row + radius_] = to;
    }
  }

 private:
  const Map map_;
  const int radius_;
  const size_t stride_;
  std::vector<float> data_;
  int filled_ = -1000000;
};

// The plane through the samples, as it stands at their centre: how far it lies from the centre's
// value, and its slopes a sample. All 0 where too few samples agree, or all lie on a line.
struct Plane {
  VF moved, p, q;
};

HWY_INLINE Plane FitPlane(const Sums& s) {
  const DF df;
  const VF mean_u = hn::Div(s.u, s.n), mean_v = hn::Div(s.v, s.n), mean_d = hn::Div(s.d, s.n);
  const VF uu = hn::Sub(s.uu, hn::Mul(s.u, mean_u)), uv = hn::Sub(s.uv, hn::Mul(s.u, mean_v));
  const VF vv = hn::Sub(s.vv, hn::Mul(s.v, mean_v));
  const VF ud = hn::Sub(s.ud, hn::Mul(s.u, mean_d)), vd = hn::Sub(s.vd, hn::Mul(s.v, mean_d));
  const VF det = hn::Sub(hn::Mul(uu, vv), hn::Mul(uv, uv));
  const auto fits = hn::And(hn::Ge(s.n, hn::Set(df, kMinSupport)), hn::Gt(det, hn::Set(df, 0.5f)));
  const VF safe = hn::IfThenElse(fits, det, hn::Set(df, 1.0f));
  const VF p = hn::IfThenElseZero(fits, hn::Div(hn::Sub(hn::Mul(vv, ud), hn::Mul(uv, vd)), safe));
  const VF q = hn::IfThenElseZero(fits, hn::Div(hn::Sub(hn::Mul(uu, vd), hn::Mul(uv, ud)), safe));
  const VF moved = hn::Sub(mean_d, hn::Add(hn::Mul(p, mean_u), hn::Mul(q, mean_v)));
  return {hn::IfThenElseZero(fits, moved), p, q};
}

// Root mean square of the samples about the plane: what least squares leaves.
HWY_INLINE VF ScatterAbout(const Plane& plane, const Sums& s) {
  const DF df;
  const VF explained =
      hn::Add(hn::Mul(plane.moved, s.d), hn::Add(hn::Mul(plane.p, s.ud), hn::Mul(plane.q, s.vd)));
  const VF left = hn::Max(hn::Sub(s.dd, explained), hn::Zero(df));
  return hn::Sqrt(hn::Div(left, hn::Max(s.n, hn::Set(df, 1.0f))));
}

// Results of a row, a vector of each.
struct Block {
  HWY_ALIGN float value[16] = {}, slope_x[16] = {}, slope_y[16] = {}, scatter[16] = {};
  HWY_ALIGN uint8_t support[16] = {};

  void CopyTo(const Planes& planes, size_t at, size_t count) const {
    std::copy_n(value, count, planes.value + at);
    std::copy_n(slope_x, count, planes.slope_x + at);
    std::copy_n(slope_y, count, planes.slope_y + at);
    std::copy_n(scatter, count, planes.scatter + at);
    std::copy_n(support, count, planes.support + at);
  }
};

void FitRows(const Map& map, int begin, int end, int radius, float tolerance, float slope_scale,
             const Planes& planes) {
  const DF df;
  const hn::RebindToSigned<DF> di;
  const hn::Rebind<uint8_t, DF> du8;
  const int lanes = static_cast<int>(hn::Lanes(df));
  PaddedRows padded(map, radius);
  const float* rows[2 * kMaxRadius + 1];
  const Block missing;
  Block block;
  for (int b = begin; b < end; ++b) {
    padded.Around(b, rows);
    const size_t row = static_cast<size_t>(b) * static_cast<size_t>(map.width);
    for (int a = 0; a < map.width; a += lanes) {
      const VF center = hn::LoadU(df, rows[radius] + a);
      const auto there = hn::Gt(center, hn::Zero(df));
      const size_t count = static_cast<size_t>(std::min(lanes, map.width - a));
      if (hn::AllFalse(df, there)) {
        missing.CopyTo(planes, row + static_cast<size_t>(a), count);
        continue;
      }
      const Sums s = SumAround(rows, a, radius, center, hn::Set(df, tolerance));
      const Plane plane = FitPlane(s);
      const VF fitted = hn::Add(center, plane.moved);
      const VF scale = hn::Set(df, slope_scale);
      hn::Store(hn::IfThenElseZero(there, fitted), df, block.value);
      hn::Store(hn::Mul(plane.p, scale), df, block.slope_x);
      hn::Store(hn::Mul(plane.q, scale), df, block.slope_y);
      hn::Store(hn::IfThenElseZero(there, ScatterAbout(plane, s)), df, block.scatter);
      const auto n = hn::ConvertTo(di, hn::IfThenElseZero(there, s.n));
      hn::Store(hn::DemoteTo(du8, n), du8, block.support);
      block.CopyTo(planes, row + static_cast<size_t>(a), count);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace plane
}  // namespace colmap_seapoint
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace colmap_seapoint {
namespace plane {

HWY_EXPORT(FitRows);

void FitRows(const Map& map, int begin, int end, int radius, float tolerance, float slope_scale,
             const Planes& planes) {
  HWY_DYNAMIC_DISPATCH(FitRows)(map, begin, end, radius, tolerance, slope_scale, planes);
}

}  // namespace plane
}  // namespace colmap_seapoint
#endif  // HWY_ONCE
