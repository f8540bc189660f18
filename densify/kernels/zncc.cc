#include "densify/kernels/zncc.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "densify/kernels/zncc.cc"
#include "hwy/foreach_target.h"  // before highway.h: compiles the part below once a target
#include "hwy/highway.h"

// How it works. A vector's lanes are neighbouring windows of picture 2: each pixel of picture 1's
// window is multiplied with the pixels that lie there in all of them. With pixels centred on 0
// every sum is an integer that a float holds exactly.

HWY_BEFORE_NAMESPACE();
namespace colmap_seapoint {
namespace zncc {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using DF = hn::CappedTag<float, kMaxRun>;
using DI = hn::RebindToSigned<DF>;
using VF = hn::Vec<DF>;
using VI = hn::Vec<DI>;

constexpr int kColumns = 3 * kMaxRun;  // of all windows of a run together, in whole vectors
constexpr int kReferenceColumns = 2 * kMaxRun;

// Pixels as they come, less 128.
HWY_INLINE VF LoadPixels(const uint8_t* from) {
  const DF df;
  const DI di;
  const VI pixels = hn::PromoteTo(di, hn::LoadU(hn::Rebind<uint8_t, DF>(), from));
  return hn::ConvertTo(df, hn::Sub(pixels, hn::Set(di, 128)));
}

struct Sums {
  int32_t sum, scatter;  // scatter: n * sum of squares - sum^2
};

// The pixels of picture 1's window, row by row, 0 beyond its width.
template <int kSize>
Sums LoadReference(const GrayImage& picture, int x, int y, float* pixels) {
  const DF df;
  const int lanes = static_cast<int>(hn::Lanes(df));
  const size_t stride = picture.Stride();
  const uint8_t* source = picture.Row(y - kSize / 2) + x - kSize / 2;
  VF sum = hn::Zero(df), squares = hn::Zero(df);
  for (int row = 0; row < kSize; ++row, source += stride, pixels += kReferenceColumns) {
    for (int c = 0; c < kSize; c += lanes) {
      VF value = LoadPixels(source + c);
      if (c + lanes > kSize) {
        value = hn::IfThenElseZero(hn::FirstN(df, static_cast<size_t>(kSize - c)), value);
      }
      sum = hn::Add(sum, value);
      squares = hn::MulAdd(value, value, squares);
      hn::StoreU(value, df, pixels + c);
    }
  }
  const int32_t total = static_cast<int32_t>(hn::GetLane(hn::SumOfLanes(df, sum)));
  const int32_t total_squares = static_cast<int32_t>(hn::GetLane(hn::SumOfLanes(df, squares)));
  return {total, kSize * kSize * total_squares - total * total};
}

// The windows of picture 2 from pixel `source` (top left corner of the first) on: their pixels, and
// the sums of each column of them and of its squares.
struct Columns {
  HWY_ALIGN float pixels[kMaxWindow * kColumns];
  HWY_ALIGN float sum[kColumns], squares[kColumns];
};

template <int kSize>
HWY_INLINE void LoadColumns(const uint8_t* source, size_t stride, Columns* columns) {
  const DF df;
  const int lanes = static_cast<int>(hn::Lanes(df));
  for (int c = 0; c < kSize + kMaxRun - 1; c += lanes) {
    VF sum = hn::Zero(df), squares = hn::Zero(df);
    for (int row = 0; row < kSize; ++row) {
      const VF value = LoadPixels(source + static_cast<size_t>(row) * stride + c);
      sum = hn::Add(sum, value);
      squares = hn::MulAdd(value, value, squares);
      hn::StoreU(value, df, columns->pixels + row * kColumns + c);
    }
    hn::StoreU(sum, df, columns->sum + c);
    hn::StoreU(squares, df, columns->squares + c);
  }
}

// All ones where none of the windows' corners is 0.
template <int kSize>
HWY_INLINE hn::Mask<DF> HasCorners(const Columns& columns, int shift) {
  const DF df;
  const VF outside = hn::Set(df, -128.0f);
  const float* top = columns.pixels + shift;
  const float* bottom = top + (kSize - 1) * kColumns;
  return hn::And(
      hn::And(hn::Ne(hn::LoadU(df, top), outside), hn::Ne(hn::LoadU(df, top + kSize - 1), outside)),
      hn::And(hn::Ne(hn::LoadU(df, bottom), outside),
              hn::Ne(hn::LoadU(df, bottom + kSize - 1), outside)));
}

template <int kSize>
void ScoreRunOf(const GrayImage& picture1, int x1, int y1, const GrayImage& picture2, int x2,
                int y2, float* scores) {
  const DF df;
  const DI di;
  constexpr int n = kSize * kSize;
  HWY_ALIGN float reference[kMaxWindow * kReferenceColumns];
  const Sums of1 = LoadReference<kSize>(picture1, x1, y1, reference);
  if (of1.scatter < n * n) {  // a variance of 1 grey level squared
    std::fill_n(scores, kMaxRun, -1.0f);
    return;
  }
  Columns columns;
  LoadColumns<kSize>(picture2.Row(y2 - kSize / 2) + x2 - kSize / 2, picture2.Stride(), &columns);
  for (int shift = 0; shift < kMaxRun; shift += static_cast<int>(hn::Lanes(df))) {
    VF sum = hn::Zero(df), squares = sum, products0 = sum, products1 = sum;
    for (int c = 0; c < kSize; ++c) {
      sum = hn::Add(sum, hn::LoadU(df, columns.sum + shift + c));
      squares = hn::Add(squares, hn::LoadU(df, columns.squares + shift + c));
      for (int row = 0; row < kSize; ++row) {
        VF& products = row % 2 == 0 ? products0 : products1;
        products = hn::MulAdd(hn::Set(df, reference[row * kReferenceColumns + c]),
                              hn::LoadU(df, columns.pixels + row * kColumns + shift + c), products);
      }
    }
    const auto times_n = [&](VF v)
                             HWY_ATTR { return hn::Mul(hn::ConvertTo(di, v), hn::Set(di, n)); };
    const VI sum2 = hn::ConvertTo(di, sum);
    const VI scatter2 = hn::Sub(times_n(squares), hn::Mul(sum2, sum2));
    const VI covariance =
        hn::Sub(times_n(hn::Add(products0, products1)), hn::Mul(sum2, hn::Set(di, of1.sum)));
    const auto usable = hn::And(HasCorners<kSize>(columns, shift),
                                hn::RebindMask(df, hn::Gt(scatter2, hn::Set(di, n * n - 1))));
    const VF spread = hn::Sqrt(hn::Mul(hn::Set(df, static_cast<float>(of1.scatter)),
                                       hn::ConvertTo(df, hn::Max(scatter2, hn::Set(di, 1)))));
    const VF score = hn::Div(hn::ConvertTo(df, covariance), spread);
    hn::StoreU(hn::IfThenElse(usable, score, hn::Set(df, -1.0f)), df, scores + shift);
  }
}

void ScoreRun(const GrayImage& picture1, int x1, int y1, const GrayImage& picture2, int x2, int y2,
              int size, int count, float* scores) {
  HWY_ALIGN float all[kMaxRun];
  switch (size) {
    case 5:
      ScoreRunOf<5>(picture1, x1, y1, picture2, x2, y2, all);
      break;
    case 7:
      ScoreRunOf<7>(picture1, x1, y1, picture2, x2, y2, all);
      break;
    case 9:
      ScoreRunOf<9>(picture1, x1, y1, picture2, x2, y2, all);
      break;
    case 11:
      ScoreRunOf<11>(picture1, x1, y1, picture2, x2, y2, all);
      break;
    case 13:
      ScoreRunOf<13>(picture1, x1, y1, picture2, x2, y2, all);
      break;
    default:
      ScoreRunOf<15>(picture1, x1, y1, picture2, x2, y2, all);
      break;
  }
  std::copy_n(all, count, scores);
}

}  // namespace HWY_NAMESPACE
}  // namespace zncc
}  // namespace colmap_seapoint
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace colmap_seapoint {
namespace zncc {

HWY_EXPORT(ScoreRun);

void ScoreRun(const GrayImage& picture1, int x1, int y1, const GrayImage& picture2, int x2, int y2,
              int size, int count, float* scores) {
  HWY_DYNAMIC_DISPATCH(ScoreRun)
  (picture1, x1, y1, picture2, x2, y2, size, count, scores);
}

}  // namespace zncc
}  // namespace colmap_seapoint
#endif  // HWY_ONCE
