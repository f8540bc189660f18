// SeaPoints in COLMAP's database.
//
// Keypoints stand in COLMAP's own table. rBRIEF descriptors stand in a table of ours
// ("seapoint_descriptors", keyed to images with ON DELETE CASCADE), and `descriptors` gets a stub
// row (rows 0, cols 128, data x''), which every COLMAP tried survives; or the picture's SIFT
// descriptors, if it has them: they are what COLMAP itself would store, and its own matchers can
// use them. Our table also keeps the fingerprint that tells whether a picture or an option changed.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"

namespace colmap_seapoint {

// Keypoints or descriptors, whoever wrote them.
bool HasFeatures(const ColmapDatabase& database, uint32_t image_id);

// The `fingerprint` that WriteFeatures stored; nullopt when the picture has no SeaPoints of ours,
// or its keypoints are not there any more (colmap database_cleaner) or were replaced.
std::optional<std::string> FeaturesFingerprint(const ColmapDatabase& database, uint32_t image_id);

// Keypoints (x, y, scale, orientation), SIFT or stub descriptor row, our row. Replaces what the
// image had, and then drops its matches and two-view geometries, which belong to the old ones.
void WriteFeatures(ColmapDatabase* database, uint32_t image_id, const Features& features,
                   const std::string& fingerprint);

// nullopt when the image has no SeaPoints of ours, or its keypoints are not the ones that belong
// to our descriptors (other software replaced them). Damaged descriptors are an Error.
std::optional<Features> ReadFeatures(const ColmapDatabase& database, uint32_t image_id);

// Where the keypoints of an image lie, pixels, whoever wrote them; empty where there are none.
// Throws Error where they are damaged.
std::vector<Eigen::Vector2f> ReadKeypointPlaces(const ColmapDatabase& database, uint32_t image_id);

}  // namespace colmap_seapoint
