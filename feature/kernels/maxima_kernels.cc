#include "feature/kernels/maxima_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "feature/kernels/maxima_kernels.cc"
#include "hwy/foreach_target.h"  // before highway.h: compiles the part below once a target
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace colmap_seapoint {
namespace maxima {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

// These run on machines without vector code, and the vector code must equal them.
size_t FindPeaks(const float* above, const float* here, const float* below, int begin, int end,
                 int32_t* columns) {
  size_t num_columns = 0;
  for (int x = begin; x < end; ++x) {
    const float value = here[x];
    if (!(value > 0) || value <= here[x - 1] || value < here[x + 1]) continue;
    if (value <= above[x - 1] || value <= above[x] || value <= above[x + 1]) continue;
    if (value < below[x - 1] || value < below[x] || value < below[x + 1]) continue;
    columns[num_columns++] = x;
  }
  return num_columns;
}

bool IsGreatest(const float* const* rows, int radius, int x) {
  const float value = rows[radius][x];
  for (int v = 0; v <= 2 * radius; ++v) {
    for (int u = x - radius; u <= x + radius; ++u) {
      if (rows[v][u] > value) return false;
      if (rows[v][u] == value && (v < radius || (v == radius && u < x))) return false;
    }
  }
  return true;
}

#else

size_t FindPeaks(const float* above, const float* here, const float* below, int begin, int end,
                 int32_t* columns) {
  const hn::ScalableTag<float> df;
  const hn::RebindToSigned<decltype(df)> di;
  const int num_lanes = static_cast<int>(hn::Lanes(df));
  const auto zero = hn::Zero(df);
  size_t num_columns = 0;
  for (int x = begin; x < end; x += num_lanes) {
    const auto value = hn::LoadU(df, here + x);
    const auto before = hn::Max(hn::Max(hn::LoadU(df, above + x - 1), hn::LoadU(df, above + x)),
                                hn::Max(hn::LoadU(df, above + x + 1), hn::LoadU(df, here + x - 1)));
    const auto after = hn::Max(hn::Max(hn::LoadU(df, below + x - 1), hn::LoadU(df, below + x)),
                               hn::Max(hn::LoadU(df, below + x + 1), hn::LoadU(df, here + x + 1)));
    auto peaks = hn::And(hn::Gt(value, hn::Max(before, zero)), hn::Ge(value, after));
    if (HWY_LIKELY(hn::AllFalse(df, peaks))) continue;
    if (x + num_lanes > end) {
      peaks = hn::And(peaks, hn::FirstN(df, static_cast<size_t>(end - x)));
    }
    num_columns +=
        hn::CompressStore(hn::Iota(di, x), hn::RebindMask(di, peaks), di, columns + num_columns);
  }
  return num_columns;
}

// The greatest of a row from `at` on; zeros fill up what is left of the last vector.
template <class D>
HWY_INLINE hn::Vec<D> GreatestOf(D df, const float* at, size_t count, hn::Mask<D> last) {
  const size_t num_lanes = hn::Lanes(df);
  auto greatest = hn::Zero(df);
  for (; count > num_lanes; at += num_lanes, count -= num_lanes) {
    greatest = hn::Max(greatest, hn::LoadU(df, at));
  }
  return hn::Max(greatest, hn::IfThenElseZero(last, hn::LoadU(df, at)));
}

bool IsGreatest(const float* const* rows, int radius, int x) {
  const hn::ScalableTag<float> df;
  const float* here = rows[radius];
  for (int d = 1; d <= radius; ++d) {
    if (here[x - d] >= here[x] || here[x + d] > here[x]) return false;
  }
  const size_t count = 2 * static_cast<size_t>(radius) + 1;
  const auto last = hn::FirstN(df, (count - 1) % hn::Lanes(df) + 1);
  const auto value = hn::Set(df, here[x]);
  for (int d = 1; d <= radius; ++d) {  // the nearest rows are the likeliest to have a greater one
    const auto before = GreatestOf(df, rows[radius - d] + x - radius, count, last);
    const auto after = GreatestOf(df, rows[radius + d] + x - radius, count, last);
    if (!hn::AllFalse(df, hn::Or(hn::Ge(before, value), hn::Gt(after, value)))) return false;
  }
  return true;
}

#endif  // HWY_TARGET

size_t KeepGreatest(const float* const* rows, int radius, int32_t* columns, size_t num_columns) {
  size_t num_kept = 0;
  for (size_t i = 0; i < num_columns; ++i) {
    if (IsGreatest(rows, radius, columns[i])) columns[num_kept++] = columns[i];
  }
  return num_kept;
}

}  // namespace HWY_NAMESPACE
}  // namespace maxima
}  // namespace colmap_seapoint
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace colmap_seapoint {
namespace maxima {

HWY_EXPORT(FindPeaks);
HWY_EXPORT(KeepGreatest);

size_t FindPeaks(const float* above, const float* here, const float* below, int begin, int end,
                 int32_t* columns) {
  return HWY_DYNAMIC_DISPATCH(FindPeaks)(above, here, below, begin, end, columns);
}

size_t KeepGreatest(const float* const* rows, int radius, int32_t* columns, size_t num_columns) {
  return HWY_DYNAMIC_DISPATCH(KeepGreatest)(rows, radius, columns, num_columns);
}

}  // namespace maxima
}  // namespace colmap_seapoint
#endif  // HWY_ONCE
