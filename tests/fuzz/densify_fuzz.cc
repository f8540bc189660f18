// Any bytes as a pair of tiny pictures, their cameras, poses, seeds, cells and options: no number
// of threads and no instruction set changes the result, and every point of it is a point.
//
// Input: numbers for all of that in turn (zeros when there are too few), then pixels. Picture 1
// shows a plane that picture 2 sees, so that something matches.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "densify/densify_pair.h"
#include "hwy/targets.h"
#include "tests/fuzz/require.h"

namespace colmap_seapoint {
namespace {

class Numbers {
 public:
  Numbers(const uint8_t* data, size_t size) : data_(data), size_(size) {}
  int Byte() { return next_ < size_ ? data_[next_++] : 0; }
  int Below(int bound) { return Byte() % bound; }
  double Between(double low, double high) { return low + (high - low) * Byte() / 255; }
  // Any byte of what is left, over again when there are too few.
  uint8_t Pixel(size_t index) const {
    return next_ < size_ ? data_[next_ + index % (size_ - next_)]
                         : static_cast<uint8_t>(index * 37);
  }

 private:
  const uint8_t* data_;
  const size_t size_;
  size_t next_ = 0;
};

Camera AnyCamera(Numbers* numbers) {
  const CameraModelInfo* info = nullptr;
  for (int id = numbers->Below(32); info == nullptr; id = (id + 1) % 32) info = FindCameraModel(id);
  const int width = 12 + numbers->Below(140), height = 12 + numbers->Below(140);
  // From 130 degrees of view to a few.
  Camera camera = MakeCamera(
      info->model, width * std::exp(numbers->Between(-1.5, numbers->Below(3) ? 0.5 : 2.3)), width,
      height);
  if (info->model == CameraModel::kEquirectangular) return camera;
  const size_t first = info->has_single_focal ? 1 : 2;
  camera.params[first] += numbers->Between(-0.2, 0.2) * width;
  camera.params[first + 1] += numbers->Between(-0.2, 0.2) * height;
  const double distortion = numbers->Below(6) == 0 ? 2 : 0.05;
  for (size_t k = first + 2; k < camera.params.size(); ++k) {
    camera.params[k] = numbers->Between(-distortion, distortion);
  }
  return camera;
}

View AnyView(int image_idx, double x, Numbers* numbers) {
  View view{image_idx, AnyCamera(numbers), {}};
  const double turn = numbers->Below(8) == 0 ? 3 : 0.1;  // radians
  const Eigen::Vector3d axis(numbers->Between(-1, 1), numbers->Between(-1, 1),
                             numbers->Between(-1, 1) + 1e-3);
  view.cam_from_world.rotation =
      Eigen::Quaterniond(Eigen::AngleAxisd(numbers->Between(-turn, turn), axis.normalized()));
  const Eigen::Vector3d center(x, numbers->Between(-0.1, 0.1), numbers->Between(-0.1, 0.1));
  view.cam_from_world.translation = -(view.cam_from_world.rotation * center);
  return view;
}

// The pixel of picture 2 that shows what a pixel of picture 1 does, on the plane z = depth.
std::optional<Eigen::Vector2d> OnPlane(const PairInput& input, const Eigen::Vector2d& pixel1,
                                       double depth) {
  const auto ray = input.view1.camera.CamFromImg(pixel1);
  if (!ray) return std::nullopt;
  const Rigid3d world_from_cam = input.view1.cam_from_world.Inverse();
  const Eigen::Vector3d direction = world_from_cam.rotation * ray->homogeneous();
  const double t = (depth - world_from_cam.translation.z()) / direction.z();
  if (!(t > 0 && t < 1e6)) return std::nullopt;
  return input.view2.camera.ImgFromCam(input.view2.cam_from_world *
                                       (world_from_cam.translation + t * direction));
}

struct Case {
  PairInput input;
  PartialDensificationOptions options;
  Picture picture1;
  GrayImage luma2;
};

void AnyOptions(Numbers* numbers, PartialDensificationOptions* options) {
  options->step = numbers->Below(9);
  options->window_size = 5 + 2 * numbers->Below(6);
  options->min_zncc = numbers->Below(3) == 0 ? numbers->Below(2) : numbers->Between(0, 1);
  options->max_expansion = numbers->Between(0.001, 1);
}

void AnyCells(Numbers* numbers, Case* c) {
  const Camera& camera = c->input.view1.camera;
  c->input.known.grid = CellsOf(camera, c->options.step);
  if (numbers->Below(2))
    c->input.known.grid = CellGrid(camera.width, camera.height, 1 + numbers->Below(60));
  if (numbers->Below(4) == 0) c->input.mode = DensificationMode::kComplete;
  const int kinds = numbers->Below(4);
  const double range = std::exp(numbers->Between(-8, 8));
  for (size_t cell = 0; cell < c->input.known.grid.Size(); ++cell) {
    const unsigned noise = static_cast<unsigned>((cell + 1) * 2654435761u) >> 24;
    if (kinds & 1) c->input.known.closed.push_back(noise % 5 == 0);
    if (kinds & 2)
      c->input.known.covered_range.push_back(noise % 3 ? 0 : static_cast<float>(range));
  }
}

void AnyPictures(double depth, Numbers* numbers, Case* c) {
  const Camera &camera1 = c->input.view1.camera, &camera2 = c->input.view2.camera;
  c->luma2 = GrayImage(camera2.width, camera2.height);
  for (size_t i = 0; i < c->luma2.data.size(); ++i) c->luma2.data[i] = numbers->Pixel(i);
  c->picture1.luma = GrayImage(camera1.width, camera1.height);
  for (int y = 0; y < camera1.height; ++y) {
    for (int x = 0; x < camera1.width; ++x) {
      const auto pixel2 = OnPlane(c->input, {x + 0.5, y + 0.5}, depth);
      const bool seen = pixel2 && camera2.InImage(*pixel2);
      const size_t index = static_cast<size_t>(y * camera1.width + x);
      c->picture1.luma.At(x, y) =
          seen ? c->luma2.At(std::min(static_cast<int>(pixel2->x()), camera2.width - 1),
                             std::min(static_cast<int>(pixel2->y()), camera2.height - 1))
               : numbers->Pixel(index);
    }
  }
}

void AnySeeds(double depth, Numbers* numbers, Case* c) {
  const Camera& camera = c->input.view1.camera;
  const int num_seeds = 6 + numbers->Below(60);
  for (int s = 0; s < num_seeds; ++s) {
    const Eigen::Vector2d pixel1(numbers->Between(-5, camera.width + 5),
                                 numbers->Between(-5, camera.height + 5));
    const double wrong = numbers->Below(8) == 0 ? 1.5 : 1;
    const auto pixel2 = OnPlane(c->input, pixel1, wrong * depth);
    if (pixel2 && pixel2->norm() < 1e5) c->input.seeds.push_back({pixel1, *pixel2});
  }
}

void RequireSane(const Case& c, const PairResult& result) {
  FUZZ_REQUIRE(result.failure.empty() || result.cloud.points.empty());
  FUZZ_REQUIRE(result.num_failed_seeds <= result.num_seeds);
  FUZZ_REQUIRE(result.failure.empty() ? result.filled.size() == c.input.known.grid.Size() : true);
  for (const float share : result.filled) FUZZ_REQUIRE(share >= 0 && share <= 1);
  for (const float disparity : result.partial.disparity) {
    FUZZ_REQUIRE(disparity >= 0 && disparity < 1e6f);
  }
  for (const DensePoint& point : result.cloud.points) {
    FUZZ_REQUIRE(point.xyz.allFinite());
    FUZZ_REQUIRE(std::abs(point.normal.norm() - 1) < 1e-4f);
  }
  for (const SurfacePatch& patch : result.footprint.patches) {
    FUZZ_REQUIRE(patch.center.allFinite() && std::isfinite(patch.size));
  }
}

void RequireSame(const PairResult& a, const PairResult& b) {
  FUZZ_REQUIRE(a.failure == b.failure);
  FUZZ_REQUIRE(a.partial.disparity == b.partial.disparity && a.partial.score == b.partial.score);
  FUZZ_REQUIRE(a.filled == b.filled && a.num_failed_seeds == b.num_failed_seeds);
  FUZZ_REQUIRE(a.cloud.points.size() == b.cloud.points.size());
  for (size_t i = 0; i < a.cloud.points.size(); ++i) {
    const DensePoint &p = a.cloud.points[i], &q = b.cloud.points[i];
    FUZZ_REQUIRE(p.xyz == q.xyz && p.normal == q.normal && p.rgb == q.rgb &&
                 p.confidence == q.confidence);
  }
}

}  // namespace
}  // namespace colmap_seapoint

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace colmap_seapoint;  // NOLINT
  Numbers numbers(data, size);
  Case c;
  AnyOptions(&numbers, &c.options);
  c.input.view1 = AnyView(0, 0, &numbers);
  c.input.view2 = AnyView(1, numbers.Between(-0.5, 0.5), &numbers);
  const double depth = numbers.Between(0.3, 4);
  AnyCells(&numbers, &c);
  AnySeeds(depth, &numbers, &c);
  AnyPictures(depth, &numbers, &c);
  c.input.picture1 = &c.picture1;
  c.input.luma2 = &c.luma2;

  const PairResult one = DensifyPair(c.input, c.options, 1);
  RequireSane(c, one);
  RequireSame(one, DensifyPair(c.input, c.options, 3));
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    RequireSame(one, DensifyPair(c.input, c.options, 1));
  }
  hwy::SetSupportedTargetsForTest(0);
  return 0;
}
