#include "examples/survey/control.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "examples/survey/scene/noise.h"
#include "examples/survey/visibility.h"

namespace colmap_seapoint {
namespace {

// Keeps the random numbers of different purposes apart.
enum Purpose : int64_t { kMarks = 1, kPositions = 2, kOutliers = 3, kDirections = 4 };

// Standard deviation of Bell() is 1 within 0.1 %.
double Noise(const ControlOptions& options, Purpose purpose, int64_t index) {
  const auto seed = static_cast<uint64_t>(options.seed);
  return static_cast<double>(Bell(Hash(seed, purpose, index)));
}

template <typename... Values>
std::string Format(const char* format, Values... values) {
  char text[256];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

std::array<SurfaceHit, 2> BarEnds(const SurveyTruth& truth, double length) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const PosedImage& image : truth.model.images) {
    middle +=
        image.cam_from_world.OriginInSource() / static_cast<double>(truth.model.images.size());
  }
  middle = truth.surface.InGround(middle);
  std::array<SurfaceHit, 2> ends;
  for (size_t i = 0; i < 2; ++i) {
    const double x = middle.x() + (i == 0 ? -0.5 : 0.5) * length;
    ends[i] = truth.surface.GroundAt(x, middle.y());
  }
  return ends;
}

std::string TargetRows(const SurveyTruth& truth, const ControlOptions& options,
                       const std::string& name, const SurfaceHit& end, int64_t first_index) {
  const SurfaceVisibility visibility(truth);
  std::string rows;
  int num_marks = 0;
  for (size_t i = 0; i < truth.model.images.size(); ++i) {
    const auto pixel = visibility.Project(i, end.xyz, end.normal);
    if (!pixel) continue;
    const int64_t index = first_index + 2 * static_cast<int64_t>(i);
    const Camera& camera = truth.model.cameras.at(truth.model.images[i].camera_id);
    const double x = pixel->x() + options.pixel_noise * Noise(options, kMarks, index);
    const double y = pixel->y() + options.pixel_noise * Noise(options, kMarks, index + 1);
    if (!camera.InImage({x, y})) continue;
    rows += name + "," + truth.model.images[i].name + Format(",%.3f,%.3f\n", x, y);
    ++num_marks;
  }
  if (num_marks >= 2) return rows;
  throw Error("the survey",
              "no two of its pictures see the end of a bar at " +
                  Format("%.2f, %.2f", end.xyz.x(), end.xyz.y()),
              "choose a shorter --bar_length");
}

std::vector<bool> Outliers(size_t count, const ControlOptions& options) {
  std::vector<size_t> order(count);
  std::iota(order.begin(), order.end(), size_t{0});
  const auto key = [&](size_t i) {
    return Hash(static_cast<uint64_t>(options.seed), kOutliers, static_cast<int64_t>(i));
  };
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return key(a) < key(b); });
  order.resize(
      static_cast<size_t>(std::lround(options.outlier_share * static_cast<double>(count))));
  std::vector<bool> is_outlier(count, false);
  for (const size_t i : order) is_outlier[i] = true;
  return is_outlier;
}

}  // namespace

std::string CheckControlOptions(const ControlOptions& o) {
  if (!(o.bar_length > 0)) return "bar_length must be above 0";
  if (!(o.pixel_noise >= 0)) return "pixel_noise must be 0 or above";
  if (!(o.position_noise >= 0)) return "position_noise must be 0 or above";
  if (!(o.outlier_share >= 0 && o.outlier_share <= 1)) return "outlier_share must be within 0..1";
  return "";
}

ControlTables MakeControl(const SurveyTruth& truth, const ControlOptions& options) {
  ControlTables tables;
  const auto ends = BarEnds(truth, options.bar_length);
  tables.bars = "name1,name2,length_m,sigma_m\n" +
                Format("bar_a,bar_b,%.6f,0.001\n", (ends[1].xyz - ends[0].xyz).norm());
  tables.targets = "target,image,x,y\n" + TargetRows(truth, options, "bar_a", ends[0], 0) +
                   TargetRows(truth, options, "bar_b", ends[1], 1000000);
  tables.positions = "image,x,y,z\n";
  const auto is_outlier = Outliers(truth.model.images.size(), options);
  for (size_t i = 0; i < truth.model.images.size(); ++i) {
    const PosedImage& image = truth.model.images[i];
    Eigen::Vector3d position = image.cam_from_world.OriginInSource();
    Eigen::Vector3d direction;
    for (int axis = 0; axis < 3; ++axis) {
      const int64_t index = 3 * static_cast<int64_t>(i) + axis;
      position[axis] += options.position_noise * Noise(options, kPositions, index);
      direction[axis] = Noise(options, kDirections, index);
    }
    if (is_outlier[i]) position += options.outlier_size * direction.normalized();
    tables.positions +=
        image.name + Format(",%.4f,%.4f,%.4f\n", position.x(), position.y(), position.z());
  }
  return tables;
}

}  // namespace colmap_seapoint
