#include <cstring>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/io/files/sqlite.h"

namespace colmap_seapoint {
namespace {

constexpr int64_t kKeypointCols = 4;
constexpr int64_t kSiftCols = 128;  // of stubs too
constexpr int64_t kMaxImageId = 2147483647;
static_assert(sizeof(SeaPoint) == kKeypointCols * sizeof(float), "a keypoint row is a SeaPoint");
static_assert(sizeof(SiftDescriptor) == kSiftCols, "a descriptor row is a SiftDescriptor");

constexpr const char* kOwnTable =
    "CREATE TABLE IF NOT EXISTS seapoint_descriptors(image_id INTEGER PRIMARY KEY NOT NULL, "
    "rows INTEGER NOT NULL, cols INTEGER NOT NULL, data BLOB, fingerprint TEXT NOT NULL, "
    "keypoints_hash TEXT, data_hash TEXT, sift_hash TEXT, "
    "FOREIGN KEY(image_id) REFERENCES images(image_id) ON DELETE CASCADE)";

[[noreturn]] void ThrowDamaged(const std::string& path, uint32_t image_id, const char* which) {
  throw Error(path,
              std::string("the ") + which + " descriptors of image " + std::to_string(image_id) +
                  " are damaged",
              "restore a copy of the database, or delete it and extract features again");
}

}  // namespace

bool ColmapDatabase::HasFeatures(uint32_t image_id) const {
  return HasRow(
      "SELECT 1 FROM keypoints WHERE image_id = ?1 UNION ALL "
      "SELECT 1 FROM descriptors WHERE image_id = ?1",
      image_id);
}

std::optional<std::string> ColmapDatabase::FeaturesFingerprint(uint32_t image_id) const {
  if (!HasColumn("seapoint_descriptors", "data_hash")) return std::nullopt;
  SqlStatement row(path_, db_,
                   "SELECT fingerprint FROM seapoint_descriptors AS ours JOIN keypoints "
                   "USING(image_id) WHERE image_id = ? AND keypoints.rows = ours.rows AND "
                   "keypoints.cols = 4");
  row.Bind(static_cast<int64_t>(image_id));
  if (!row.Step()) return std::nullopt;
  return row.Text(0);
}

void ColmapDatabase::DeleteMatchesOf(int64_t image_id) {
  for (const char* table : {"matches", "two_view_geometries"}) {
    SqlStatement(
        path_, db_,
        std::string("DELETE FROM ") + table + " WHERE pair_id / ?2 = ?1 OR pair_id % ?2 = ?1")
        .Bind(image_id)
        .Bind(kMaxImageId)
        .Run();
  }
}

void ColmapDatabase::WriteFeatures(uint32_t image_id, const Features& features,
                                   const std::string& fingerprint) {
  SEAPOINT_CHECK(features.points.size() == features.descriptors.size());
  SEAPOINT_CHECK(features.sift_descriptors.empty() ||
                 features.sift_descriptors.size() == features.points.size());
  const auto num_rows = static_cast<int64_t>(features.points.size());
  const size_t keypoint_bytes = features.points.size() * sizeof(SeaPoint);
  const size_t descriptor_bytes = features.descriptors.size() * sizeof(Descriptor);
  const std::string keypoints_hash = HashBytes(features.points.data(), keypoint_bytes);
  const std::string data_hash = HashBytes(features.descriptors.data(), descriptor_bytes);
  const size_t sift_bytes = features.sift_descriptors.size() * sizeof(SiftDescriptor);
  const std::string sift_hash =
      sift_bytes == 0 ? "" : HashBytes(features.sift_descriptors.data(), sift_bytes);

  SqlSavepoint savepoint(path_, db_);
  RunSql(path_, db_, kOwnTable);
  if (!HasColumn("seapoint_descriptors", "sift_hash")) {  // made before there was SIFT
    RunSql(path_, db_, "ALTER TABLE seapoint_descriptors ADD COLUMN sift_hash TEXT");
  }
  if (HasFeatures(image_id) ||
      HasRow("SELECT 1 FROM seapoint_descriptors WHERE image_id = ?", image_id)) {
    DeleteMatchesOf(image_id);
  }
  SqlStatement(path_, db_,
               "INSERT OR REPLACE INTO keypoints(image_id, rows, cols, data) VALUES(?, ?, ?, ?)")
      .Bind(static_cast<int64_t>(image_id))
      .Bind(num_rows)
      .Bind(kKeypointCols)
      .BindBlob(features.points.data(), keypoint_bytes)
      .Run();
  SqlStatement(
      path_, db_,
      std::string("INSERT OR REPLACE INTO descriptors(image_id, rows, cols, data") +
          (extras_.has_descriptor_type ? ", type) VALUES(?, ?, ?, ?, 0)" : ") VALUES(?, ?, ?, ?)"))
      .Bind(static_cast<int64_t>(image_id))
      .Bind(static_cast<int64_t>(features.sift_descriptors.size()))
      .Bind(kSiftCols)
      .BindBlob(features.sift_descriptors.data(), sift_bytes)
      .Run();
  SqlStatement(path_, db_,
               "INSERT OR REPLACE INTO seapoint_descriptors(image_id, rows, cols, data, "
               "fingerprint, keypoints_hash, data_hash, sift_hash) VALUES(?, ?, ?, ?, ?, ?, ?, ?)")
      .Bind(static_cast<int64_t>(image_id))
      .Bind(num_rows)
      .Bind(static_cast<int64_t>(sizeof(Descriptor)))
      .BindBlob(features.descriptors.data(), descriptor_bytes)
      .Bind(fingerprint)
      .Bind(keypoints_hash)
      .Bind(data_hash)
      .Bind(sift_hash)
      .Run();
  savepoint.Release();
}

std::optional<Features> ColmapDatabase::ReadFeatures(uint32_t image_id) const {
  if (!HasColumn("seapoint_descriptors", "data_hash")) return std::nullopt;
  SqlStatement ours(path_, db_,
                    "SELECT rows, cols, data, keypoints_hash, data_hash "
                    "FROM seapoint_descriptors WHERE image_id = ?");
  ours.Bind(static_cast<int64_t>(image_id));
  if (!ours.Step()) return std::nullopt;
  const int64_t num_rows = ours.Int(0);
  if (ours.Int(1) != sizeof(Descriptor) || num_rows < 0 ||
      ours.BlobSize(2) % sizeof(Descriptor) != 0 ||
      ours.BlobSize(2) / sizeof(Descriptor) != static_cast<uint64_t>(num_rows) ||
      HashBytes(ours.Blob(2), ours.BlobSize(2)) != ours.Text(4)) {
    ThrowDamaged(path_, image_id, "SeaPoint");
  }
  SqlStatement keypoints(path_, db_, "SELECT rows, cols, data FROM keypoints WHERE image_id = ?");
  keypoints.Bind(static_cast<int64_t>(image_id));
  if (!keypoints.Step() || keypoints.Int(0) != num_rows || keypoints.Int(1) != kKeypointCols ||
      keypoints.BlobSize(2) != static_cast<uint64_t>(num_rows) * sizeof(SeaPoint) ||
      HashBytes(keypoints.Blob(2), keypoints.BlobSize(2)) != ours.Text(3)) {
    return std::nullopt;
  }
  Features features;
  features.points.resize(static_cast<size_t>(num_rows));
  features.descriptors.resize(static_cast<size_t>(num_rows));
  if (num_rows > 0) {
    std::memcpy(features.points.data(), keypoints.Blob(2), keypoints.BlobSize(2));
    std::memcpy(features.descriptors.data(), ours.Blob(2), ours.BlobSize(2));
  }
  features.sift_descriptors = ReadSift(image_id, features.points.size());
  return features;
}

std::vector<SiftDescriptor> ColmapDatabase::ReadSift(uint32_t image_id, size_t count) const {
  if (!HasColumn("seapoint_descriptors", "sift_hash")) return {};
  SqlStatement ours(path_, db_, "SELECT sift_hash FROM seapoint_descriptors WHERE image_id = ?");
  ours.Bind(static_cast<int64_t>(image_id));
  if (!ours.Step() || ours.IsNull(0) || ours.Text(0).empty()) return {};
  SqlStatement sift(path_, db_, "SELECT rows, cols, data FROM descriptors WHERE image_id = ?");
  sift.Bind(static_cast<int64_t>(image_id));
  if (!sift.Step() || sift.Int(0) != static_cast<int64_t>(count) || sift.Int(1) != kSiftCols ||
      sift.BlobSize(2) != count * sizeof(SiftDescriptor) ||
      HashBytes(sift.Blob(2), sift.BlobSize(2)) != ours.Text(0)) {
    ThrowDamaged(path_, image_id, "SIFT");
  }
  std::vector<SiftDescriptor> descriptors(count);
  if (count > 0) std::memcpy(descriptors.data(), sift.Blob(2), sift.BlobSize(2));
  return descriptors;
}

}  // namespace colmap_seapoint
