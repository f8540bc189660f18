// Which pictures one lens took, by what EXIF and the folders' names tell (ours).
#pragma once

#include <string>

#include "colmap_seapoint/io/image/exif_camera.h"

namespace colmap_seapoint {

// Maker, model, lens, serial number, focal lengths and digital zoom: pictures in which any of these
// differs are not through the same lens. Equal for all pictures without EXIF.
std::string CameraKey(const ExifCamera& camera);

// Where else a lens may have taken pictures: folders with the same text hold one camera's where
// key and size are the same too. The serial number of a body tells it in whatever folder. Else a
// camera of known maker and model goes on from folder 100GOPRO to 101GOPRO when the first is full
// (three digits and five letters, by the DCF rule that all cameras follow): these, side by side,
// are one. Other folders stand for themselves: cam1 and cam2, or left and right, may hold two
// cameras of a kind.
std::string FolderFamily(const std::string& folder, const ExifCamera& camera);

}  // namespace colmap_seapoint
