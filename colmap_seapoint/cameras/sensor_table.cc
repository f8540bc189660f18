#include "colmap_seapoint/cameras/sensor_table.h"

#include <lensfun/lensfun.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <map>
#include <system_error>
#include <utility>
#include <vector>

#include "colmap_seapoint/io/files/input_stream.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

// Where Debian has it. LensFun's own search would look into the user's home as well: the same
// pictures would then give other models on another machine.
constexpr char kDatabaseFolder[] = "/usr/share/lensfun/version_1";
constexpr double kFullFrameDiagonalMm = 43.267;
constexpr double kSameSize = 0.02;  // of the crop factor

std::string LowerCase(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

std::string FirstWord(const std::string& text) { return text.substr(0, text.find(' ')); }

// Model and first word of the maker, in small letters -> crop factors.
using CropFactors = std::multimap<std::pair<std::string, std::string>, double>;

CropFactors ReadCropFactors() {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(kDatabaseFolder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->path().extension() == ".xml") files.push_back(entry->path());
  }
  std::sort(files.begin(), files.end());
  lfDatabase* database = lf_db_new();
  for (const fs::path& path : files) {
    InputStream file(path);
    const std::string text(std::istreambuf_iterator<char>(file), {});
    lf_db_load_data(database, path.c_str(), text.data(), text.size());
  }
  CropFactors crops;
  const lfCamera* const* cameras = lf_db_get_cameras(database);
  for (; cameras != nullptr && *cameras != nullptr; ++cameras) {
    const lfCamera& camera = **cameras;
    if (camera.Maker == nullptr || camera.Model == nullptr || !(camera.CropFactor > 0)) continue;
    crops.emplace(std::pair(FirstWord(LowerCase(camera.Maker)), LowerCase(camera.Model)),
                  camera.CropFactor);
  }
  lf_db_destroy(database);
  return crops;
}

// Compact cameras and Four Thirds; full frame, APS and one-inch sensors are 3 to 2.
bool IsFourThirds(double crop) { return crop > 3.5 || (crop > 1.8 && crop < 2.4); }

}  // namespace

std::optional<SensorSize> FindSensor(const std::string& maker, const std::string& model) {
  if (maker.empty() || model.empty()) return std::nullopt;
  static const CropFactors crops = ReadCropFactors();
  const auto [begin, end] = crops.equal_range({FirstWord(LowerCase(maker)), LowerCase(model)});
  if (begin == end) return std::nullopt;
  const double crop = begin->second;
  for (auto other = begin; other != end; ++other) {
    if (std::abs(other->second - crop) > kSameSize * crop) return std::nullopt;
  }
  return SensorSize{kFullFrameDiagonalMm / crop, IsFourThirds(crop)};
}

}  // namespace colmap_seapoint
