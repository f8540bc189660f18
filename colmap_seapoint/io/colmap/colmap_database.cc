#include "colmap_seapoint/io/colmap/colmap_database.h"

#include <cstdio>
#include <cstdlib>
#include <string>
#include <system_error>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/sqlite.h"

namespace colmap_seapoint {
namespace {

void CheckPath(const std::string& path, ColmapDatabase::Mode mode) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (std::filesystem::is_directory(status)) {
    throw Error(path, "is a folder, not a database",
                "give the name of a file, e.g. " + path + "/database.db");
  }
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  if (!parent.empty() && !std::filesystem::is_directory(parent, error)) {
    throw Error(path, "its folder does not exist", "create the folder first");
  }
  if (mode == ColmapDatabase::Mode::kCreateIfMissing) return;
  if (!std::filesystem::exists(status)) {
    throw Error(path, "there is no such database", "check the path, or extract features first");
  }
  if (std::filesystem::file_size(path, error) == 0 && !error) {
    throw Error(path, "is an empty file, not a database", "delete it and extract features again");
  }
}

// Opens the file as it is, without the side files of a WAL database: for folders that cannot be
// written.
std::string ImmutableUri(const std::string& path) {
  std::string uri = "file:";
  for (const char c : std::filesystem::absolute(path).string()) {
    if (c == '?' || c == '#' || c == '%') {
      char escaped[4];
      std::snprintf(escaped, sizeof(escaped), "%%%02X", static_cast<unsigned char>(c));
      uri += escaped;
    } else {
      uri += c;
    }
  }
  return uri + "?immutable=1";
}

// Whether quick_check found not a damaged page but one that could not be read: it says "failed to
// get page 82", or "unable to get the page. error code=266" with SQLite's code.
bool ReportsFailingDisk(const std::string& finding) {
  static constexpr char kCode[] = "error code=";
  if (finding.find("failed to get page ") != std::string::npos) return true;
  const size_t place = finding.find(kCode);
  if (place == std::string::npos) return false;
  return (std::atoi(finding.c_str() + place + sizeof(kCode) - 1) & 0xff) == SQLITE_IOERR;
}

void ChooseJournal(const SqlConnection& connection) {
  // WAL with NORMAL is consistent after kill -9 and after a power cut, and keeps every commit after
  // kill -9. Where the file system cannot do WAL, the journal needs FULL for the same.
  SqlStatement journal(connection, "PRAGMA journal_mode = WAL");
  const bool is_wal = journal.Step() && journal[0].Text() == "wal";
  RunSql(connection, is_wal ? "PRAGMA synchronous = NORMAL" : "PRAGMA synchronous = FULL");
}

}  // namespace

ColmapDatabase::ColmapDatabase(const std::filesystem::path& path, Mode mode, Check check,
                               int busy_timeout_ms)
    : connection_(std::make_unique<SqlConnection>()) {
  connection_->path = path.string();
  CheckPath(connection_->path, mode);
  try {
    Open(mode, busy_timeout_ms);
    if (check == Check::kWhole) CheckWhole();
    if (mode == Mode::kCreateIfMissing && !HasRows(*connection_, "sqlite_master")) {
      RunSql(*connection_, kColmapSchema);
    }
    extras_ = CheckSchema(*connection_, mode != Mode::kReadOnly);
    if (mode != Mode::kReadOnly) {
      ChooseJournal(*connection_);  // the first byte that changes: foreign ones are refused by now
      // Permissions, locks and a full disk show now, not after hours of work.
      RunSql(*connection_, "BEGIN IMMEDIATE");
      RunSql(*connection_, "ROLLBACK");
    }
  } catch (...) {
    sqlite3_close_v2(connection_->handle);
    throw;
  }
}

ColmapDatabase::~ColmapDatabase() {
  if (connection_) sqlite3_close_v2(connection_->handle);
}

ColmapDatabase::ColmapDatabase(ColmapDatabase&& other) noexcept = default;

void ColmapDatabase::Open(Mode mode, int busy_timeout_ms) {
  const std::string& path = connection_->path;
  sqlite3*& db = connection_->handle;
  const int flags = mode == Mode::kReadOnly    ? SQLITE_OPEN_READONLY
                    : mode == Mode::kReadWrite ? SQLITE_OPEN_READWRITE
                                               : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  int code = sqlite3_open_v2(path.c_str(), &db, flags, nullptr);
  if (code == SQLITE_OK) {
    sqlite3_busy_timeout(db, busy_timeout_ms);
    code = sqlite3_exec(db, "SELECT count(*) FROM sqlite_master", nullptr, nullptr, nullptr);
  }
  std::error_code error;
  if (mode == Mode::kReadOnly &&
      ((code & 0xff) == SQLITE_CANTOPEN || (code & 0xff) == SQLITE_READONLY) &&
      !std::filesystem::exists(path + "-wal", error)) {
    // A WAL database in a folder where SQLite cannot put its side files.
    sqlite3_close_v2(db);
    db = nullptr;
    code = sqlite3_open_v2(ImmutableUri(path).c_str(), &db, flags | SQLITE_OPEN_URI, nullptr);
  }
  if (code != SQLITE_OK) ThrowSqliteError(*connection_, code, "opening it");
  RunSql(*connection_, "PRAGMA foreign_keys = ON");
}

void ColmapDatabase::CheckWhole() const {
  SqlStatement check(*connection_, "PRAGMA quick_check(1)");
  if (check.Step() && check[0].Text() == "ok") return;
  std::string finding = check[0].Text();
  for (char& c : finding) {
    if (c == '\n') c = ' ';
  }
  if (ReportsFailingDisk(finding)) {
    // A healthy database on a disk that fails: by no means to be deleted.
    ThrowSqliteError(*connection_, SQLITE_IOERR, "checking it, " + finding);
  }
  throw Error(connection_->path, "the database is damaged (" + finding + ")",
              "restore a copy, or delete it and run again");
}

void ColmapDatabase::Finish() {
  SqlStatement(*connection_, "PRAGMA wal_checkpoint(PASSIVE)").Run();
}

DatabaseTransaction::DatabaseTransaction(ColmapDatabase* database)
    : connection_(database->Connection()) {
  RunSql(connection_, "BEGIN IMMEDIATE");
}

DatabaseTransaction::~DatabaseTransaction() {
  // SQLite has rolled back already after some errors (e.g. a full disk).
  if (!is_open_ || sqlite3_get_autocommit(connection_.handle) != 0) return;
  sqlite3_exec(connection_.handle, "ROLLBACK", nullptr, nullptr, nullptr);
}

void DatabaseTransaction::Commit() {
  RunSql(connection_, "COMMIT");
  is_open_ = false;
}

}  // namespace colmap_seapoint
