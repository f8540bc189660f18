#include "colmap_seapoint/io/files/sqlite.h"

#include <algorithm>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/system/system_error.h"

namespace colmap_seapoint {
namespace {

struct Diagnosis {
  std::string finding;
  std::string remedy;
};

Diagnosis Diagnose(int code) {
  switch (code & 0xff) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return {"the database is locked by another program",
              "close COLMAP or whatever uses it, and run again"};
    case SQLITE_FULL:
      return {"the disk is full", "free some space and run again; what was done is kept"};
    case SQLITE_NOTADB:
      return {"is not a database", "give a COLMAP database, or another name for a new one"};
    case SQLITE_CORRUPT:
      return {"the database is damaged", "restore a copy, or delete it and run again"};
    case SQLITE_READONLY:
    case SQLITE_PERM:
    case SQLITE_AUTH:
      return {"the database cannot be written",
              "change the permissions of the file and its folder, or choose another place"};
    case SQLITE_CANTOPEN:
      return {"the database cannot be opened",
              "check that the folder exists and that you may read and write there"};
    case SQLITE_IOERR:
      return {"the disk fails", "check the disk and its free space, and run again"};
    default:
      return {"the database refuses", "check that it is a COLMAP database"};
  }
}

std::string FirstWords(const std::string& sql) { return sql.substr(0, sql.find('(')); }

}  // namespace

void ThrowSqliteError(const SqlConnection& connection, int code, const std::string& while_doing) {
  const Diagnosis diagnosis = Diagnose(code);
  std::string detail = while_doing;
  if (connection.handle != nullptr) {
    detail += std::string(": ") + sqlite3_errmsg(connection.handle);
    const int primary = code & 0xff;
    const int error_number = sqlite3_system_errno(connection.handle);
    if (error_number != 0 && (primary == SQLITE_IOERR || primary == SQLITE_CANTOPEN)) {
      detail += ", " + SystemText(error_number);
    }
  }
  std::replace(detail.begin(), detail.end(), '\n', ' ');
  throw Error(connection.path, diagnosis.finding + " (" + detail + ")", diagnosis.remedy);
}

void RunSql(const SqlConnection& connection, const std::string& sql) {
  const int code = sqlite3_exec(connection.handle, sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) ThrowSqliteError(connection, code, FirstWords(sql));
}

std::string SqlColumn::Text() const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_, index_));
  if (text == nullptr) return {};
  return std::string(text, Size());
}

SqlStatement::SqlStatement(const SqlConnection& connection, const std::string& sql)
    : connection_(connection), sql_(sql) {
  const int code = sqlite3_prepare_v2(connection.handle, sql.c_str(), -1, &statement_, nullptr);
  if (code != SQLITE_OK) ThrowSqliteError(connection_, code, FirstWords(sql_));
}

SqlStatement& SqlStatement::Bound(int code) {
  if (code != SQLITE_OK) ThrowSqliteError(connection_, code, FirstWords(sql_));
  ++next_parameter_;
  return *this;
}

SqlStatement& SqlStatement::Bind(int64_t value) {
  return Bound(sqlite3_bind_int64(statement_, next_parameter_, value));
}

SqlStatement& SqlStatement::Bind(const std::string& text) {
  return Bound(sqlite3_bind_text64(statement_, next_parameter_, text.data(), text.size(),
                                   SQLITE_STATIC, SQLITE_UTF8));
}

SqlStatement& SqlStatement::BindBlob(const void* data, size_t size) {
  const void* const not_null = size == 0 ? "" : data;
  return Bound(sqlite3_bind_blob64(statement_, next_parameter_, not_null, size, SQLITE_STATIC));
}

SqlStatement& SqlStatement::BindNull() {
  return Bound(sqlite3_bind_null(statement_, next_parameter_));
}

bool SqlStatement::Step() {
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  ThrowSqliteError(connection_, code, FirstWords(sql_));
}

int64_t LastRowId(const SqlConnection& connection) {
  return sqlite3_last_insert_rowid(connection.handle);
}

bool HasColumn(const SqlConnection& connection, const std::string& table,
               const std::string& column) {
  SqlStatement columns(connection, "PRAGMA table_info(" + table + ")");
  while (columns.Step()) {
    if (columns[1].Text() == column) return true;
  }
  return false;
}

bool HasRows(const SqlConnection& connection, const std::string& table) {
  return SqlStatement(connection, "SELECT 1 FROM " + table + " LIMIT 1").Step();
}

bool HasRow(const SqlConnection& connection, const std::string& sql, int64_t id) {
  return SqlStatement(connection, sql).Bind(id).Step();
}

SqlSavepoint::SqlSavepoint(const SqlConnection& connection) : connection_(connection) {
  RunSql(connection_, "SAVEPOINT seapoint");
}

SqlSavepoint::~SqlSavepoint() {
  // SQLite has rolled back already after some errors (e.g. a full disk).
  if (is_released_ || sqlite3_get_autocommit(connection_.handle) != 0) return;
  sqlite3_exec(connection_.handle, "ROLLBACK TO seapoint; RELEASE seapoint", nullptr, nullptr,
               nullptr);
}

void SqlSavepoint::Release() {
  RunSql(connection_, "RELEASE seapoint");
  is_released_ = true;
}

}  // namespace colmap_seapoint
