#include "colmap_seapoint/io/colmap/database_features.h"

#include <cstring>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/io/files/sqlite.h"

namespace colmap_seapoint {
namespace {

constexpr int64_t kKeypointCols = 4;
constexpr int64_t kMaxKeypointCols = 6;  // COLMAP's affine keypoints
constexpr int64_t kSiftCols = 128;       // of stubs too
static_assert(sizeof(SeaPoint) == kKeypointCols * sizeof(float), "a keypoint row is a SeaPoint");
static_assert(sizeof(SiftDescriptor) == kSiftCols, "a descriptor row is a SiftDescriptor");

constexpr const char* kOwnTable =
    "CREATE TABLE IF NOT EXISTS seapoint_descriptors(image_id INTEGER PRIMARY KEY NOT NULL, "
    "rows INTEGER NOT NULL, cols INTEGER NOT NULL, data BLOB, fingerprint TEXT NOT NULL, "
    "keypoints_hash TEXT, data_hash TEXT, sift_hash TEXT, "
    "FOREIGN KEY(image_id) REFERENCES images(image_id) ON DELETE CASCADE)";

[[noreturn]] void ThrowDamaged(const SqlConnection& db, uint32_t image_id, const char* which) {
  throw Error(db.path,
              std::string("the ") + which + " descriptors of image " + std::to_string(image_id) +
                  " are damaged",
              "restore a copy of the database, or delete it and extract features again");
}

template <typename Row>
size_t BytesOf(const std::vector<Row>& rows) {
  return rows.size() * sizeof(Row);
}

template <typename Row>
std::string HashOf(const std::vector<Row>& rows) {
  return HashBytes(rows.data(), BytesOf(rows));
}

template <typename Row>
std::vector<Row> RowsOf(const SqlColumn& blob) {
  std::vector<Row> rows(blob.Size() / sizeof(Row));
  if (!rows.empty()) std::memcpy(static_cast<void*>(rows.data()), blob.Blob(), BytesOf(rows));
  return rows;
}

void PrepareOwnTable(const SqlConnection& db) {
  RunSql(db, kOwnTable);
  if (!HasColumn(db, "seapoint_descriptors", "sift_hash")) {  // made before there was SIFT
    RunSql(db, "ALTER TABLE seapoint_descriptors ADD COLUMN sift_hash TEXT");
  }
}

void WriteKeypoints(const SqlConnection& db, uint32_t image_id,
                    const std::vector<SeaPoint>& points) {
  SqlStatement(db,
               "INSERT OR REPLACE INTO keypoints(image_id, rows, cols, data) VALUES(?, ?, ?, ?)")
      .Bind(static_cast<int64_t>(image_id))
      .Bind(static_cast<int64_t>(points.size()))
      .Bind(kKeypointCols)
      .BindBlob(points.data(), BytesOf(points))
      .Run();
}

// The stub row, when there are none.
void WriteSift(const SqlConnection& db, bool has_descriptor_type, uint32_t image_id,
               const std::vector<SiftDescriptor>& descriptors) {
  SqlStatement(db,
               std::string("INSERT OR REPLACE INTO descriptors(image_id, rows, cols, data") +
                   (has_descriptor_type ? ", type) VALUES(?, ?, ?, ?, 0)" : ") VALUES(?, ?, ?, ?)"))
      .Bind(static_cast<int64_t>(image_id))
      .Bind(static_cast<int64_t>(descriptors.size()))
      .Bind(kSiftCols)
      .BindBlob(descriptors.data(), BytesOf(descriptors))
      .Run();
}

// rBRIEF, and the hashes by which ReadFeatures knows that all three rows belong together.
void WriteOwnRow(const SqlConnection& db, uint32_t image_id, const Features& features,
                 const std::string& fingerprint) {
  const std::string keypoints_hash = HashOf(features.points);
  const std::string data_hash = HashOf(features.descriptors);
  const std::string sift_hash =
      features.sift_descriptors.empty() ? "" : HashOf(features.sift_descriptors);
  SqlStatement(db,
               "INSERT OR REPLACE INTO seapoint_descriptors(image_id, rows, cols, data, "
               "fingerprint, keypoints_hash, data_hash, sift_hash) VALUES(?, ?, ?, ?, ?, ?, ?, ?)")
      .Bind(static_cast<int64_t>(image_id))
      .Bind(static_cast<int64_t>(features.points.size()))
      .Bind(static_cast<int64_t>(sizeof(Descriptor)))
      .BindBlob(features.descriptors.data(), BytesOf(features.descriptors))
      .Bind(fingerprint)
      .Bind(keypoints_hash)
      .Bind(data_hash)
      .Bind(sift_hash)
      .Run();
}

// Empty when the image has none of ours.
std::vector<SiftDescriptor> ReadSift(const SqlConnection& db, uint32_t image_id, size_t count) {
  if (!HasColumn(db, "seapoint_descriptors", "sift_hash")) return {};
  SqlStatement ours(db, "SELECT sift_hash FROM seapoint_descriptors WHERE image_id = ?");
  ours.Bind(static_cast<int64_t>(image_id));
  if (!ours.Step() || ours[0].IsNull() || ours[0].Text().empty()) return {};
  SqlStatement sift(db, "SELECT rows, cols, data FROM descriptors WHERE image_id = ?");
  sift.Bind(static_cast<int64_t>(image_id));
  if (!sift.Step() || sift[0].Int() != static_cast<int64_t>(count) || sift[1].Int() != kSiftCols ||
      sift[2].Size() != count * sizeof(SiftDescriptor) ||
      !IsHashOf(ours[0].Text(), sift[2].Blob(), sift[2].Size())) {
    ThrowDamaged(db, image_id, "SIFT");
  }
  return RowsOf<SiftDescriptor>(sift[2]);
}

}  // namespace

bool HasFeatures(const ColmapDatabase& database, uint32_t image_id) {
  return HasRow(database.Connection(),
                "SELECT 1 FROM keypoints WHERE image_id = ?1 UNION ALL "
                "SELECT 1 FROM descriptors WHERE image_id = ?1",
                image_id);
}

std::optional<std::string> FeaturesFingerprint(const ColmapDatabase& database, uint32_t image_id) {
  const SqlConnection& db = database.Connection();
  if (!HasColumn(db, "seapoint_descriptors", "data_hash")) return std::nullopt;
  SqlStatement row(db,
                   "SELECT fingerprint FROM seapoint_descriptors AS ours JOIN keypoints "
                   "USING(image_id) WHERE image_id = ? AND keypoints.rows = ours.rows AND "
                   "keypoints.cols = 4");
  row.Bind(static_cast<int64_t>(image_id));
  if (!row.Step()) return std::nullopt;
  return row[0].Text();
}

void WriteFeatures(ColmapDatabase* database, uint32_t image_id, const Features& features,
                   const std::string& fingerprint) {
  SEAPOINT_CHECK(features.points.size() == features.descriptors.size());
  SEAPOINT_CHECK(features.sift_descriptors.empty() ||
                 features.sift_descriptors.size() == features.points.size());
  const SqlConnection& db = database->Connection();
  SqlSavepoint savepoint(db);
  PrepareOwnTable(db);
  if (HasFeatures(*database, image_id) ||
      HasRow(db, "SELECT 1 FROM seapoint_descriptors WHERE image_id = ?", image_id)) {
    DeleteMatchesOfImage(database, image_id);
  }
  WriteKeypoints(db, image_id, features.points);
  WriteSift(db, database->Extras().has_descriptor_type, image_id, features.sift_descriptors);
  WriteOwnRow(db, image_id, features, fingerprint);
  savepoint.Release();
}

std::optional<Features> ReadFeatures(const ColmapDatabase& database, uint32_t image_id) {
  const SqlConnection& db = database.Connection();
  if (!HasColumn(db, "seapoint_descriptors", "data_hash")) return std::nullopt;
  SqlStatement ours(db,
                    "SELECT rows, cols, data, keypoints_hash, data_hash "
                    "FROM seapoint_descriptors WHERE image_id = ?");
  ours.Bind(static_cast<int64_t>(image_id));
  if (!ours.Step()) return std::nullopt;
  const int64_t num_rows = ours[0].Int();
  if (ours[1].Int() != sizeof(Descriptor) || num_rows < 0 ||
      ours[2].Size() % sizeof(Descriptor) != 0 ||
      ours[2].Size() / sizeof(Descriptor) != static_cast<uint64_t>(num_rows) ||
      !IsHashOf(ours[4].Text(), ours[2].Blob(), ours[2].Size())) {
    ThrowDamaged(db, image_id, "SeaPoint");
  }
  SqlStatement keypoints(db, "SELECT rows, cols, data FROM keypoints WHERE image_id = ?");
  keypoints.Bind(static_cast<int64_t>(image_id));
  if (!keypoints.Step() || keypoints[0].Int() != num_rows || keypoints[1].Int() != kKeypointCols ||
      keypoints[2].Size() != static_cast<uint64_t>(num_rows) * sizeof(SeaPoint) ||
      !IsHashOf(ours[3].Text(), keypoints[2].Blob(), keypoints[2].Size())) {
    return std::nullopt;
  }
  Features features;
  features.points = RowsOf<SeaPoint>(keypoints[2]);
  features.descriptors = RowsOf<Descriptor>(ours[2]);
  features.sift_descriptors = ReadSift(db, image_id, features.points.size());
  return features;
}

std::vector<Eigen::Vector2f> ReadKeypointPlaces(const ColmapDatabase& database, uint32_t image_id) {
  const SqlConnection& db = database.Connection();
  SqlStatement row(db, "SELECT rows, cols, data FROM keypoints WHERE image_id = ?");
  row.Bind(static_cast<int64_t>(image_id));
  if (!row.Step()) return {};
  const int64_t num_rows = row[0].Int(), num_cols = row[1].Int();
  const std::vector<float> values = RowsOf<float>(row[2]);
  if (num_rows < 0 || num_cols < 2 || num_cols > kMaxKeypointCols ||
      static_cast<uint64_t>(num_rows) > values.size() ||
      values.size() != static_cast<uint64_t>(num_rows * num_cols)) {
    throw Error(db.path, "the keypoints of image " + std::to_string(image_id) + " are damaged",
                "restore a copy of the database, or delete it and extract features again");
  }
  std::vector<Eigen::Vector2f> places;
  for (size_t i = 0; i < values.size(); i += static_cast<size_t>(num_cols)) {
    places.emplace_back(values[i], values[i + 1]);
  }
  return places;
}

}  // namespace colmap_seapoint
