#include "colmap_seapoint/io/files/sqlite.h"

#include <algorithm>

#include "colmap_seapoint/base/error.h"

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

}  // namespace

void ThrowSqliteError(const std::string& path, sqlite3* db, int code,
                      const std::string& while_doing) {
  const Diagnosis diagnosis = Diagnose(code);
  std::string detail = while_doing;
  if (db != nullptr) detail += std::string(": ") + sqlite3_errmsg(db);
  std::replace(detail.begin(), detail.end(), '\n', ' ');
  throw Error(path, diagnosis.finding + " (" + detail + ")", diagnosis.remedy);
}

void RunSql(const std::string& path, sqlite3* db, const std::string& sql) {
  const int code = sqlite3_exec(db, sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) ThrowSqliteError(path, db, code, sql.substr(0, sql.find('(')));
}

SqlStatement::SqlStatement(const std::string& path, sqlite3* db, const std::string& sql)
    : path_(path), db_(db), sql_(sql) {
  const int code = sqlite3_prepare_v2(db, sql.c_str(), -1, &statement_, nullptr);
  if (code != SQLITE_OK) ThrowSqliteError(path, db, code, sql_.substr(0, sql_.find('(')));
}

void SqlStatement::CheckBind(int code) {
  ++next_parameter_;
  if (code != SQLITE_OK) ThrowSqliteError(path_, db_, code, sql_.substr(0, sql_.find('(')));
}

SqlStatement& SqlStatement::Bind(int64_t value) {
  CheckBind(sqlite3_bind_int64(statement_, next_parameter_, value));
  return *this;
}

SqlStatement& SqlStatement::Bind(const std::string& text) {
  CheckBind(sqlite3_bind_text64(statement_, next_parameter_, text.data(), text.size(),
                                SQLITE_STATIC, SQLITE_UTF8));
  return *this;
}

SqlStatement& SqlStatement::BindBlob(const void* data, size_t size) {
  const void* const not_null = size == 0 ? "" : data;
  CheckBind(sqlite3_bind_blob64(statement_, next_parameter_, not_null, size, SQLITE_STATIC));
  return *this;
}

SqlStatement& SqlStatement::BindNull() {
  CheckBind(sqlite3_bind_null(statement_, next_parameter_));
  return *this;
}

bool SqlStatement::Step() {
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  ThrowSqliteError(path_, db_, code, sql_.substr(0, sql_.find('(')));
}

std::string SqlStatement::Text(int column) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
  if (text == nullptr) return {};
  return std::string(text, BlobSize(column));
}

}  // namespace colmap_seapoint
