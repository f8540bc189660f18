#include "colmap_seapoint/cameras/camera_presets.h"

#include <algorithm>
#include <cstdio>
#include <utility>
#include <vector>

#include "colmap_seapoint/base/options.h"

namespace colmap_seapoint {
namespace {

constexpr double kWater = 1.333;
constexpr size_t kNumNearest = 3;

// GoPro, wide: f = 435 px (HERO9) and 439 px (HERO6) of 960 as an equidistant fisheye, calibrated
// in air (github.com/urbste/OpenImuCameraCalibrator, Readme.md, table of camera calibrations).
// Water straightens it: behind a flat port the polynomial of OPENCV holds it, behind a dome it
// stays a fisheye.
constexpr double kGoProWide = 437.0 / 960;
// GoPro, linear: 19 mm, as the camera's own menu has it for its digital lenses from HERO8 on, of
// the 36 mm of film.
constexpr double kGoProLinear = 19.0 / 36;
// Olympus Tough TG-1 to TG-7: 4.5 mm at the wide end, 25 mm by the maker's data sheet, in pictures
// of 4 to 3: 25 of the 34.6 mm that are as long a side to the same diagonal.
constexpr double kToughWide = 25.0 / 34.6;
// One-inch sensors are 13.2 mm wide; 8.8 mm is the wide end of both by their data sheets.
constexpr double kOneInchWide = 8.8 / 13.2;
// Sony's data sheets of the first three A7: 35.8 mm wide.
constexpr double kFullFrame28 = 28 / 35.8, kFullFrame16 = 16 / 35.8;

constexpr CameraPreset kPresets[] = {
    {"gopro_wide_flatport", Port::kFlat, CameraModel::kOpenCV, kGoProWide, false,
     "GoPro HERO5 and later, wide lens; its own housing is flat"},
    {"gopro_wide_dome", Port::kDome, CameraModel::kOpenCVFisheye, kGoProWide, false,
     "the same behind a dome"},
    {"gopro_linear_flatport", Port::kFlat, CameraModel::kOpenCV, kGoProLinear, false,
     "GoPro HERO8 and later, linear lens (19 mm)"},
    {"gopro_linear_dome", Port::kDome, CameraModel::kOpenCV, kGoProLinear, false,
     "the same behind a dome"},
    {"gopro12_linear_flatport", Port::kFlat, CameraModel::kOpenCV, kGoProLinear, false,
     "gopro_linear_flatport by another name"},
    {"tg6_flatport", Port::kFlat, CameraModel::kOpenCV, kToughWide, true,
     "Olympus/OM Tough TG-1 to TG-7; without EXIF at its wide end (25 mm)"},
    {"g7x_flatport", Port::kFlat, CameraModel::kOpenCV, kOneInchWide, true,
     "Canon PowerShot G7 X; without EXIF at its wide end (8.8 mm)"},
    {"rx100_flatport", Port::kFlat, CameraModel::kOpenCV, kOneInchWide, true,
     "Sony RX100 III to VA, others by EXIF; without EXIF at its wide end (8.8 mm)"},
    {"a7_28mm_flatport", Port::kFlat, CameraModel::kOpenCV, kFullFrame28, false,
     "Sony A7, or any full frame, with 28 mm"},
    {"a7_28mm_dome", Port::kDome, CameraModel::kOpenCV, kFullFrame28, false,
     "the same behind a dome"},
    {"a7_16mm_dome", Port::kDome, CameraModel::kOpenCV, kFullFrame16, false,
     "Sony A7, or any full frame, with 16 mm (no fisheye)"},
    {"flatport", Port::kFlat, CameraModel::kOpenCV, 0, true,
     "whatever camera EXIF tells, behind a flat port"},
    {"dome", Port::kDome, CameraModel::kOpenCV, 0, true,
     "whatever camera EXIF tells, behind a dome"},
};

}  // namespace

double WaterFactor(Port port) { return port == Port::kFlat ? kWater : 1.0; }

const char* PortText(Port port) { return port == Port::kFlat ? "a flat port" : "a dome"; }

const CameraPreset* FindCameraPreset(const std::string& name) {
  for (const CameraPreset& preset : kPresets) {
    if (name == preset.name) return &preset;
  }
  return nullptr;
}

std::string UnknownPreset(const std::string& name) {
  std::vector<std::pair<size_t, std::string>> names;
  for (const CameraPreset& preset : kPresets) {
    names.emplace_back(EditDistance(name, preset.name), preset.name);
  }
  std::stable_sort(names.begin(), names.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::string nearest;
  for (size_t i = 0; i < kNumNearest; ++i) nearest += (i == 0 ? "" : ", ") + names[i].second;
  return "--camera_preset " + name + ": there is no such camera; the nearest are " + nearest +
         " ('--camera_preset list' shows all)";
}

std::string CameraPresetList() {
  std::string list;
  for (const CameraPreset& preset : kPresets) {
    char line[200];
    std::snprintf(line, sizeof(line), "%-24s %-14s ", preset.name,
                  FindCameraModel(static_cast<int>(preset.model))->name);
    list += line;
    if (preset.focal > 0) {
      std::snprintf(line, sizeof(line), "%.3f  ", preset.focal * WaterFactor(preset.port));
      list += line;
    } else {
      list += "EXIF   ";
    }
    list += std::string(preset.camera) + "\n";
  }
  return "name, camera model, focal length under water in units of the picture's longer side, "
         "camera\n" +
         list;
}

}  // namespace colmap_seapoint
