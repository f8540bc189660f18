// COLMAP's database, 3.8 to 4.x: detected by columns, never by version; what is there is never
// changed, only added to. The only place that knows its schema.
//
// rBRIEF descriptors live in a table of our own ("seapoint_descriptors", keyed to images with
// ON DELETE CASCADE), and `descriptors` gets a stub row (rows 0, cols 128, data x''), which every
// COLMAP tried survives; or the picture's SIFT descriptors, if it has them: they are what COLMAP
// itself would store, and its own matchers can use them. Our table also keeps what tells whether a
// picture or an option changed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/io/colmap/colmap_schema.h"

struct sqlite3;

namespace colmap_seapoint {

struct DatabaseImage {
  uint32_t image_id = 0;
  uint32_t camera_id = 0;
  std::string name;
};

// Where a picture was taken, as far as the database knows. Any COLMAP writes one of three shapes:
// images.prior_tx.. up to 3.9, then pose_priors by image, from 4.0 pose_priors by frame data.
struct PositionPrior {
  enum class System { kUnknown = -1, kGeographic = 0, kCartesian = 1 };  // COLMAP's numbers

  uint32_t image_id = 0;
  Eigen::Vector3d position;  // latitude, longitude (degrees), altitude; or x, y, z
  System system = System::kUnknown;
};

// A pair of image ids, smaller first.
using ImagePair = std::pair<uint32_t, uint32_t>;

class ColmapDatabase {
 public:
  enum class Mode { kReadOnly, kReadWrite, kCreateIfMissing };

  // Throws Error: missing file, not a database, damaged (PRAGMA quick_check), locked by another
  // program (waits up to `busy_timeout_ms`), of a shape that we do not know (CheckSchema; nothing
  // is written then), no permission, full disk.
  ColmapDatabase(const std::filesystem::path& path, Mode mode, int busy_timeout_ms = 10000);
  ~ColmapDatabase();
  ColmapDatabase(ColmapDatabase&&) noexcept;

  // All methods throw Error when the database is damaged, locked or cannot be written. One thread
  // at a time may use an object.

  // Cameras with models that FindCameraModel does not know are an Error.
  std::map<uint32_t, Camera> ReadCameras() const;
  std::vector<DatabaseImage> ReadImages() const;  // by image_id
  uint32_t AddCamera(const Camera& camera);       // returns camera_id; camera.camera_id is ignored
  // Returns image_id. Where the database keeps frames (COLMAP 3.12 and later), the image gets its
  // frame, and a new camera its rig. Throws Error for a name that IsSafeImageName refuses, a name
  // that is there already, and a camera that is not.
  uint32_t AddImage(const std::string& name, uint32_t camera_id);

  // Of the images that have one, by image_id; finite. A row of pose_priors wins over
  // images.prior_*.
  std::vector<PositionPrior> ReadPositionPriors() const;

  // Everything written between Begin and Commit lands together or not at all; without them, each
  // call does. What was committed survives kill -9 at any moment.
  void BeginTransaction();
  void CommitTransaction();
  void RollbackTransaction();

  // Keypoints or descriptors, whoever wrote them.
  bool HasFeatures(uint32_t image_id) const;
  // The `fingerprint` that WriteFeatures stored; nullopt when the picture has no SeaPoints of ours,
  // or its keypoints are not there any more (colmap database_cleaner) or were replaced.
  std::optional<std::string> FeaturesFingerprint(uint32_t image_id) const;
  // Keypoints (x, y, scale, orientation), SIFT or stub descriptor row, our row. Replaces them,
  // and drops this image's matches and two-view geometries, when any were there (ours changed).
  void WriteFeatures(uint32_t image_id, const Features& features, const std::string& fingerprint);
  // nullopt when the image has no SeaPoints of ours, or its keypoints are not the ones that belong
  // to our descriptors (other software replaced them). Damaged descriptors are an Error.
  std::optional<Features> ReadFeatures(uint32_t image_id) const;

  // A row in `two_view_geometries`, but for the empty one of an undefined geometry: COLMAP's own
  // matchers write it for pictures that have stubs. Ours never do.
  bool HasMatches(ImagePair pair) const;
  // Both tables, in pair_id order: when id1 > id2 the match columns, F, E, H and the pose are
  // swapped. Unset matrices are NULL. Replaces earlier rows of the pair.
  void WriteMatches(uint32_t image_id1, uint32_t image_id2, const FeatureMatches& raw,
                    const TwoViewGeometry& geometry);
  // As stored: indices relate to (pair.first, pair.second). Empty when there is no row. Indices
  // that no keypoint has are an Error. Matrices and poses that are NULL, empty or all zero are
  // unset.
  FeatureMatches ReadMatches(ImagePair pair) const;           // table `matches`
  TwoViewGeometry ReadTwoViewGeometry(ImagePair pair) const;  // table `two_view_geometries`
  std::vector<ImagePair> ReadVerifiedPairs() const;           // rows > 0

  // The pairs that loop detection chose, and of what (`fingerprint`): a table of our own, so that a
  // run that was interrupted goes on with the same pairs. nullopt when they were chosen of
  // something else, or never.
  std::optional<std::vector<ImagePair>> ReadLoopPairs(const std::string& fingerprint) const;
  // Whatever their fingerprint; empty when there are none.
  std::vector<ImagePair> ReadLoopPairs() const;
  // Replaces the list. Matches and two-view geometries of pairs that only the old list had are
  // dropped: a run from the start would not have them.
  void WriteLoopPairs(const std::string& fingerprint, const std::vector<ImagePair>& pairs);

 private:
  void Open(Mode mode, int busy_timeout_ms);
  void CheckIntegrity() const;
  void ChooseJournal();
  bool HasColumn(const std::string& table, const std::string& column) const;
  bool HasRow(const std::string& sql, int64_t id) const;
  bool HasRows(const std::string& table) const;
  void AddFrame(int64_t image_id, int64_t camera_id);
  void DeleteMatchesOf(int64_t image_id);
  std::vector<SiftDescriptor> ReadSift(uint32_t image_id, size_t count) const;
  void CheckIndices(ImagePair pair, const FeatureMatches& matches, const char* table) const;

  std::string path_;
  sqlite3* db_ = nullptr;
  SchemaExtras extras_;
};

}  // namespace colmap_seapoint
