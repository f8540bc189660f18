#include "densify/completeness/sight/lost_pictures.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "colmap_seapoint/base/natural_order.h"

namespace colmap_seapoint {
namespace {

// Longer runs may have turned on their way.
constexpr size_t kMaxPlaced = 4;
// Of a footprint: how far a longer run's pictures may have seen from the line.
constexpr double kReachOfRun = 1.0;

std::string FolderOf(const std::string& name) {
  const size_t slash = name.rfind('/');
  return slash == std::string::npos ? "" : name.substr(0, slash);
}

Eigen::Vector3d AxisOf(const SurveyView& view) { return view.rotation.row(2).transpose(); }

// On the way between two views, at a share of it.
SurveyView Between(const SurveyView& a, const SurveyView& b, double share) {
  SurveyView view = a;
  const Eigen::Quaterniond rotation =
      Eigen::Quaterniond(a.rotation).slerp(share, Eigen::Quaterniond(b.rotation));
  view.rotation = rotation.toRotationMatrix();
  view.center = (1 - share) * a.center + share * b.center;
  view.translation = -(view.rotation * view.center);
  return view;
}

}  // namespace

std::vector<LostRun> FindLostRuns(const std::vector<std::string>& registered,
                                  const std::vector<std::string>& lost,
                                  const std::vector<std::string>& elsewhere) {
  constexpr int kLost = -2, kElsewhere = -1;
  struct Entry {
    std::string name;
    int image_idx;
  };
  std::vector<Entry> track;
  for (size_t i = 0; i < registered.size(); ++i) {
    track.push_back({registered[i], static_cast<int>(i)});
  }
  for (const std::string& name : lost) track.push_back({name, kLost});
  for (const std::string& name : elsewhere) track.push_back({name, kElsewhere});
  std::sort(track.begin(), track.end(),
            [](const Entry& a, const Entry& b) { return NaturalLess(a.name, b.name); });
  std::vector<LostRun> runs;
  for (size_t i = 0; i < track.size(); ++i) {
    if (track[i].image_idx != kLost) continue;
    const std::string folder = FolderOf(track[i].name);
    LostRun run;
    if (i > 0 && FolderOf(track[i - 1].name) == folder) run.before = track[i - 1].image_idx;
    for (; i < track.size() && track[i].image_idx == kLost && FolderOf(track[i].name) == folder;
         ++i) {
      run.names.push_back(track[i].name);
    }
    if (i < track.size() && FolderOf(track[i].name) == folder) run.after = track[i].image_idx;
    runs.push_back(std::move(run));
    --i;
  }
  return runs;
}

LostSight::LostSight(const std::vector<LostRun>& runs, const std::vector<SurveyView>& views,
                     double footprint) {
  for (size_t i = 0; i < runs.size(); ++i) {
    const LostRun& run = runs[i];
    if (run.before < 0 && run.after < 0) continue;
    const int one = run.before >= 0 ? run.before : run.after;
    const int other = run.after >= 0 ? run.after : run.before;
    const SurveyView& a = views[static_cast<size_t>(one)];
    const SurveyView& b = views[static_cast<size_t>(other)];
    Reach reach{static_cast<int>(i),     a.center, b.center, AxisOf(a) + AxisOf(b),
                kReachOfRun * footprint, {}};
    reach.axis.normalize();
    if (one != other && run.names.size() <= kMaxPlaced) {
      for (size_t k = 1; k <= run.names.size(); ++k) {
        reach.pictures.push_back(
            Between(a, b, static_cast<double>(k) / static_cast<double>(run.names.size() + 1)));
      }
    }
    reaches_.push_back(std::move(reach));
  }
}

int LostSight::RunThatSaw(const Eigen::Vector3d& place) const {
  for (const Reach& reach : reaches_) {
    for (const SurveyView& view : reach.pictures) {
      if (view.Project(place)) return reach.run;
    }
    if (!reach.pictures.empty()) continue;
    // Across the cameras' axis, since the line runs above the ground.
    const Eigen::Vector3d way = reach.to - reach.from;
    const Eigen::Vector3d flat_way = way - reach.axis * reach.axis.dot(way);
    const Eigen::Vector3d aside = place - reach.from;
    const Eigen::Vector3d flat = aside - reach.axis * reach.axis.dot(aside);
    const double length = flat_way.squaredNorm();
    const double share = length > 0 ? std::clamp(flat.dot(flat_way) / length, 0.0, 1.0) : 0;
    if ((flat - share * flat_way).norm() <= reach.radius) return reach.run;
  }
  return -1;
}

}  // namespace colmap_seapoint
