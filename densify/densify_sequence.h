// The spine of densification (paper 2.2, Figure 3): pair by pair along the track, only what is new.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/base/picture.h"
#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/base/stereo_rig.h"
#include "densify/cloud/partial_cloud.h"
#include "densify/partial_densification_options.h"

namespace colmap_seapoint {

// Raise it whenever the same model, pictures and options give another cloud than before.
inline constexpr char kDensificationVersion[] = "6";

// Where pictures, SeaPoints and matches come from; image_idx is the position in
// SparseModel::images. What is stored is read; only what is not is worked out anew.
class PictureSource {
 public:
  virtual ~PictureSource() = default;
  // Throws Error for a picture that is missing, unreadable or of another size than its camera.
  // Called from several threads at once; the others are not.
  virtual Picture ReadPicture(int image_idx) = 0;
  // nullopt: none are stored. Throws Error for damaged ones.
  virtual std::optional<Features> ReadSeaPoints(int image_idx) = 0;
  virtual Features FindSeaPoints(const GrayImage& picture) = 0;
  // Indices into the points of ReadSeaPoints. nullopt: none are stored, or either picture's
  // SeaPoints are not.
  virtual std::optional<FeatureMatches> ReadMatches(int image_idx1, int image_idx2) = 0;
  virtual FeatureMatches Match(const Features& features1, const Features& features2) = 0;
};

// One row of pairs.csv: a pair that was densified, or a picture that was passed over.
struct PairReport {
  int image_idx1 = -1;
  int image_idx2 = -1;  // -1: image1 was skipped as the first picture of a pair
  std::string pass;     // "sequence" or "completion"
  std::string skipped;  // why, or empty
  double baseline = 0;  // model units
  double overlap = 0;   // share of image1 already covered by what came before, 0..1
  int num_oa = 0, num_na = 0, num_rea = 0;  // SeaPoints of image1 by label
  int num_seeds = 0;
  int num_failed_seeds = 0;  // seeds that did not spread
  int64_t num_points = 0;
  double rectification_seconds = 0, propagation_seconds = 0, total_seconds = 0;  // wall
};

struct LeftOutPicture {
  int image_idx = -1;
  std::string reason;
};

struct SequenceReport {
  std::vector<PairReport> pairs;
  std::vector<LeftOutPicture> left_out;  // pictures that could not be read
  int64_t num_points = 0;
};

struct PairDebug;

// What comes out on the way, in processing order, from the caller's thread.
struct SequenceCallbacks {
  std::function<void(const PartialCloud&)> sink;              // each partial local cloud
  std::function<void(int64_t done, int64_t total)> progress;  // now and then; optional
  // Optional: every pair that was densified. Then each is densified in full too, for comparison.
  std::function<void(const PairDebug&)> debug;
};

// Densifies every pair of the model's pictures, taken in the order of their names (natural sort:
// "2" before "10"). Same clouds for any num_threads, with or without `debug`.
// With a rig, its right pictures are no part of that track, and a picture's pair is completed by
// its simultaneous right one, where there is one that can be read.
SequenceReport DensifySequence(const SparseModel& model, PictureSource* source,
                               const PartialDensificationOptions& options, int num_threads,
                               const SequenceCallbacks& callbacks, const StereoRig& rig = {});

}  // namespace colmap_seapoint
