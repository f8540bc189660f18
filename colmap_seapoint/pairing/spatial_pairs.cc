#include "colmap_seapoint/pairing/spatial_pairs.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <nanoflann.hpp>
#include <optional>
#include <set>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/geodesy.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "colmap_seapoint/io/colmap/database_priors.h"
#include "colmap_seapoint/io/files/positions_csv.h"
#include "colmap_seapoint/io/image/image_file.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kNamesInWarning = 5;

// What a source says of every image that it knows, by its id.
struct KnownPositions {
  bool is_geographic = false;
  std::map<uint32_t, Eigen::Vector3d> positions;
  std::string missing;  // why an image is not among them
};

KnownPositions FromCsv(const std::vector<DatabaseImage>& images, const std::string& path) {
  PicturePositions table = ReadPositionsCsv(path);
  KnownPositions known;
  known.is_geographic = table.is_geographic;
  known.missing = "has no line in " + path;
  for (const DatabaseImage& image : images) {
    const auto row = table.positions.find(image.name);
    if (row == table.positions.end()) continue;
    known.positions[image.image_id] = row->second;
    table.positions.erase(row);
  }
  if (table.positions.empty()) return known;
  std::string line = path + ": " + std::to_string(table.positions.size()) +
                     " of its pictures are not in the database:";
  size_t count = 0;
  for (const auto& [name, position] : table.positions) {
    if (++count <= kNamesInWarning) line += " " + name;
  }
  LogWarning(line + (count > kNamesInWarning ? " ..." : ""));
  return known;
}

KnownPositions FromExif(const std::vector<DatabaseImage>& images, const std::string& image_path) {
  if (!std::filesystem::is_directory(image_path)) {
    throw Error(image_path, "there is no such folder", "check --image_path");
  }
  KnownPositions known;
  known.is_geographic = true;
  known.missing = "has no GPS position in its EXIF, or cannot be read";
  for (const DatabaseImage& image : images) {
    std::optional<GeoPosition> gps;
    try {
      gps = ReadImageInfo(std::filesystem::path(image_path) / image.name).gps;
    } catch (const Error&) {
      continue;  // named as left out, as every picture without a position
    }
    if (!gps) continue;
    known.positions[image.image_id] = {gps->latitude_deg, gps->longitude_deg, gps->altitude_m};
  }
  return known;
}

KnownPositions FromDatabase(const std::vector<DatabaseImage>& images, bool unknown_is_gps,
                            const std::string& database_path, const ColmapDatabase& database) {
  using System = PositionPrior::System;
  std::set<uint32_t> wanted;
  for (const DatabaseImage& image : images) wanted.insert(image.image_id);
  KnownPositions known;
  known.missing = "has no position in the database";
  std::optional<bool> is_geographic;
  for (const PositionPrior& prior : ReadPositionPriors(database)) {
    const bool is_gps =
        prior.system == System::kGeographic || (prior.system == System::kUnknown && unknown_is_gps);
    const Eigen::Vector3d& p = prior.position;
    // COLMAP 3.8 writes zeros where EXIF tells nothing.
    if (wanted.count(prior.image_id) == 0 || (is_gps && p.x() == 0 && p.y() == 0)) continue;
    if (is_geographic.value_or(is_gps) != is_gps) {
      throw Error(database_path, "some of its positions are GPS positions and some are not",
                  "give --SpatialMatching.positions_path");
    }
    if (is_gps && !IsLegal({p.x(), p.y(), p.z()})) {
      throw Error(database_path,
                  "the position of image " + std::to_string(prior.image_id) +
                      " is no latitude and longitude",
                  "give --SpatialMatching.is_gps 0 when the positions are metres");
    }
    is_geographic = is_gps;
    known.positions[prior.image_id] = p;
  }
  known.is_geographic = is_geographic.value_or(false);
  return known;
}

void ToMetres(std::vector<PlacedImage>* images) {
  const auto geo = [](const Eigen::Vector3d& p) { return GeoPosition{p.x(), p.y(), p.z()}; };
  const GeoPosition origin = geo(images->front().position);
  for (PlacedImage& image : *images) image.position = LocalEastNorthUp(geo(image.position), origin);
}

struct Cloud {
  const std::vector<PlacedImage>& images;
  bool ignore_z;

  size_t kdtree_get_point_count() const { return images.size(); }
  double kdtree_get_pt(size_t i, size_t dim) const {
    return ignore_z && dim == 2 ? 0 : images[i].position[static_cast<Eigen::Index>(dim)];
  }
  template <typename BoundingBox>
  bool kdtree_get_bbox(BoundingBox&) const {
    return false;
  }
};

using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3>;

}  // namespace

std::vector<PlacedImage> PlaceImages(const std::vector<DatabaseImage>& images,
                                     const SpatialPairOptions& options,
                                     const std::string& image_path,
                                     const std::string& database_path,
                                     const ColmapDatabase& database, RunReport* report) {
  const KnownPositions known =
      !options.positions_path.empty() ? FromCsv(images, options.positions_path)
      : !image_path.empty()           ? FromExif(images, image_path)
                            : FromDatabase(images, options.is_gps, database_path, database);
  if (known.positions.empty()) {
    throw Error(database_path, "the position of no picture is known",
                "give --SpatialMatching.positions_path, or --image_path when the pictures' EXIF "
                "holds GPS positions, or use sequential_matcher");
  }
  std::vector<PlacedImage> placed;
  for (const DatabaseImage& image : images) {
    const auto position = known.positions.find(image.image_id);
    if (position != known.positions.end()) {
      placed.push_back({image.image_id, position->second});
    } else {
      LeaveOut(image.name, known.missing, report);
    }
  }
  report->images_used = static_cast<int64_t>(placed.size());
  if (known.is_geographic) ToMetres(&placed);
  return placed;
}

std::vector<ImagePair> SpatialPairs(const std::vector<PlacedImage>& images,
                                    const SpatialPairOptions& options) {
  if (images.size() < 2) return {};
  const Cloud cloud{images, options.ignore_z};
  Tree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  tree.buildIndex();
  const size_t num_neighbors = static_cast<size_t>(options.max_num_neighbors);
  std::vector<uint32_t> found(num_neighbors + 1);  // itself is one
  std::vector<double> squared_distances(num_neighbors + 1);
  std::set<std::pair<size_t, size_t>> places;
  for (size_t i = 0; i < images.size(); ++i) {
    const double query[3] = {cloud.kdtree_get_pt(i, 0), cloud.kdtree_get_pt(i, 1),
                             cloud.kdtree_get_pt(i, 2)};
    const size_t num_found =
        tree.knnSearch(query, num_neighbors + 1, found.data(), squared_distances.data());
    size_t num_taken = 0;
    for (size_t n = 0; n < num_found && num_taken < num_neighbors; ++n) {
      if (squared_distances[n] > options.max_distance * options.max_distance) break;
      const size_t j = found[n];
      if (j == i) continue;
      places.insert(std::minmax(i, j));
      ++num_taken;
    }
  }
  std::vector<ImagePair> pairs;
  for (const auto& [i, j] : places) {
    pairs.push_back(std::minmax(images[i].image_id, images[j].image_id));
  }
  return pairs;
}

}  // namespace colmap_seapoint
