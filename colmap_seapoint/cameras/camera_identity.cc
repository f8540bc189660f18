#include "colmap_seapoint/cameras/camera_identity.h"

#include <algorithm>
#include <set>

namespace colmap_seapoint {
namespace {

constexpr size_t kMinSerialLetters = 4;

bool IsDigit(char c) { return c >= '0' && c <= '9'; }
bool IsLetter(char c) {
  return IsDigit(c) || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_';
}

// Not "0000000" or "n/a", as some cameras write.
bool IsSerial(const std::string& text) {
  std::string letters;
  for (const char c : text) {
    if (IsLetter(c)) letters += c;
  }
  return letters.size() >= kMinSerialLetters &&
         std::set<char>(letters.begin(), letters.end()).size() > 1;
}

bool IsCameraFolder(const std::string& name) {
  return name.size() == 8 && name[0] != '0' &&
         std::all_of(name.begin(), name.begin() + 3, IsDigit) &&
         std::all_of(name.begin() + 3, name.end(), IsLetter);
}

}  // namespace

std::string CameraKey(const ExifCamera& camera) {
  std::string key;
  for (const std::string& text : {camera.maker, camera.model, camera.lens, camera.serial}) {
    key += text + "\n";
  }
  for (const double number :
       {camera.focal_mm, camera.focal_35mm, std::max(1.0, camera.digital_zoom)}) {
    key += std::to_string(number) + "\n";
  }
  return key;
}

std::string FolderFamily(const std::string& folder, const ExifCamera& camera) {
  const bool is_known = !camera.maker.empty() && !camera.model.empty();
  if (is_known && IsSerial(camera.serial)) return "*";
  const size_t begin = folder.rfind('/') + 1;  // 0 where there is none
  const std::string name = folder.substr(begin);
  if (!is_known || !IsCameraFolder(name)) return folder;
  return folder.substr(0, begin) + "*" + name.substr(3);
}

}  // namespace colmap_seapoint
