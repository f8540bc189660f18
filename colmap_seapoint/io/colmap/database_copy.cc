#include "colmap_seapoint/io/colmap/database_copy.h"

#include <string>
#include <system_error>

#include "colmap_seapoint/io/files/sqlite.h"

namespace colmap_seapoint {
namespace {

constexpr int kAllPages = -1;

// Closes what it opened, also when that failed.
struct Target {
  explicit Target(const std::string& path) : connection{path, nullptr} {}
  ~Target() { sqlite3_close(connection.handle); }
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  void Open() {
    Check(sqlite3_open_v2(connection.path.c_str(), &connection.handle,
                          SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr));
  }
  void Check(int code) const {
    if (code != SQLITE_OK) ThrowSqliteError(connection, code, "copying the database");
  }

  SqlConnection connection;
};

}  // namespace

void CopyDatabase(const ColmapDatabase& database, const std::filesystem::path& copy) {
  RemoveDatabase(copy);  // what is still in the way fails below
  Target target(copy.string());
  target.Open();
  sqlite3* to = target.connection.handle;
  sqlite3_backup* backup = sqlite3_backup_init(to, "main", database.Connection().handle, "main");
  if (backup == nullptr) target.Check(sqlite3_errcode(to));
  sqlite3_backup_step(backup, kAllPages);
  target.Check(sqlite3_backup_finish(backup));
  RunSql(target.connection, "DROP TABLE IF EXISTS pose_priors");
}

bool HasPosePriorTable(const ColmapDatabase& database) {
  return HasColumn(database.Connection(), "pose_priors", "position");
}

void RemoveDatabase(const std::filesystem::path& path) {
  std::error_code ignored;
  for (const char* suffix : {"", "-wal", "-shm", "-journal"}) {
    std::filesystem::remove(path.string() + suffix, ignored);
  }
}

}  // namespace colmap_seapoint
