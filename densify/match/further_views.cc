#include "densify/match/further_views.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "colmap_seapoint/base/parallel.h"
#include "densify/kernels/patch_kernels.h"
#include "densify/match/hidden_samples.h"

namespace colmap_seapoint {

namespace {

constexpr int kBlock = 8;         // pixels: what a map is linear in, at least
constexpr double kReach = 1;      // pixels of disparity around its own, likewise
constexpr double kDelta = 4;      // pixels between the places that a map's slopes are taken from
constexpr double kMaxScale = 2;   // of the further picture against picture 1, either way
constexpr double kMaxMove = 1.5;  // pixels of picture 1 that the gradient can tell
constexpr double kNear = 0.15;    // pixels: after so small a move nobody looks again
constexpr double kLeastNoise = 0.03;                 // pixels: no picture measures better
constexpr double kAgrees = 0.7, kContradicts = 0.5;  // correlation
constexpr double kMinFacing = 0.3;  // cosine of the angle between normal and ray, of a witness
constexpr double kMaxAside = 1.5;   // its angle to the nearer of the pair's rays, of their parallax
constexpr double kLeastTexture = 1;      // variance of the grey values of a patch with texture
constexpr double kLeastGradient = 1e-3;  // squared, a pixel of a step, against that variance
constexpr double kSure = 2;              // deviations that noise alone does not move a patch

// Of a contradicted sample's deviation: so unsure, it is left to other pairs as long as there are
// any that may measure it.
constexpr float kDoubt = 4;

double AngleBetween(const Eigen::Vector3d& unit1, const Eigen::Vector3d& unit2) {
  return 2 * std::asin(std::min(1.0, 0.5 * (unit1 - unit2).norm()));
}

struct Sample {
  double x, y;  // rect pixels, picture 1
  double disparity, slope_x, slope_y;
};

// What a further picture says of a sample.
struct Opinion {
  double disparity = 0;  // 0: none
  double deviation = 0;  // of it, rect pixels
  bool contradicts = false;
};

// Sum of the products of two quantities of a patch, each less its mean.
double Centered(int32_t products, double sum1, double sum2) {
  return products - sum1 * sum2 / patch::kPixels;
}

bool HasTexture(const patch::Sums& sums) {
  return Centered(sums.gray_gray, sums.gray, sums.gray) > kLeastTexture * patch::kPixels;
}

// How alike a patch and its place in another picture are, and how far it must move, in units of
// `step` (template pixels), to be most alike.
struct Likeness {
  double score = 0;  // correlation before the move
  double move = 0, deviation = std::numeric_limits<double>::infinity();
};

// Of a patch with texture. `num_seen`: pixels of the other picture that the patch covers, at most
// its own. Without a gradient along the step, the deviation says that the move is not known.
Likeness Liken(const patch::Sums& s, const Eigen::Vector2d& step, double num_seen) {
  Likeness likeness;
  const double spread = Centered(s.gray_gray, s.gray, s.gray);
  const double other_spread = Centered(s.other_other, s.other, s.other);
  const double common = Centered(s.gray_other, s.gray, s.other);
  if (!(other_spread > 0 && common > 0)) return likeness;
  likeness.score = common / std::sqrt(spread * other_spread);
  // The sums' differences are twice the gradient.
  const Eigen::Vector2d half = step / 2;
  const Eigen::Vector2d with_gray(Centered(s.gray_across, s.gray, s.across),
                                  Centered(s.gray_down, s.gray, s.down));
  const Eigen::Vector2d with_other(Centered(s.across_other, s.across, s.other),
                                   Centered(s.down_other, s.down, s.other));
  const double across_down = Centered(s.across_down, s.across, s.down);
  Eigen::Matrix2d gradient;
  gradient << Centered(s.across_across, s.across, s.across), across_down, across_down,
      Centered(s.down_down, s.down, s.down);
  const double power = half.dot(gradient * half);
  if (!(power > kLeastGradient * spread * step.squaredNorm())) return likeness;
  likeness.move = half.dot(with_gray - common / other_spread * with_other) / power;
  // As that of tile::Match: what the two differ in is noise of its own in each pixel seen.
  likeness.deviation =
      std::sqrt(2 * std::max(0.0, 1 - likeness.score) * spread / (num_seen * power));
  return likeness;
}

// Where a further picture shows what lies around a sample, linear in place and disparity.
struct LocalMap {
  double x = 0, y = 0, disparity = -1;     // rect pixels; around these
  Eigen::Vector2d at, across, down, pace;  // pixels; a pixel of x, y, disparity
  bool is_shown = false;                   // within the picture; else only the first three hold
  bool is_witness = false;                 // whose disagreement counts
};

class FurtherPicture {
 public:
  FurtherPicture(const PairGeometry& geometry, const FurtherView& further)
      : geometry_(geometry),
        camera_(further.view.camera),
        luma_(*further.luma),
        mask_(further.mask),
        cam_from_rect_(further.view.cam_from_world.rotation.toRotationMatrix() *
                       geometry.world_from_rect),
        origin_(further.view.cam_from_world * geometry.center1) {}

  // `map` is lent from sample to sample of a block and made anew where it does not hold.
  Opinion Judge(const patch::Template& of, const patch::Sums& template_sums, const Sample& sample,
                LocalMap* map) const {
    if (!(std::abs(sample.disparity - map->disparity) <= kReach)) *map = MapAround(sample);
    if (!map->is_shown) return {};
    const Eigen::Vector2d here = map->at + (sample.x - map->x) * map->across +
                                 (sample.y - map->y) * map->down +
                                 (sample.disparity - map->disparity) * map->pace;
    Eigen::Matrix2d axes;  // from template pixels, along the surface
    axes << map->across + sample.slope_x * map->pace, map->down + sample.slope_y * map->pace;
    const double scale = std::abs(axes.determinant());
    if (!(scale > 1 / (kMaxScale * kMaxScale) && scale < kMaxScale * kMaxScale)) return {};
    return Compare(of, template_sums, here, axes, *map, sample.disparity);
  }

 private:
  std::optional<Eigen::Vector2d> Show(double x, double y, double disparity) const {
    if (!(disparity > 0)) return std::nullopt;
    return camera_.ImgFromCam(cam_from_rect_ * geometry_.PointInRect(x, y, disparity) + origin_);
  }

  LocalMap MapAround(const Sample& sample) const {
    LocalMap map;
    map.x = sample.x;
    map.y = sample.y;
    map.disparity = sample.disparity;
    const auto at = Show(sample.x, sample.y, sample.disparity);
    if (!at || !camera_.InImage(*at)) return map;
    const auto across = Show(sample.x + kDelta, sample.y, sample.disparity);
    const auto down = Show(sample.x, sample.y + kDelta, sample.disparity);
    const auto nearer = Show(sample.x, sample.y, sample.disparity + 1);
    if (!across || !down || !nearer) return map;
    map.at = *at;
    map.across = (*across - *at) / kDelta;
    map.down = (*down - *at) / kDelta;
    map.pace = *nearer - *at;
    map.is_shown = true;
    map.is_witness = IsWitness(sample);
    return map;
  }

  bool IsWitness(const Sample& sample) const {
    const Eigen::Vector3d point = geometry_.PointInRect(sample.x, sample.y, sample.disparity);
    const Eigen::Vector3d normal = geometry_.NormalInRect(sample.x, sample.y, sample.disparity,
                                                          sample.slope_x, sample.slope_y);
    const Eigen::Vector3d ray1 = point.normalized();
    const Eigen::Vector3d ray2 = (point - Eigen::Vector3d(geometry_.baseline, 0, 0)).normalized();
    const Eigen::Vector3d ray = (point + cam_from_rect_.transpose() * origin_).normalized();
    return -normal.dot(ray) > kMinFacing &&
           std::min(AngleBetween(ray, ray1), AngleBetween(ray, ray2)) <
               kMaxAside * AngleBetween(ray1, ray2);
  }

  Opinion Compare(const patch::Template& of, const patch::Sums& template_sums,
                  const Eigen::Vector2d& here, const Eigen::Matrix2d& axes, const LocalMap& map,
                  double predicted) const {
    const Opinion against{0, 0, map.is_witness};
    const Eigen::Vector2d step = axes.inverse() * map.pace;
    const double pixels_a_unit = step.norm();
    const double num_seen = patch::kPixels * std::min(1.0, std::abs(axes.determinant()));
    double move = 0;
    Likeness likeness;
    for (int look = 0; look < 2; ++look) {
      patch::Sums sums = template_sums;
      if (!SumAt(here + move * map.pace, axes, of, &sums)) return {};
      likeness = Liken(sums, step, num_seen);
      move += likeness.move;
      if (std::abs(move) * pixels_a_unit >= kMaxMove) {  // maybe for want of a gradient
        return std::abs(move) > kSure * likeness.deviation ? against : Opinion();
      }
      if (std::abs(likeness.move) * pixels_a_unit < kNear) break;
    }
    if (likeness.score < kContradicts) return against;
    if (likeness.score < kAgrees || std::isinf(likeness.deviation)) return {};
    return {predicted + move, std::hypot(likeness.deviation, kLeastNoise / pixels_a_unit), false};
  }

  // Whether the mask hides the middle of the patch, placed there, or one of its corners.
  bool TouchesMask(const Eigen::Vector2d& at, const Eigen::Matrix2d& axes) const {
    if (mask_ == nullptr || mask_->Empty()) return false;
    for (const double down : {-1.0, 0.0, 1.0}) {
      for (const double across : {-1.0, 0.0, 1.0}) {
        const Eigen::Vector2d place = at + axes * (patch::kBefore * Eigen::Vector2d(across, down));
        if (IsHidden(mask_, place.x(), place.y())) return true;
      }
    }
    return false;
  }

  // False where the patch, placed there, reaches beyond the picture or into what its mask hides.
  bool SumAt(const Eigen::Vector2d& at, const Eigen::Matrix2d& axes, const patch::Template& of,
             patch::Sums* sums) const {
    // To the corner of a pixel more than the patch has, and to the centre of the picture's second
    // pixel, from where bilinear weights are there on any side (patch::SumOther).
    const Eigen::Vector2d reach =
        (patch::kBefore + 1) * axes.cwiseAbs().rowwise().sum() + Eigen::Vector2d(1.5, 1.5);
    if (!(at.x() > reach.x() && at.y() > reach.y() && at.x() < luma_.width - reach.x() &&
          at.y() < luma_.height - reach.y())) {
      return false;
    }
    if (TouchesMask(at, axes)) return false;
    const auto fixed = [](double value) { return static_cast<int32_t>(std::lround(value)); };
    const Eigen::Matrix2d scaled = 65536 * axes;
    patch::SumOther(
        of, luma_,
        {fixed(65536 * (at.x() - 0.5)), fixed(65536 * (at.y() - 0.5)), fixed(scaled(0, 0)),
         fixed(scaled(1, 0)), fixed(scaled(0, 1)), fixed(scaled(1, 1))},
        sums);
    return true;
  }

  const PairGeometry& geometry_;
  const Camera& camera_;
  const GrayImage& luma_;
  const GrayImage* const mask_;
  const Eigen::Matrix3d cam_from_rect_;
  const Eigen::Vector3d origin_;  // of the rect frame, in the camera's
};

// Samples of a block, one after the other, so that maps serve for many.
class BlockJudge {
 public:
  BlockJudge(const RectPicture& picture1, const PartialSurface& surface,
             const std::vector<FurtherPicture>& pictures, PartialDisparity* measured)
      : picture1_(picture1),
        surface_(surface),
        pictures_(pictures),
        measured_(measured),
        maps_(pictures.size()) {}

  void Run(int begin_a, int begin_b, int end_a, int end_b) {
    std::fill(maps_.begin(), maps_.end(), LocalMap());
    const SampleGrid& grid = surface_.grid;
    for (int b = begin_b; b < end_b; ++b) {
      for (int a = begin_a; a < end_a; ++a) {
        const size_t idx =
            static_cast<size_t>(b) * static_cast<size_t>(grid.width) + static_cast<size_t>(a);
        if (surface_.disparity[idx] <= 0 ||
            !patch::MakeTemplate(picture1_.gray, grid.PixelX(a), grid.PixelY(b), &template_)) {
          continue;
        }
        Judge({grid.RectX(a), grid.RectY(b), surface_.disparity[idx], surface_.slope_x[idx],
               surface_.slope_y[idx]},
              idx);
      }
    }
  }

 private:
  void Judge(const Sample& sample, size_t idx) {
    const patch::Sums sums = patch::SumTemplate(template_);
    if (!HasTexture(sums)) return;
    const double own = std::hypot(static_cast<double>(measured_->deviation[idx]), kLeastNoise);
    double weight = 1 / (own * own), sum = weight * static_cast<double>(measured_->disparity[idx]);
    int num_agree = 0, num_contradict = 0;
    for (size_t i = 0; i < pictures_.size(); ++i) {
      const Opinion opinion = pictures_[i].Judge(template_, sums, sample, &maps_[i]);
      num_contradict += opinion.contradicts;
      if (opinion.disparity <= 0) continue;
      ++num_agree;
      const double weight_here = 1 / (opinion.deviation * opinion.deviation);
      weight += weight_here;
      sum += weight_here * opinion.disparity;
    }
    if (num_contradict > num_agree) {
      measured_->deviation[idx] *= kDoubt;
    } else if (num_agree > 0) {
      measured_->disparity[idx] = static_cast<float>(sum / weight);
      // Never less sure than alone, which may be less than kLeastNoise.
      measured_->deviation[idx] =
          std::min(measured_->deviation[idx], static_cast<float>(1 / std::sqrt(weight)));
    }
  }

  const RectPicture& picture1_;
  const PartialSurface& surface_;
  const std::vector<FurtherPicture>& pictures_;
  PartialDisparity* const measured_;
  std::vector<LocalMap> maps_;
  patch::Template template_;
};

}  // namespace

void MeasureInFurtherViews(const PairGeometry& geometry, const RectPicture& picture1,
                           const PartialSurface& surface, const std::vector<FurtherView>& further,
                           int num_threads, PartialDisparity* measured) {
  std::vector<FurtherPicture> pictures;
  for (const FurtherView& view : further) {
    // Places in larger pictures do not fit 16 bits and a fraction.
    if (std::max(view.luma->width, view.luma->height) < 32768) {
      pictures.emplace_back(geometry, view);
    }
  }
  if (pictures.empty()) return;
  const SampleGrid& grid = surface.grid;
  const int block = std::max(1, kBlock / grid.step);  // samples
  ParallelFor(num_threads, (grid.height + block - 1) / block, [&](int64_t band) {
    BlockJudge judge(picture1, surface, pictures, measured);
    const int b = static_cast<int>(band) * block;
    for (int a = 0; a < grid.width; a += block) {
      judge.Run(a, b, std::min(grid.width, a + block), std::min(grid.height, b + block));
    }
  });
}

}  // namespace colmap_seapoint
