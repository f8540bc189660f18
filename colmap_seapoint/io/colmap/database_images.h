// Cameras and images in COLMAP's database.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"

namespace colmap_seapoint {

struct DatabaseImage {
  uint32_t image_id = 0;
  uint32_t camera_id = 0;
  std::string name;  // relative to the image folder, '/' between folders
};

// By camera_id. Throws Error for models that FindCameraModel does not know, impossible sizes, and
// parameters that are damaged or not finite.
std::map<uint32_t, Camera> ReadCameras(const ColmapDatabase& database);

// By image_id. Throws Error for a name that IsSafeImageName refuses.
std::vector<DatabaseImage> ReadImages(const ColmapDatabase& database);

// Returns the camera_id that the database chose; camera.camera_id is ignored.
uint32_t AddCamera(ColmapDatabase* database, const Camera& camera);

// Gives the camera of camera.camera_id these parameters, and says that its focal length is known.
// The model must be the one that the database has.
void SetCalibration(ColmapDatabase* database, const Camera& camera);

// Returns the image_id. Where the database keeps frames (COLMAP 3.12 and later), the image gets its
// frame, and a new camera its rig. Throws Error for a name that IsSafeImageName refuses, a name
// that is there already, and a camera that is not.
uint32_t AddImage(ColmapDatabase* database, const std::string& name, uint32_t camera_id);

}  // namespace colmap_seapoint
