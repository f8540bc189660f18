// A survey of an exact world in memory: pictures, poses, SeaPoints and triangulated points, all of
// them exact. Landmarks on the surface are the SeaPoints; the same descriptor in every picture.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "densify/densify_pair.h"
#include "densify/densify_sequence.h"
#include "densify/pair_debug.h"
#include "tests/synthetic/world.h"

namespace colmap_seapoint {

class TestSurvey : public PictureSource {
 public:
  TestSurvey(const World& world, const Camera& camera);

  // image_id 11, 12, ... Before AddLandmarks.
  void AddPicture(const std::string& name, const Viewpoint& viewpoint);
  // On what is seen from straight above, x and y uniform.
  void AddLandmarks(int count, const Eigen::Vector2d& x_range, const Eigen::Vector2d& y_range);
  // Noise that hides a square around a pixel, in this picture only, and the landmarks there.
  void HideBehindFish(int image_idx, const Eigen::Vector2d& center, double half_side);
  void MakeUnreadable(int image_idx) { unreadable_ = image_idx; }

  Picture ReadPicture(int image_idx) override;
  std::optional<Features> ReadSeaPoints(int image_idx) override;
  // Knows the picture by its pixels.
  Features FindSeaPoints(const Picture& picture) override;
  std::optional<FeatureMatches> ReadMatches(int image_idx1, int image_idx2) override;
  FeatureMatches Match(const Features& features1, const Features& features2) override;

  const SparseModel& Model() const { return model_; }
  SparseModel* MutableModel() { return &model_; }
  const World& GetWorld() const { return world_; }
  const Viewpoint& At(int image_idx) const { return viewpoints_[static_cast<size_t>(image_idx)]; }
  // The landmark of a SeaPoint.
  const Eigen::Vector3d& LandmarkOf(int image_idx, size_t seapoint_idx) const;

  bool stores_seapoints = true, stores_matches = true;
  std::map<int, int> num_decoded;                // by image_idx
  std::map<std::pair<int, int>, int> num_asked;  // by image_idx, smaller first
  int num_found = 0, num_matched = 0;            // SeaPoints, matches: not stored ones

 private:
  const World world_;
  std::vector<Viewpoint> viewpoints_;
  std::vector<ColorImage> pictures_;
  std::vector<Features> features_;
  std::map<uint64_t, Eigen::Vector3d> landmarks_;
  SparseModel model_;
  int unreadable_ = -1;
  std::mutex mutex_;
};

struct Outcome {
  SequenceReport report;
  std::vector<PartialCloud> clouds;

  int64_t NumPoints() const;
};

// Checks that progress goes forward.
Outcome Densify(TestSurvey* survey, const PartialDensificationOptions& options, int num_threads = 2,
                const std::function<void(const PairDebug&)>& debug = nullptr,
                const StereoRig& rig = {});

void ExpectSameClouds(const Outcome& one, const Outcome& other);

// Squares of the ground, `side` wide, that hold a point within `tolerance` of the surface.
std::set<std::pair<int, int>> CoveredSquares(const World& world,
                                             const std::vector<PartialCloud>& clouds, double side,
                                             double tolerance);

double ShareOnSurface(const World& world, const Outcome& outcome, double tolerance);

}  // namespace colmap_seapoint
