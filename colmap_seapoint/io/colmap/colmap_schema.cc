#include "colmap_seapoint/io/colmap/colmap_schema.h"

#include <algorithm>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/sqlite.h"

namespace colmap_seapoint {

// COLMAP reads some tables by position: columns may be appended only.
const char* const kColmapSchema = R"(
BEGIN IMMEDIATE;
CREATE TABLE IF NOT EXISTS cameras(camera_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, model INTEGER NOT NULL,
  width INTEGER NOT NULL, height INTEGER NOT NULL, params BLOB,
  prior_focal_length INTEGER NOT NULL);
CREATE TABLE IF NOT EXISTS images(image_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL,
  name TEXT NOT NULL UNIQUE, camera_id INTEGER NOT NULL, prior_qw REAL, prior_qx REAL,
  prior_qy REAL, prior_qz REAL, prior_tx REAL, prior_ty REAL, prior_tz REAL,
  CONSTRAINT image_id_check CHECK(image_id >= 0 and image_id < 2147483647),
  FOREIGN KEY(camera_id) REFERENCES cameras(camera_id));
CREATE UNIQUE INDEX IF NOT EXISTS index_name ON images(name);
CREATE TABLE IF NOT EXISTS keypoints(image_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL,
  cols INTEGER NOT NULL, data BLOB,
  FOREIGN KEY(image_id) REFERENCES images(image_id) ON DELETE CASCADE);
CREATE TABLE IF NOT EXISTS descriptors(image_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL,
  cols INTEGER NOT NULL, data BLOB, type INTEGER NOT NULL DEFAULT 0,
  FOREIGN KEY(image_id) REFERENCES images(image_id) ON DELETE CASCADE);
CREATE TABLE IF NOT EXISTS matches(pair_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL,
  cols INTEGER NOT NULL, data BLOB);
CREATE TABLE IF NOT EXISTS two_view_geometries(pair_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL,
  cols INTEGER NOT NULL, data BLOB, config INTEGER NOT NULL, F BLOB, E BLOB, H BLOB, qvec BLOB,
  tvec BLOB);
PRAGMA user_version = 3800;
COMMIT;
)";

namespace {

constexpr const char* kRemedy =
    "give a database of COLMAP 3.8 or later, or another name for a new one";

struct TableShape {
  const char* name;
  std::vector<const char*> columns;   // all of them are needed; the first is the key
  std::vector<const char*> optional;  // we may fill them
};

// In every version from 3.8 on.
const TableShape kTables[] = {
    {"cameras", {"camera_id", "model", "width", "height", "params", "prior_focal_length"}, {}},
    {"images", {"image_id", "name", "camera_id"}, {}},
    {"keypoints", {"image_id", "rows", "cols", "data"}, {}},
    {"descriptors", {"image_id", "rows", "cols", "data"}, {"type"}},
    {"matches", {"pair_id", "rows", "cols", "data"}, {}},
    {"two_view_geometries",
     {"pair_id", "rows", "cols", "data", "config", "F", "E", "H"},
     {"qvec", "tvec"}}};

// In 3.12 and later: all of them or none. Two have no key.
const TableShape kFrameTables[] = {
    {"rigs", {"rig_id", "ref_sensor_id", "ref_sensor_type"}, {}},
    {"rig_sensors", {"rig_id", "sensor_id", "sensor_type", "sensor_from_rig"}, {}},
    {"frames", {"frame_id", "rig_id"}, {}},
    {"frame_data", {"frame_id", "data_id", "sensor_id", "sensor_type"}, {}}};

// Ours, as the first version made them.
const TableShape kOwnTables[] = {
    {"seapoint_descriptors",
     {"image_id", "rows", "cols", "data", "fingerprint", "keypoints_hash", "data_hash"},
     {"sift_hash"}},
    {"seapoint_loop_pairs", {"id", "fingerprint", "data", "data_hash"}, {}}};

struct Column {
  std::string name;
  bool must_be_given = false;  // NOT NULL and no default
  bool is_row_key = false;     // INTEGER PRIMARY KEY: SQLite numbers the rows
};

class SchemaChecker {
 public:
  SchemaChecker(const SqlConnection& connection, bool to_be_written)
      : connection_(connection), to_be_written_(to_be_written) {}

  bool Exists(const std::string& table) const { return !KindOf(table).empty(); }

  bool HasColumn(const std::string& table, const std::string& column) const {
    const std::vector<Column> columns = ColumnsOf(table);
    return Find(columns, column) != columns.end();
  }

  void Check(const TableShape& shape, bool has_row_key) const {
    const std::string table = shape.name;
    const std::string kind = KindOf(table);
    if (!kind.empty() && kind != "table") Refuse(table + " is no table but a " + kind);
    const std::vector<Column> columns = ColumnsOf(table);
    for (const char* needed : shape.columns) {
      if (Find(columns, needed) == columns.end())
        Refuse("it has no column " + table + "." + needed);
    }
    if (!to_be_written_) return;
    if (has_row_key && !Find(columns, shape.columns.front())->is_row_key) {
      Refuse(table + "." + shape.columns.front() + " is no INTEGER PRIMARY KEY");
    }
    for (const Column& column : columns) {
      if (!column.must_be_given || IsAmong(shape.columns, column.name)) continue;
      if (IsAmong(shape.optional, column.name)) continue;
      Refuse("its column " + table + "." + column.name +
             " must have a value, and no COLMAP that we know has it");
    }
  }

  [[noreturn]] void Refuse(const std::string& why) const {
    throw Error(connection_.path, "is no COLMAP database that we know: " + why, kRemedy);
  }

 private:
  using Names = std::vector<const char*>;

  static bool IsAmong(const Names& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  }

  static std::vector<Column>::const_iterator Find(const std::vector<Column>& columns,
                                                  const std::string& name) {
    return std::find_if(columns.begin(), columns.end(),
                        [&](const Column& column) { return column.name == name; });
  }

  // "table", "view"; empty when there is none.
  std::string KindOf(const std::string& table) const {
    SqlStatement row(connection_,
                     "SELECT type FROM sqlite_master WHERE name = ? AND type IN('table', 'view')");
    row.Bind(table);
    return row.Step() ? row[0].Text() : "";
  }

  std::vector<Column> ColumnsOf(const std::string& table) const {
    std::vector<Column> columns;
    int64_t num_keys = 0;
    SqlStatement rows(connection_, "PRAGMA table_info(" + table + ")");
    while (rows.Step()) {
      Column column;
      column.name = rows[1].Text();
      std::string type = rows[2].Text();
      std::transform(type.begin(), type.end(), type.begin(), [](char c) {
        return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
      });
      const bool is_key = rows[5].Int() > 0;
      if (is_key) ++num_keys;
      column.is_row_key = is_key && type == "INTEGER";
      column.must_be_given = rows[3].Int() != 0 && rows[4].IsNull() && !column.is_row_key;
      columns.push_back(column);
    }
    if (num_keys > 1) {
      for (Column& column : columns) column.is_row_key = false;
    }
    return columns;
  }

  const SqlConnection& connection_;
  bool to_be_written_;
};

}  // namespace

SchemaExtras CheckSchema(const SqlConnection& connection, bool to_be_written) {
  const SchemaChecker checker(connection, to_be_written);
  for (const TableShape& table : kTables) checker.Check(table, true);
  SchemaExtras extras;
  extras.has_descriptor_type = checker.HasColumn("descriptors", "type");
  extras.has_poses = checker.HasColumn("two_view_geometries", "qvec") &&
                     checker.HasColumn("two_view_geometries", "tvec");
  if (!to_be_written) return extras;
  for (const TableShape& table : kFrameTables) {
    extras.has_frames = extras.has_frames || checker.Exists(table.name);
  }
  if (extras.has_frames) {
    for (const TableShape& table : kFrameTables) {
      const std::string name = table.name;
      checker.Check(table, name == "rigs" || name == "frames");
    }
  }
  for (const TableShape& table : kOwnTables) {
    if (checker.Exists(table.name)) checker.Check(table, true);
  }
  return extras;
}

}  // namespace colmap_seapoint
