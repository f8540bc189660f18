// COLMAP's database, 3.8 to 4.x: one open connection. What is stored in it is read and written by
// free functions, one header a topic: database_images.h, database_features.h, database_matches.h,
// database_priors.h, database_loops.h. This room is the only place that knows the schema: it is
// detected by columns, never by version, and what is there is never changed, only added to.
#pragma once

#include <filesystem>
#include <memory>

#include "colmap_seapoint/io/colmap/colmap_schema.h"

namespace colmap_seapoint {

// All functions that take a database throw Error when it is damaged, locked or cannot be written.
// One thread at a time may use it. What a single call writes lands together or not at all, and
// survives kill -9 from then on; for several calls, see DatabaseTransaction.
class ColmapDatabase {
 public:
  enum class Mode { kReadOnly, kReadWrite, kCreateIfMissing };

  // Whether opening reads the whole file to see that it is not damaged: once a run is enough,
  // as it costs a read of the file.
  enum class Check { kWhole, kNone };

  // Throws Error: missing file, not a database, damaged (with Check::kWhole), locked by another
  // program (waits up to `busy_timeout_ms`), of a shape that we do not know (CheckSchema; nothing
  // is written then), no permission, full disk.
  ColmapDatabase(const std::filesystem::path& path, Mode mode, Check check = Check::kWhole,
                 int busy_timeout_ms = 10000);
  ~ColmapDatabase();
  ColmapDatabase(ColmapDatabase&&) noexcept;

  // SQLite's quick_check. Throws Error with its first finding.
  void CheckWhole() const;

  // The last call of who has written: puts what still stands in SQLite's side file (-wal) into the
  // database itself, so that the one file can be copied or renamed. Closing tries that too, but
  // cannot say that it failed. Throws Error; what was written is kept in the side file then. While
  // another program is reading, part of it stays there, which is no error.
  void Finish();

  // For database_*.cc only.
  const SqlConnection& Connection() const { return *connection_; }
  const SchemaExtras& Extras() const { return extras_; }

 private:
  void Open(Mode mode, int busy_timeout_ms);

  std::unique_ptr<SqlConnection> connection_;
  SchemaExtras extras_;
};

// Everything written between its construction and Commit() lands together or not at all; without
// Commit(), the destructor takes it back. Locks the database against other writers at once. Not to
// be nested.
class DatabaseTransaction {
 public:
  explicit DatabaseTransaction(ColmapDatabase* database);
  ~DatabaseTransaction();
  DatabaseTransaction(const DatabaseTransaction&) = delete;
  DatabaseTransaction& operator=(const DatabaseTransaction&) = delete;

  void Commit();

 private:
  const SqlConnection& connection_;
  bool is_open_ = true;
};

}  // namespace colmap_seapoint
