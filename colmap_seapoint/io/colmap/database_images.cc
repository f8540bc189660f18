#include "colmap_seapoint/io/colmap/database_images.h"

#include <cmath>
#include <cstring>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/sqlite.h"
#include "colmap_seapoint/io/image/image_file.h"

namespace colmap_seapoint {
namespace {

constexpr int64_t kCameraSensorType = 0;  // COLMAP's SensorType::CAMERA
constexpr int64_t kMaxCameraSide = 1 << 20;

// Columns: camera_id, model, width, height, params, prior_focal_length.
Camera CameraOf(const SqlConnection& db, const SqlStatement& row) {
  const std::string who = "camera " + std::to_string(row[0].Int());
  const int64_t model_id = row[1].Int();
  const CameraModelInfo* info =
      model_id < 0 || model_id > 1000 ? nullptr : FindCameraModel(static_cast<int>(model_id));
  if (info == nullptr) {
    throw Error(db.path, who + " has the unknown camera model " + std::to_string(model_id),
                "use one of " + CameraModelNames());
  }
  const int64_t width = row[2].Int(), height = row[3].Int();
  if (width <= 0 || height <= 0 || width > kMaxCameraSide || height > kMaxCameraSide) {
    throw Error(db.path, who + " has an impossible size", "restore a copy of the database");
  }
  Camera camera;
  camera.camera_id = static_cast<uint32_t>(row[0].Int());
  camera.model = info->model;
  camera.width = static_cast<int>(width);
  camera.height = static_cast<int>(height);
  camera.params.resize(static_cast<size_t>(info->num_params));
  bool is_legal = row[4].Size() == camera.params.size() * sizeof(double);
  if (is_legal) std::memcpy(camera.params.data(), row[4].Blob(), row[4].Size());
  for (const double param : camera.params) is_legal = is_legal && std::isfinite(param);
  if (!is_legal) {
    throw Error(db.path, who + " has damaged parameters", "restore a copy of the database");
  }
  camera.has_prior_focal_length = row[5].Int() != 0;
  return camera;
}

// The rig that the camera belongs to, or a new one with the camera as its reference sensor.
int64_t RigOf(const SqlConnection& db, int64_t camera_id) {
  {
    SqlStatement rig(db,
                     "SELECT rig_id FROM rigs WHERE ref_sensor_id = ?1 AND ref_sensor_type = ?2 "
                     "UNION ALL SELECT rig_id FROM rig_sensors "
                     "WHERE sensor_id = ?1 AND sensor_type = ?2");
    rig.Bind(camera_id).Bind(kCameraSensorType);
    if (rig.Step()) return rig[0].Int();
  }
  SqlStatement(db, "INSERT INTO rigs(ref_sensor_id, ref_sensor_type) VALUES(?, ?)")
      .Bind(camera_id)
      .Bind(kCameraSensorType)
      .Run();
  return LastRowId(db);
}

// One frame an image, as COLMAP's image reader does it.
void AddFrame(const SqlConnection& db, int64_t image_id, int64_t camera_id) {
  const int64_t rig_id = RigOf(db, camera_id);
  SqlStatement(db, "INSERT INTO frames(rig_id) VALUES(?)").Bind(rig_id).Run();
  SqlStatement(db,
               "INSERT INTO frame_data(frame_id, data_id, sensor_id, sensor_type) "
               "VALUES(?, ?, ?, ?)")
      .Bind(LastRowId(db))
      .Bind(image_id)
      .Bind(camera_id)
      .Bind(kCameraSensorType)
      .Run();
}

}  // namespace

std::map<uint32_t, Camera> ReadCameras(const ColmapDatabase& database) {
  const SqlConnection& db = database.Connection();
  std::map<uint32_t, Camera> cameras;
  SqlStatement rows(db,
                    "SELECT camera_id, model, width, height, params, prior_focal_length "
                    "FROM cameras ORDER BY camera_id");
  while (rows.Step()) {
    Camera camera = CameraOf(db, rows);
    cameras.emplace(camera.camera_id, std::move(camera));
  }
  return cameras;
}

std::vector<DatabaseImage> ReadImages(const ColmapDatabase& database) {
  const SqlConnection& db = database.Connection();
  std::vector<DatabaseImage> images;
  SqlStatement rows(db, "SELECT image_id, camera_id, name FROM images ORDER BY image_id");
  while (rows.Step()) {
    images.push_back({static_cast<uint32_t>(rows[0].Int()), static_cast<uint32_t>(rows[1].Int()),
                      rows[2].Text()});
    const DatabaseImage& image = images.back();
    if (IsSafeImageName(image.name)) continue;
    throw Error(db.path,
                "image " + std::to_string(image.image_id) + " is named '" + image.name +
                    "', which is empty, absolute or leads out of the image folder",
                "delete or rename it in the database");
  }
  return images;
}

uint32_t AddCamera(ColmapDatabase* database, const Camera& camera) {
  const SqlConnection& db = database->Connection();
  const CameraModelInfo* info = FindCameraModel(static_cast<int>(camera.model));
  SEAPOINT_CHECK(info != nullptr);
  SEAPOINT_CHECK(camera.params.size() == static_cast<size_t>(info->num_params));
  SqlStatement(db,
               "INSERT INTO cameras(model, width, height, params, prior_focal_length) "
               "VALUES(?, ?, ?, ?, ?)")
      .Bind(static_cast<int64_t>(camera.model))
      .Bind(static_cast<int64_t>(camera.width))
      .Bind(static_cast<int64_t>(camera.height))
      .BindBlob(camera.params.data(), camera.params.size() * sizeof(double))
      .Bind(static_cast<int64_t>(camera.has_prior_focal_length ? 1 : 0))
      .Run();
  return static_cast<uint32_t>(LastRowId(db));
}

void SetCalibration(ColmapDatabase* database, const Camera& camera) {
  SqlStatement(database->Connection(),
               "UPDATE cameras SET params = ?, prior_focal_length = 1 "
               "WHERE camera_id = ? AND model = ?")
      .BindBlob(camera.params.data(), camera.params.size() * sizeof(double))
      .Bind(static_cast<int64_t>(camera.camera_id))
      .Bind(static_cast<int64_t>(camera.model))
      .Run();
}

uint32_t AddImage(ColmapDatabase* database, const std::string& name, uint32_t camera_id) {
  const SqlConnection& db = database->Connection();
  if (!IsSafeImageName(name)) {
    throw Error(db.path, "'" + name + "' is no legal image name", "rename the picture");
  }
  SqlSavepoint savepoint(db);
  // Frames are all or nothing: an image without one makes newer COLMAPs abort.
  const bool needs_frame =
      database->Extras().has_frames &&
      (HasRows(db, "frames") || (HasRows(db, "rigs") && !HasRows(db, "images")));
  SqlStatement(db, "INSERT INTO images(name, camera_id) VALUES(?, ?)")
      .Bind(name)
      .Bind(static_cast<int64_t>(camera_id))
      .Run();
  const int64_t image_id = LastRowId(db);
  if (needs_frame) AddFrame(db, image_id, camera_id);
  savepoint.Release();
  return static_cast<uint32_t>(image_id);
}

}  // namespace colmap_seapoint
