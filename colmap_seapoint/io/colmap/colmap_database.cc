#include "colmap_seapoint/io/colmap/colmap_database.h"

#include <cmath>
#include <cstring>
#include <system_error>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/sqlite.h"
#include "colmap_seapoint/io/image/image_file.h"

namespace colmap_seapoint {
namespace {

constexpr int kCameraSensorType = 0;  // COLMAP's SensorType::CAMERA

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

// A file of that many bytes that opens with no side file: for folders that cannot be written.
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

}  // namespace

ColmapDatabase::ColmapDatabase(const std::filesystem::path& path, Mode mode, int busy_timeout_ms)
    : path_(path.string()) {
  CheckPath(path_, mode);
  try {
    Open(mode, busy_timeout_ms);
    CheckIntegrity();
    if (mode == Mode::kCreateIfMissing && !HasRows("sqlite_master"))
      RunSql(path_, db_, kColmapSchema);
    extras_ = CheckSchema(path_, db_, mode != Mode::kReadOnly);
    if (mode != Mode::kReadOnly) {
      ChooseJournal();  // the first byte that changes: foreign databases are refused by now
      // Permissions, locks and a full disk show now, not after hours of work.
      RunSql(path_, db_, "BEGIN IMMEDIATE");
      RunSql(path_, db_, "ROLLBACK");
    }
  } catch (...) {
    sqlite3_close_v2(db_);
    throw;
  }
}

ColmapDatabase::~ColmapDatabase() { sqlite3_close_v2(db_); }

ColmapDatabase::ColmapDatabase(ColmapDatabase&& other) noexcept
    : path_(std::move(other.path_)),
      db_(std::exchange(other.db_, nullptr)),
      extras_(other.extras_) {}

void ColmapDatabase::Open(Mode mode, int busy_timeout_ms) {
  const int flags = mode == Mode::kReadOnly    ? SQLITE_OPEN_READONLY
                    : mode == Mode::kReadWrite ? SQLITE_OPEN_READWRITE
                                               : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  int code = sqlite3_open_v2(path_.c_str(), &db_, flags, nullptr);
  if (code == SQLITE_OK) {
    sqlite3_busy_timeout(db_, busy_timeout_ms);
    code = sqlite3_exec(db_, "SELECT count(*) FROM sqlite_master", nullptr, nullptr, nullptr);
  }
  std::error_code error;
  if (mode == Mode::kReadOnly &&
      ((code & 0xff) == SQLITE_CANTOPEN || (code & 0xff) == SQLITE_READONLY) &&
      !std::filesystem::exists(path_ + "-wal", error)) {
    // A WAL database in a folder where SQLite cannot put its side files.
    sqlite3_close_v2(db_);
    db_ = nullptr;
    code = sqlite3_open_v2(ImmutableUri(path_).c_str(), &db_, flags | SQLITE_OPEN_URI, nullptr);
  }
  if (code != SQLITE_OK) ThrowSqliteError(path_, db_, code, "opening it");
  RunSql(path_, db_, "PRAGMA foreign_keys = ON");
}

void ColmapDatabase::ChooseJournal() {
  // WAL with NORMAL is consistent after kill -9 and after a power cut, and keeps every commit after
  // kill -9. Where the file system cannot do WAL, the journal needs FULL for the same.
  SqlStatement journal(path_, db_, "PRAGMA journal_mode = WAL");
  const bool is_wal = journal.Step() && journal.Text(0) == "wal";
  RunSql(path_, db_, is_wal ? "PRAGMA synchronous = NORMAL" : "PRAGMA synchronous = FULL");
}

void ColmapDatabase::CheckIntegrity() const {
  SqlStatement check(path_, db_, "PRAGMA quick_check(1)");
  if (check.Step() && check.Text(0) == "ok") return;
  std::string finding = check.Text(0);
  for (char& c : finding) {
    if (c == '\n') c = ' ';
  }
  throw Error(path_, "the database is damaged (" + finding + ")",
              "restore a copy, or delete it and run again");
}

bool ColmapDatabase::HasColumn(const std::string& table, const std::string& column) const {
  SqlStatement columns(path_, db_, "PRAGMA table_info(" + table + ")");
  while (columns.Step()) {
    if (columns.Text(1) == column) return true;
  }
  return false;
}

bool ColmapDatabase::HasRow(const std::string& sql, int64_t id) const {
  return SqlStatement(path_, db_, sql).Bind(id).Step();
}

bool ColmapDatabase::HasRows(const std::string& table) const {
  return SqlStatement(path_, db_, "SELECT 1 FROM " + table + " LIMIT 1").Step();
}

void ColmapDatabase::BeginTransaction() { RunSql(path_, db_, "BEGIN IMMEDIATE"); }
void ColmapDatabase::CommitTransaction() { RunSql(path_, db_, "COMMIT"); }
void ColmapDatabase::RollbackTransaction() {
  // SQLite has rolled back already after some errors (e.g. a full disk).
  if (sqlite3_get_autocommit(db_) == 0) RunSql(path_, db_, "ROLLBACK");
}

std::map<uint32_t, Camera> ColmapDatabase::ReadCameras() const {
  std::map<uint32_t, Camera> cameras;
  SqlStatement rows(path_, db_,
                    "SELECT camera_id, model, width, height, params, prior_focal_length "
                    "FROM cameras ORDER BY camera_id");
  while (rows.Step()) {
    const std::string who = "camera " + std::to_string(rows.Int(0));
    const int64_t model_id = rows.Int(1);
    const CameraModelInfo* info =
        model_id < 0 || model_id > 1000 ? nullptr : FindCameraModel(static_cast<int>(model_id));
    if (info == nullptr) {
      throw Error(path_, who + " has the unknown camera model " + std::to_string(model_id),
                  "use one of " + CameraModelNames());
    }
    Camera camera;
    camera.camera_id = static_cast<uint32_t>(rows.Int(0));
    camera.model = info->model;
    if (rows.Int(2) <= 0 || rows.Int(3) <= 0 || rows.Int(2) > 1 << 20 || rows.Int(3) > 1 << 20) {
      throw Error(path_, who + " has an impossible size", "restore a copy of the database");
    }
    camera.width = static_cast<int>(rows.Int(2));
    camera.height = static_cast<int>(rows.Int(3));
    camera.params.resize(static_cast<size_t>(info->num_params));
    bool is_legal = rows.BlobSize(4) == camera.params.size() * sizeof(double);
    if (is_legal) std::memcpy(camera.params.data(), rows.Blob(4), rows.BlobSize(4));
    for (const double param : camera.params) is_legal = is_legal && std::isfinite(param);
    if (!is_legal) {
      throw Error(path_, who + " has damaged parameters", "restore a copy of the database");
    }
    camera.has_prior_focal_length = rows.Int(5) != 0;
    cameras.emplace(camera.camera_id, std::move(camera));
  }
  return cameras;
}

std::vector<DatabaseImage> ColmapDatabase::ReadImages() const {
  std::vector<DatabaseImage> images;
  SqlStatement rows(path_, db_, "SELECT image_id, camera_id, name FROM images ORDER BY image_id");
  while (rows.Step()) {
    images.push_back(
        {static_cast<uint32_t>(rows.Int(0)), static_cast<uint32_t>(rows.Int(1)), rows.Text(2)});
    if (!IsSafeImageName(images.back().name)) {
      throw Error(path_,
                  "image " + std::to_string(images.back().image_id) + " is named '" +
                      images.back().name +
                      "', which is empty, absolute or leads out of the image folder",
                  "delete or rename it in the database");
    }
  }
  return images;
}

uint32_t ColmapDatabase::AddCamera(const Camera& camera) {
  const CameraModelInfo* info = FindCameraModel(static_cast<int>(camera.model));
  SEAPOINT_CHECK(info != nullptr);
  SEAPOINT_CHECK(camera.params.size() == static_cast<size_t>(info->num_params));
  SqlStatement(path_, db_,
               "INSERT INTO cameras(model, width, height, params, prior_focal_length) "
               "VALUES(?, ?, ?, ?, ?)")
      .Bind(static_cast<int64_t>(camera.model))
      .Bind(static_cast<int64_t>(camera.width))
      .Bind(static_cast<int64_t>(camera.height))
      .BindBlob(camera.params.data(), camera.params.size() * sizeof(double))
      .Bind(static_cast<int64_t>(camera.has_prior_focal_length ? 1 : 0))
      .Run();
  return static_cast<uint32_t>(sqlite3_last_insert_rowid(db_));
}

uint32_t ColmapDatabase::AddImage(const std::string& name, uint32_t camera_id) {
  if (!IsSafeImageName(name)) {
    throw Error(path_, "'" + name + "' is no legal image name", "rename the picture");
  }
  SqlSavepoint savepoint(path_, db_);
  // Frames are all or nothing: an image without one makes newer COLMAPs abort.
  const bool needs_frame =
      extras_.has_frames && (HasRows("frames") || (HasRows("rigs") && !HasRows("images")));
  SqlStatement(path_, db_, "INSERT INTO images(name, camera_id) VALUES(?, ?)")
      .Bind(name)
      .Bind(static_cast<int64_t>(camera_id))
      .Run();
  const int64_t image_id = sqlite3_last_insert_rowid(db_);
  if (needs_frame) AddFrame(image_id, camera_id);
  savepoint.Release();
  return static_cast<uint32_t>(image_id);
}

// As COLMAP's image reader does: the rig that the camera belongs to, or a new one with it as the
// reference sensor; one frame an image.
void ColmapDatabase::AddFrame(int64_t image_id, int64_t camera_id) {
  int64_t rig_id = -1;
  {
    SqlStatement rig(path_, db_,
                     "SELECT rig_id FROM rigs WHERE ref_sensor_id = ?1 AND ref_sensor_type = ?2 "
                     "UNION ALL SELECT rig_id FROM rig_sensors "
                     "WHERE sensor_id = ?1 AND sensor_type = ?2");
    rig.Bind(camera_id).Bind(static_cast<int64_t>(kCameraSensorType));
    if (rig.Step()) rig_id = rig.Int(0);
  }
  if (rig_id < 0) {
    SqlStatement(path_, db_, "INSERT INTO rigs(ref_sensor_id, ref_sensor_type) VALUES(?, ?)")
        .Bind(camera_id)
        .Bind(static_cast<int64_t>(kCameraSensorType))
        .Run();
    rig_id = sqlite3_last_insert_rowid(db_);
  }
  SqlStatement(path_, db_, "INSERT INTO frames(rig_id) VALUES(?)").Bind(rig_id).Run();
  SqlStatement(path_, db_,
               "INSERT INTO frame_data(frame_id, data_id, sensor_id, sensor_type) "
               "VALUES(?, ?, ?, ?)")
      .Bind(static_cast<int64_t>(sqlite3_last_insert_rowid(db_)))
      .Bind(image_id)
      .Bind(camera_id)
      .Bind(static_cast<int64_t>(kCameraSensorType))
      .Run();
}

}  // namespace colmap_seapoint
