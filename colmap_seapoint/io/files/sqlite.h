// A thin cover over SQLite's C functions: every failure becomes an Error that names the file, what
// was found and what to do. For colmap_database*.cc only.
#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <string>

namespace colmap_seapoint {

// `while_doing`: "reading keypoints". Uses the connection's last error code.
[[noreturn]] void ThrowSqliteError(const std::string& path, sqlite3* db, int code,
                                   const std::string& while_doing);

void RunSql(const std::string& path, sqlite3* db, const std::string& sql);

class SqlStatement {
 public:
  SqlStatement(const std::string& path, sqlite3* db, const std::string& sql);
  ~SqlStatement() { sqlite3_finalize(statement_); }
  SqlStatement(const SqlStatement&) = delete;
  SqlStatement& operator=(const SqlStatement&) = delete;

  // Parameters are bound one after the other. Blobs and text must outlive the last Step().
  SqlStatement& Bind(int64_t value);
  SqlStatement& Bind(const std::string& text);
  SqlStatement& BindBlob(const void* data, size_t size);  // size 0: an empty blob, not NULL
  SqlStatement& BindNull();

  bool Step();  // true: a row is there to be read
  void Run() {
    while (Step()) {
    }
  }

  int64_t Int(int column) const { return sqlite3_column_int64(statement_, column); }
  double Real(int column) const { return sqlite3_column_double(statement_, column); }
  bool IsNull(int column) const { return sqlite3_column_type(statement_, column) == SQLITE_NULL; }
  bool IsInteger(int column) const {
    return sqlite3_column_type(statement_, column) == SQLITE_INTEGER;
  }
  std::string Text(int column) const;
  const void* Blob(int column) const { return sqlite3_column_blob(statement_, column); }
  size_t BlobSize(int column) const {
    return static_cast<size_t>(sqlite3_column_bytes(statement_, column));
  }

 private:
  void CheckBind(int code);

  const std::string& path_;
  sqlite3* db_;
  std::string sql_;
  sqlite3_stmt* statement_ = nullptr;
  int next_parameter_ = 1;
};

// Undoes everything since its construction unless Release() was called; also works inside a
// transaction.
class SqlSavepoint {
 public:
  SqlSavepoint(const std::string& path, sqlite3* db) : path_(path), db_(db) {
    RunSql(path_, db_, "SAVEPOINT seapoint");
  }
  ~SqlSavepoint() {
    if (is_released_ || sqlite3_get_autocommit(db_) != 0) return;
    sqlite3_exec(db_, "ROLLBACK TO seapoint; RELEASE seapoint", nullptr, nullptr, nullptr);
  }
  SqlSavepoint(const SqlSavepoint&) = delete;
  SqlSavepoint& operator=(const SqlSavepoint&) = delete;

  void Release() {
    RunSql(path_, db_, "RELEASE seapoint");
    is_released_ = true;
  }

 private:
  const std::string& path_;
  sqlite3* db_;
  bool is_released_ = false;
};

}  // namespace colmap_seapoint
