// Pairs of pictures that were taken near each other.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "colmap_seapoint/base/run_options.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/pairing/pair_options.h"

namespace colmap_seapoint {

struct PlacedImage {
  uint32_t image_id = 0;
  Eigen::Vector3d position;  // metres
};

// The images whose position is known, in their order: from --SpatialMatching.positions_path when
// it is given, else from the EXIF of the pictures in `image_path` when that is given, else from the
// database: never from two of them, since their frames differ. The other images are left out.
// Throws Error when no position is known.
std::vector<PlacedImage> PlaceImages(const std::vector<DatabaseImage>& images,
                                     const SpatialPairOptions& options,
                                     const std::string& image_path,
                                     const std::string& database_path,
                                     const ColmapDatabase& database, RunReport* report);

// Each image with its nearest ones, up to max_num_neighbors and max_distance; each pair once, by
// the images' order. O(n log n).
std::vector<ImagePair> SpatialPairs(const std::vector<PlacedImage>& images,
                                    const SpatialPairOptions& options);

}  // namespace colmap_seapoint
