// A thin cover over SQLite's C functions: every failure becomes an Error that names the file, what
// was found and what to do. Only io/colmap uses it.
#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <string>

namespace colmap_seapoint {

// An open database and the path by which errors name it. Whoever opened it closes it.
struct SqlConnection {
  std::string path;
  sqlite3* handle = nullptr;
};

// `code`: what SQLite returned; `while_doing`: what was tried, e.g. "reading keypoints". The text
// of the connection's last error is added.
[[noreturn]] void ThrowSqliteError(const SqlConnection& connection, int code,
                                   const std::string& while_doing);

// For statements that take no parameters and whose rows nobody reads.
void RunSql(const SqlConnection& connection, const std::string& sql);

// One column of the row that SqlStatement::Step() has reached; void after the next Step().
class SqlColumn {
 public:
  SqlColumn(sqlite3_stmt* statement, int index) : statement_(statement), index_(index) {}

  bool IsNull() const { return sqlite3_column_type(statement_, index_) == SQLITE_NULL; }
  int64_t Int() const { return sqlite3_column_int64(statement_, index_); }
  double Real() const { return sqlite3_column_double(statement_, index_); }
  std::string Text() const;  // "" for NULL
  const void* Blob() const { return sqlite3_column_blob(statement_, index_); }
  // Bytes of the blob or text.
  size_t Size() const { return static_cast<size_t>(sqlite3_column_bytes(statement_, index_)); }

 private:
  sqlite3_stmt* statement_;
  int index_;
};

// The connection must outlive the statement.
class SqlStatement {
 public:
  SqlStatement(const SqlConnection& connection, const std::string& sql);
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

  SqlColumn operator[](int column) const { return {statement_, column}; }

 private:
  SqlStatement& Bound(int code);

  const SqlConnection& connection_;
  std::string sql_;
  sqlite3_stmt* statement_ = nullptr;
  int next_parameter_ = 1;
};

// The key of the row that was inserted last.
int64_t LastRowId(const SqlConnection& connection);

bool HasColumn(const SqlConnection& connection, const std::string& table,
               const std::string& column);
bool HasRows(const SqlConnection& connection, const std::string& table);
// `sql`: a query of one parameter, an id.
bool HasRow(const SqlConnection& connection, const std::string& sql, int64_t id);

// Undoes everything since its construction unless Release() was called; also works inside a
// transaction.
class SqlSavepoint {
 public:
  explicit SqlSavepoint(const SqlConnection& connection);
  ~SqlSavepoint();
  SqlSavepoint(const SqlSavepoint&) = delete;
  SqlSavepoint& operator=(const SqlSavepoint&) = delete;

  void Release();

 private:
  const SqlConnection& connection_;
  bool is_released_ = false;
};

}  // namespace colmap_seapoint
