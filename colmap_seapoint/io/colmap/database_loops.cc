#include "colmap_seapoint/io/colmap/database_loops.h"

#include <algorithm>
#include <cstring>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/io/files/sqlite.h"

namespace colmap_seapoint {
namespace {

static_assert(sizeof(ImagePair) == 2 * sizeof(uint32_t), "a row is an ImagePair");

constexpr const char* kOwnTable =
    "CREATE TABLE IF NOT EXISTS seapoint_loop_pairs(id INTEGER PRIMARY KEY NOT NULL CHECK(id = 0), "
    "fingerprint TEXT NOT NULL, data BLOB, data_hash TEXT NOT NULL)";

}  // namespace

std::vector<ImagePair> ReadLoopPairs(const ColmapDatabase& database) {
  const SqlConnection& db = database.Connection();
  if (!HasColumn(db, "seapoint_loop_pairs", "data_hash")) return {};
  SqlStatement row(db, "SELECT data, data_hash FROM seapoint_loop_pairs");
  if (!row.Step()) return {};
  const size_t bytes = row[0].Size();
  if (bytes % sizeof(ImagePair) != 0 || !IsHashOf(row[1].Text(), row[0].Blob(), bytes)) {
    throw Error(db.path, "the list of its loop pairs is damaged",
                "restore a copy of the database, or delete the table seapoint_loop_pairs");
  }
  std::vector<ImagePair> pairs(bytes / sizeof(ImagePair));
  if (bytes > 0) std::memcpy(static_cast<void*>(pairs.data()), row[0].Blob(), bytes);
  return pairs;
}

std::optional<std::vector<ImagePair>> ReadLoopPairs(const ColmapDatabase& database,
                                                    const std::string& fingerprint) {
  const SqlConnection& db = database.Connection();
  if (!HasColumn(db, "seapoint_loop_pairs", "data_hash")) return std::nullopt;
  {
    SqlStatement row(db, "SELECT 1 FROM seapoint_loop_pairs WHERE fingerprint = ?");
    row.Bind(fingerprint);
    if (!row.Step()) return std::nullopt;
  }
  return ReadLoopPairs(database);
}

void WriteLoopPairs(ColmapDatabase* database, const std::string& fingerprint,
                    const std::vector<ImagePair>& pairs) {
  const SqlConnection& db = database->Connection();
  std::vector<ImagePair> kept = pairs;
  std::sort(kept.begin(), kept.end());
  const std::vector<ImagePair> old = ReadLoopPairs(*database);
  SqlSavepoint savepoint(db);
  for (const ImagePair& pair : old) {
    if (std::binary_search(kept.begin(), kept.end(), pair)) continue;
    DeleteMatchesOfPair(database, pair);
  }
  RunSql(db, kOwnTable);
  const size_t bytes = pairs.size() * sizeof(ImagePair);
  const std::string hash = HashBytes(pairs.data(), bytes);
  SqlStatement(db,
               "INSERT OR REPLACE INTO seapoint_loop_pairs(id, fingerprint, data, data_hash) "
               "VALUES(0, ?, ?, ?)")
      .Bind(fingerprint)
      .BindBlob(pairs.data(), bytes)
      .Bind(hash)
      .Run();
  savepoint.Release();
}

}  // namespace colmap_seapoint
