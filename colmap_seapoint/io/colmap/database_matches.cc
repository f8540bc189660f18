#include "colmap_seapoint/io/colmap/database_matches.h"

#include <Eigen/LU>
#include <algorithm>
#include <cstring>
#include <string>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/sqlite.h"

namespace colmap_seapoint {
namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "COLMAP's blobs are little-endian");
static_assert(sizeof(FeatureMatch) == 2 * sizeof(uint32_t), "a match row is a FeatureMatch");

constexpr const char* kRemedy =
    "restore a copy of the database, or delete the matches (colmap database_cleaner) and match "
    "again";
using RowMajorMatrix3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

int64_t PairId(ImagePair pair) {
  SEAPOINT_CHECK(pair.first < pair.second && pair.second < kMaxImageId);
  return kMaxImageId * static_cast<int64_t>(pair.first) + static_cast<int64_t>(pair.second);
}

FeatureMatches SwapColumns(FeatureMatches matches) {
  for (FeatureMatch& match : matches) std::swap(match.idx1, match.idx2);
  return matches;
}

TwoViewGeometry Swap(TwoViewGeometry geometry) {
  geometry.inliers = SwapColumns(std::move(geometry.inliers));
  if (geometry.F) geometry.F = geometry.F->transpose().eval();
  if (geometry.E) geometry.E = geometry.E->transpose().eval();
  if (geometry.H) geometry.H = geometry.H->inverse().eval();
  if (geometry.cam2_from_cam1) geometry.cam2_from_cam1 = geometry.cam2_from_cam1->Inverse();
  return geometry;
}

void BindMatches(const FeatureMatches& matches, SqlStatement* statement) {
  statement->Bind(static_cast<int64_t>(matches.size()))
      .Bind(2)
      .BindBlob(matches.data(), matches.size() * sizeof(FeatureMatch));
}

// Columns `column`, +1, +2 hold rows, cols, data.
FeatureMatches TakeMatches(const std::string& path, const std::string& who, const SqlStatement& row,
                           int column) {
  const int64_t num_rows = row[column].Int();
  const size_t bytes = row[column + 2].Size();
  if (num_rows < 0 || bytes % sizeof(FeatureMatch) != 0 ||
      bytes / sizeof(FeatureMatch) != static_cast<uint64_t>(num_rows) ||
      (num_rows > 0 && row[column + 1].Int() != 2)) {
    throw Error(path,
                who + " are damaged: " + std::to_string(bytes) + " bytes for " +
                    std::to_string(num_rows) + " rows",
                kRemedy);
  }
  FeatureMatches matches(static_cast<size_t>(num_rows));
  if (num_rows > 0) std::memcpy(matches.data(), row[column + 2].Blob(), bytes);
  return matches;
}

// nullopt for NULL, an empty blob and all zeros, which COLMAP 3.8 writes for "not computed".
template <typename Matrix>
std::optional<Matrix> TakeMatrix(const std::string& path, const std::string& who,
                                 const SqlStatement& row, int column) {
  if (row[column].IsNull() || row[column].Size() == 0) return std::nullopt;
  Matrix matrix;
  if (row[column].Size() != sizeof(double) * static_cast<size_t>(matrix.size())) {
    throw Error(path, who + " has a damaged matrix or pose", kRemedy);
  }
  std::memcpy(matrix.data(), row[column].Blob(), row[column].Size());
  if (!matrix.allFinite()) throw Error(path, who + " is not finite", kRemedy);
  if (matrix.isZero(0)) return std::nullopt;
  return matrix;
}

std::string PairText(ImagePair pair) {
  return "images " + std::to_string(pair.first) + " and " + std::to_string(pair.second);
}

void WriteRaw(const SqlConnection& db, int64_t pair_id, const FeatureMatches& matches) {
  SqlStatement row(db,
                   "INSERT OR REPLACE INTO matches(pair_id, rows, cols, data) "
                   "VALUES(?, ?, ?, ?)");
  row.Bind(pair_id);
  BindMatches(matches, &row);
  row.Run();
}

void WriteGeometry(const SqlConnection& db, bool has_poses, int64_t pair_id,
                   const TwoViewGeometry& geometry) {
  SqlStatement row(db, std::string("INSERT OR REPLACE INTO two_view_geometries(pair_id, rows, "
                                   "cols, data, config, F, E, H") +
                           (has_poses ? ", qvec, tvec) VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?)"
                                      : ") VALUES(?, ?, ?, ?, ?, ?, ?, ?)"));
  row.Bind(pair_id);
  BindMatches(geometry.inliers, &row);
  row.Bind(static_cast<int64_t>(geometry.config));
  RowMajorMatrix3d blobs[3];
  const std::optional<Eigen::Matrix3d>* matrices[3] = {&geometry.F, &geometry.E, &geometry.H};
  for (int i = 0; i < 3; ++i) {
    if (!matrices[i]->has_value()) {
      row.BindNull();
      continue;
    }
    blobs[i] = **matrices[i];
    row.BindBlob(blobs[i].data(), sizeof(double) * 9);
  }
  Eigen::Vector4d qvec;
  Eigen::Vector3d tvec;
  if (has_poses && geometry.cam2_from_cam1) {
    const Eigen::Quaterniond& q = geometry.cam2_from_cam1->rotation;
    qvec << q.w(), q.x(), q.y(), q.z();
    tvec = geometry.cam2_from_cam1->translation;
    row.BindBlob(qvec.data(), sizeof(double) * 4).BindBlob(tvec.data(), sizeof(double) * 3);
  } else if (has_poses) {
    row.BindNull().BindNull();
  }
  row.Run();
}

// Columns 7 and 8 of `row`: qvec and tvec.
std::optional<Rigid3d> TakePose(const std::string& path, const std::string& who,
                                const SqlStatement& row) {
  const auto qvec = TakeMatrix<Eigen::Vector4d>(path, who, row, 7);
  const auto tvec = TakeMatrix<Eigen::Vector3d>(path, who, row, 8);
  if (!qvec) return std::nullopt;
  Rigid3d pose;
  pose.rotation = Eigen::Quaterniond((*qvec)[0], (*qvec)[1], (*qvec)[2], (*qvec)[3]).normalized();
  pose.translation = tvec.value_or(Eigen::Vector3d::Zero());
  return pose;
}

void CheckIndices(const SqlConnection& db, ImagePair pair, const FeatureMatches& matches,
                  const char* table) {
  if (matches.empty()) return;
  int64_t num_keypoints[2] = {0, 0};
  for (int i = 0; i < 2; ++i) {
    SqlStatement row(db, "SELECT rows FROM keypoints WHERE image_id = ?");
    row.Bind(static_cast<int64_t>(i == 0 ? pair.first : pair.second));
    if (row.Step()) num_keypoints[i] = row[0].Int();
  }
  for (const FeatureMatch& match : matches) {
    if (match.idx1 >= num_keypoints[0] || match.idx2 >= num_keypoints[1]) {
      throw Error(db.path,
                  std::string(table) + " of " + PairText(pair) + " name keypoints " +
                      std::to_string(match.idx1) + " and " + std::to_string(match.idx2) +
                      ", but the images have " + std::to_string(num_keypoints[0]) + " and " +
                      std::to_string(num_keypoints[1]),
                  kRemedy);
    }
  }
}

// The pairs whose row fulfils `condition`, both images of which are in the database; by pair_id.
std::vector<ImagePair> ReadPairs(const ColmapDatabase& database, const std::string& condition) {
  std::vector<ImagePair> pairs;
  SqlStatement rows(database.Connection(),
                    "SELECT pair_id / ?1 AS id1, pair_id % ?1 AS id2 FROM two_view_geometries "
                    "WHERE " +
                        condition +
                        " AND EXISTS(SELECT 1 FROM images WHERE image_id = id1) "
                        "AND EXISTS(SELECT 1 FROM images WHERE image_id = id2) ORDER BY pair_id");
  rows.Bind(kMaxImageId);
  while (rows.Step()) {
    const ImagePair pair(static_cast<uint32_t>(rows[0].Int()),
                         static_cast<uint32_t>(rows[1].Int()));
    if (pair.first < pair.second) pairs.push_back(pair);
  }
  return pairs;
}

constexpr char kMatchingTable[] = "seapoint_matching";

std::vector<const char*> TablesOfPairs(const ColmapDatabase& database) {
  std::vector<const char*> tables = {"matches", "two_view_geometries"};
  if (HasColumn(database.Connection(), kMatchingTable, "pair_id")) tables.push_back(kMatchingTable);
  return tables;
}

}  // namespace

bool HasMatches(const ColmapDatabase& database, ImagePair pair) {
  return HasRow(
      database.Connection(),
      "SELECT 1 FROM two_view_geometries WHERE pair_id = ? AND (rows <> 0 OR data IS NOT NULL)",
      PairId(pair));
}

void WriteMatches(ColmapDatabase* database, uint32_t image_id1, uint32_t image_id2,
                  const FeatureMatches& raw, const TwoViewGeometry& geometry) {
  if (image_id1 > image_id2) {
    return WriteMatches(database, image_id2, image_id1, SwapColumns(raw), Swap(geometry));
  }
  const SqlConnection& db = database->Connection();
  const int64_t pair_id = PairId({image_id1, image_id2});
  SqlSavepoint savepoint(db);
  WriteRaw(db, pair_id, raw);
  WriteGeometry(db, database->Extras().has_poses, pair_id, geometry);
  savepoint.Release();
}

FeatureMatches ReadMatches(const ColmapDatabase& database, ImagePair pair) {
  const SqlConnection& db = database.Connection();
  SqlStatement row(db, "SELECT rows, cols, data FROM matches WHERE pair_id = ?");
  row.Bind(PairId(pair));
  if (!row.Step()) return {};
  FeatureMatches matches = TakeMatches(db.path, "the matches of " + PairText(pair), row, 0);
  CheckIndices(db, pair, matches, "the matches");
  return matches;
}

TwoViewGeometry ReadTwoViewGeometry(const ColmapDatabase& database, ImagePair pair) {
  const SqlConnection& db = database.Connection();
  const bool has_poses = database.Extras().has_poses;
  TwoViewGeometry geometry;
  SqlStatement row(db, std::string("SELECT rows, cols, data, config, F, E, H") +
                           (has_poses ? ", qvec, tvec" : "") +
                           " FROM two_view_geometries WHERE pair_id = ?");
  row.Bind(PairId(pair));
  if (!row.Step()) return geometry;
  const std::string who = "the two-view geometry of " + PairText(pair);
  geometry.inliers = TakeMatches(db.path, "the verified matches of " + PairText(pair), row, 0);
  CheckIndices(db, pair, geometry.inliers, "the verified matches");
  const int64_t config = row[3].Int();
  if (config >= 0 && config <= static_cast<int64_t>(TwoViewConfig::kPlanarOrPanoramic)) {
    geometry.config = static_cast<TwoViewConfig>(config);
  }
  std::optional<Eigen::Matrix3d>* matrices[3] = {&geometry.F, &geometry.E, &geometry.H};
  for (int i = 0; i < 3; ++i) {
    const auto matrix = TakeMatrix<RowMajorMatrix3d>(db.path, who, row, 4 + i);
    if (matrix) *matrices[i] = *matrix;
  }
  if (has_poses) geometry.cam2_from_cam1 = TakePose(db.path, who, row);
  return geometry;
}

std::vector<ImagePair> ReadVerifiedPairs(const ColmapDatabase& database) {
  return ReadPairs(database, "rows > 0");
}

std::vector<ImagePair> ReadTriedPairs(const ColmapDatabase& database) {
  return ReadPairs(database, "(rows <> 0 OR config <> 0)");
}

std::set<ImagePair> PairsMatchedOtherwise(const ColmapDatabase& database,
                                          const std::string& fingerprint) {
  const SqlConnection& db = database.Connection();
  std::set<ImagePair> pairs;
  if (!HasColumn(db, kMatchingTable, "fingerprint")) return pairs;
  SqlStatement rows(db,
                    "SELECT pair_id / ?1, pair_id % ?1 FROM seapoint_matching "
                    "WHERE fingerprint NOT IN ('', ?2)");
  rows.Bind(kMaxImageId).Bind(fingerprint);
  while (rows.Step()) {
    pairs.emplace(static_cast<uint32_t>(rows[0].Int()), static_cast<uint32_t>(rows[1].Int()));
  }
  return pairs;
}

void NoteMatching(ColmapDatabase* database, ImagePair pair, const std::string& fingerprint) {
  const SqlConnection& db = database->Connection();
  if (!HasColumn(db, kMatchingTable, "fingerprint")) {
    RunSql(db,
           "CREATE TABLE IF NOT EXISTS seapoint_matching(pair_id INTEGER PRIMARY KEY NOT NULL, "
           "fingerprint TEXT NOT NULL)");
  }
  SqlStatement(db, "INSERT OR REPLACE INTO seapoint_matching(pair_id, fingerprint) VALUES(?, ?)")
      .Bind(PairId(pair))
      .Bind(fingerprint)
      .Run();
}

void DeleteMatchesOfImage(ColmapDatabase* database, uint32_t image_id) {
  for (const char* table : TablesOfPairs(*database)) {
    SqlStatement(database->Connection(), std::string("DELETE FROM ") + table +
                                             " WHERE pair_id / ?2 = ?1 OR pair_id % ?2 = ?1")
        .Bind(static_cast<int64_t>(image_id))
        .Bind(kMaxImageId)
        .Run();
  }
}

void DeleteMatchesOfPair(ColmapDatabase* database, ImagePair pair) {
  for (const char* table : TablesOfPairs(*database)) {
    SqlStatement(database->Connection(), std::string("DELETE FROM ") + table + " WHERE pair_id = ?")
        .Bind(PairId(pair))
        .Run();
  }
}

}  // namespace colmap_seapoint
