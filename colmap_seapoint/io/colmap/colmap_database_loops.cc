#include <algorithm>
#include <cstring>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/io/files/sqlite.h"

namespace colmap_seapoint {
namespace {

static_assert(sizeof(ImagePair) == 2 * sizeof(uint32_t), "a row is an ImagePair");

constexpr int64_t kMaxImageId = 2147483647;
constexpr const char* kOwnTable =
    "CREATE TABLE IF NOT EXISTS seapoint_loop_pairs(id INTEGER PRIMARY KEY NOT NULL CHECK(id = 0), "
    "fingerprint TEXT NOT NULL, data BLOB, data_hash TEXT NOT NULL)";

}  // namespace

std::vector<ImagePair> ColmapDatabase::ReadLoopPairs() const {
  if (!HasColumn("seapoint_loop_pairs", "data_hash")) return {};
  SqlStatement row(path_, db_, "SELECT data, data_hash FROM seapoint_loop_pairs");
  if (!row.Step()) return {};
  const size_t bytes = row.BlobSize(0);
  if (bytes % sizeof(ImagePair) != 0 || HashBytes(row.Blob(0), bytes) != row.Text(1)) {
    throw Error(path_, "the list of its loop pairs is damaged",
                "restore a copy of the database, or delete the table seapoint_loop_pairs");
  }
  std::vector<ImagePair> pairs(bytes / sizeof(ImagePair));
  if (bytes > 0) std::memcpy(static_cast<void*>(pairs.data()), row.Blob(0), bytes);
  return pairs;
}

std::optional<std::vector<ImagePair>> ColmapDatabase::ReadLoopPairs(
    const std::string& fingerprint) const {
  if (!HasColumn("seapoint_loop_pairs", "data_hash")) return std::nullopt;
  {
    SqlStatement row(path_, db_, "SELECT 1 FROM seapoint_loop_pairs WHERE fingerprint = ?");
    row.Bind(fingerprint);
    if (!row.Step()) return std::nullopt;
  }
  return ReadLoopPairs();
}

void ColmapDatabase::WriteLoopPairs(const std::string& fingerprint,
                                    const std::vector<ImagePair>& pairs) {
  std::vector<ImagePair> kept = pairs;
  std::sort(kept.begin(), kept.end());
  const std::vector<ImagePair> old = ReadLoopPairs();
  SqlSavepoint savepoint(path_, db_);
  for (const ImagePair& pair : old) {
    if (std::binary_search(kept.begin(), kept.end(), pair)) continue;
    for (const char* table : {"matches", "two_view_geometries"}) {
      SqlStatement(path_, db_, std::string("DELETE FROM ") + table + " WHERE pair_id = ?")
          .Bind(kMaxImageId * static_cast<int64_t>(pair.first) + static_cast<int64_t>(pair.second))
          .Run();
    }
  }
  RunSql(path_, db_, kOwnTable);
  const size_t bytes = pairs.size() * sizeof(ImagePair);
  const std::string hash = HashBytes(pairs.data(), bytes);
  SqlStatement(path_, db_,
               "INSERT OR REPLACE INTO seapoint_loop_pairs(id, fingerprint, data, data_hash) "
               "VALUES(0, ?, ?, ?)")
      .Bind(fingerprint)
      .BindBlob(pairs.data(), bytes)
      .Bind(hash)
      .Run();
  savepoint.Release();
}

}  // namespace colmap_seapoint
