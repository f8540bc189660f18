// The calls of a database that the tests of pictures, pairing and mapping make. Where the functions
// stand in headers of their own, a topic each, these are included; else they are made of methods.
#pragma once

#include "colmap_seapoint/io/colmap/colmap_database.h"

#if __has_include("colmap_seapoint/io/colmap/database_images.h")
#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_loops.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#else

namespace colmap_seapoint {

inline std::map<uint32_t, Camera> ReadCameras(const ColmapDatabase& database) {
  return database.ReadCameras();
}
inline std::vector<DatabaseImage> ReadImages(const ColmapDatabase& database) {
  return database.ReadImages();
}
inline uint32_t AddCamera(ColmapDatabase* database, const Camera& camera) {
  return database->AddCamera(camera);
}
inline uint32_t AddImage(ColmapDatabase* database, const std::string& name, uint32_t camera_id) {
  return database->AddImage(name, camera_id);
}
inline void WriteFeatures(ColmapDatabase* database, uint32_t image_id, const Features& features,
                          const std::string& fingerprint) {
  database->WriteFeatures(image_id, features, fingerprint);
}
inline bool HasMatches(const ColmapDatabase& database, ImagePair pair) {
  return database.HasMatches(pair);
}
inline void WriteMatches(ColmapDatabase* database, uint32_t image_id1, uint32_t image_id2,
                         const FeatureMatches& raw, const TwoViewGeometry& geometry) {
  database->WriteMatches(image_id1, image_id2, raw, geometry);
}
inline FeatureMatches ReadMatches(const ColmapDatabase& database, ImagePair pair) {
  return database.ReadMatches(pair);
}
inline TwoViewGeometry ReadTwoViewGeometry(const ColmapDatabase& database, ImagePair pair) {
  return database.ReadTwoViewGeometry(pair);
}
inline std::vector<ImagePair> ReadVerifiedPairs(const ColmapDatabase& database) {
  return database.ReadVerifiedPairs();
}
inline std::vector<ImagePair> ReadLoopPairs(const ColmapDatabase& database) {
  return database.ReadLoopPairs();
}

}  // namespace colmap_seapoint
#endif
