#include "examples/benchmarks/poses/observation_errors.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <unordered_map>
#include <utility>

#include "colmap_seapoint/base/median.h"
#include "colmap_seapoint/georeference/triangulate_target.h"

namespace colmap_seapoint {
namespace {

constexpr double kMaxTriangulationError = 4;  // pixels
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Longer tracks are thinned: finding the place takes the cube of the number of views.
constexpr size_t kMaxViews = 24;

struct Place {
  int sequence_idx;
  const PosedImage* exact;
};

using Places = std::unordered_map<uint32_t, Place>;  // by the model's image_id

Places FindPlaces(const SparseModel& truth, const SparseModel& model) {
  std::map<std::string, int> idx_of;
  for (size_t i = 0; i < truth.images.size(); ++i) {
    idx_of[truth.images[i].name] = static_cast<int>(i);
  }
  Places places;
  for (const PosedImage& image : model.images) {
    const auto found = idx_of.find(image.name);
    if (found == idx_of.end()) continue;
    places[image.image_id] = {found->second, &truth.images[static_cast<size_t>(found->second)]};
  }
  return places;
}

// Across the line that the other ray draws, in pixels of both together.
double SampsonDistance(const TargetView& view1, const TargetView& view2) {
  const auto u1 = view1.camera->CamFromImg(view1.pixel);
  const auto u2 = view2.camera->CamFromImg(view2.pixel);
  if (!u1 || !u2) return kInfinity;
  const Rigid3d cam2_from_cam1 = view2.cam_from_world * view1.cam_from_world.Inverse();
  const Eigen::Vector3d t = cam2_from_cam1.translation.normalized();
  const Eigen::Vector3d x1 = u1->homogeneous(), x2 = u2->homogeneous();
  const Eigen::Vector3d line2 = t.cross(cam2_from_cam1.rotation * x1);
  const Eigen::Vector3d line1 = cam2_from_cam1.rotation.conjugate() * x2.cross(t);
  const double norm = std::sqrt(line1.head<2>().squaredNorm() + line2.head<2>().squaredNorm());
  return std::abs(x2.dot(line2)) / norm * view1.camera->MeanFocal();
}

enum Gap { kAll, kSame, kNext, kSecond, kFarther, kOtherStrip, kNumGaps };
constexpr std::array<const char*, kNumGaps> kGapNames = {"all observations", "pairs: same picture",
                                                         "  next picture",   "  second",
                                                         "  farther",        "  other strip"};

Gap GapOf(int idx1, int idx2, int images_per_strip) {
  if (idx1 / images_per_strip != idx2 / images_per_strip) return kOtherStrip;
  const int gap = std::abs(idx1 - idx2);
  return gap == 0 ? kSame : gap == 1 ? kNext : gap == 2 ? kSecond : kFarther;
}

ErrorRow RowOf(const char* name, const std::vector<double>& errors) {
  ErrorRow row;
  row.name = name;
  row.num = errors.size();
  if (errors.empty()) return row;
  row.median = UpperMedian(errors);
  for (size_t k = 0; k < kErrorLimits.size(); ++k) {
    size_t num = 0;
    for (const double error : errors) num += error > kErrorLimits[k];
    row.beyond[k] = static_cast<double>(num) / static_cast<double>(errors.size());
  }
  return row;
}

class Measurement {
 public:
  Measurement(const SparseModel& truth, const SparseModel& model, int images_per_strip)
      : truth_(truth), places_(FindPlaces(truth, model)), images_per_strip_(images_per_strip) {
    for (const PosedImage& image : model.images) image_of_[image.image_id] = &image;
  }

  void Add(const SparsePoint& point) {
    std::vector<TargetView> views;
    std::vector<int> idxs;
    for (const SparsePoint::TrackElement& element : point.track) {
      const auto place = places_.find(element.image_id);
      if (place == places_.end() || views.size() == kMaxViews) continue;
      const PosedImage& exact = *place->second.exact;
      views.push_back({&truth_.cameras.at(exact.camera_id), exact.cam_from_world,
                       image_of_.at(element.image_id)->points2D.at(element.point2D_idx)});
      idxs.push_back(place->second.sequence_idx);
    }
    AddViews(views);
    AddPairs(views, idxs);
  }

  ObservationErrors Result() const {
    ObservationErrors result;
    result.num_unplaced = num_unplaced_;
    for (size_t gap = 0; gap < kNumGaps; ++gap) {
      result.rows.push_back(RowOf(kGapNames[gap], errors_[gap]));
    }
    return result;
  }

 private:
  void AddViews(const std::vector<TargetView>& views) {
    if (views.size() < 2) return;
    const TriangulatedTarget target = TriangulateTarget(views, kMaxTriangulationError);
    std::vector<double>& all = errors_[kAll];
    if (target.problem.empty()) {
      all.insert(all.end(), target.errors.begin(), target.errors.end());
    } else {
      all.insert(all.end(), views.size(), kInfinity);
      ++num_unplaced_;
    }
  }

  void AddPairs(const std::vector<TargetView>& views, const std::vector<int>& idxs) {
    for (size_t a = 0; a < views.size(); ++a) {
      for (size_t b = a + 1; b < views.size(); ++b) {
        errors_[GapOf(idxs[a], idxs[b], images_per_strip_)].push_back(
            SampsonDistance(views[a], views[b]));
      }
    }
  }

  const SparseModel& truth_;
  Places places_;
  int images_per_strip_;
  std::unordered_map<uint32_t, const PosedImage*> image_of_;
  std::array<std::vector<double>, kNumGaps> errors_;
  size_t num_unplaced_ = 0;
};

}  // namespace

ObservationErrors MeasureObservations(const SparseModel& truth, const SparseModel& model,
                                      int images_per_strip) {
  Measurement measurement(truth, model, images_per_strip);
  for (const auto& [id, point] : model.points3D) measurement.Add(point);
  ObservationErrors errors = measurement.Result();
  errors.num_points = model.points3D.size();
  return errors;
}

std::string ErrorTable(const ObservationErrors& errors) {
  char line[200];
  std::snprintf(line, sizeof(line), "%zu points, %zu of them without a place\n", errors.num_points,
                errors.num_unplaced);
  std::string table = line;
  table += "                          number   median   >0.25    >0.5      >1      >2 px\n";
  for (const ErrorRow& row : errors.rows) {
    std::snprintf(line, sizeof(line),
                  "%-22s %9zu   %6.3f  %5.1f %%  %5.1f %%  %5.1f %%  %5.1f %%\n", row.name.c_str(),
                  row.num, row.median, 100 * row.beyond[0], 100 * row.beyond[1],
                  100 * row.beyond[2], 100 * row.beyond[3]);
    table += line;
  }
  return table;
}

}  // namespace colmap_seapoint
