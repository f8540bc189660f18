#include "colmap_seapoint/frames/list_clips.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <tuple>

#include "colmap_seapoint/base/natural_order.h"

namespace colmap_seapoint {
namespace {

bool AreDigits(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c); });
}

struct ClipKey {
  std::string folder, recording;
  std::string chapter;
};

// GXccnnnn (also GH, GL, GS, GP: lower numbers are newer cameras') and GOPRnnnn.
ClipKey KeyOf(const std::string& name) {
  const std::filesystem::path path(name);
  const std::string folder = path.parent_path().generic_string();
  const std::string stem = path.stem().string();
  if (stem.size() == 8 && AreDigits(stem.substr(4))) {
    const bool is_chapter = stem[0] == 'G' &&
                            std::string("XHLSP").find(stem[1]) != std::string::npos &&
                            AreDigits(stem.substr(2, 2));
    // The camera numbers its recordings, whatever letter stands for the codec.
    if (is_chapter) return {folder, stem.substr(4), stem.substr(2, 2)};
    if (stem.compare(0, 4, "GOPR") == 0) return {folder, stem.substr(4), "00"};
  }
  return {folder, stem, ""};
}

bool Precedes(const std::string& a, const std::string& b) {
  const ClipKey key_a = KeyOf(a), key_b = KeyOf(b);
  if (key_a.folder != key_b.folder) return NaturalLess(key_a.folder, key_b.folder);
  if (key_a.recording != key_b.recording) return NaturalLess(key_a.recording, key_b.recording);
  if (key_a.chapter != key_b.chapter) return key_a.chapter < key_b.chapter;
  return NaturalLess(a, b);
}

std::string Joined(const std::string& folder, const std::string& name) {
  return folder.empty() ? name : folder + "/" + name;
}

}  // namespace

std::vector<Clip> OrderClips(const std::filesystem::path& folder, std::vector<std::string> names) {
  std::sort(names.begin(), names.end(), Precedes);
  std::vector<Clip> clips;
  std::map<std::pair<std::string, std::string>, std::string> first_stems;  // of recordings
  std::map<std::string, int> num_uses;                                     // of prefixes
  for (const std::string& name : names) {
    const ClipKey key = KeyOf(name);
    const std::string stem = std::filesystem::path(name).stem().string();
    const std::string& first =
        first_stems.emplace(std::pair(key.folder, key.recording), stem).first->second;
    std::string prefix = Joined(key.folder, first + "/" + stem);
    // dive.mp4 beside dive.mov
    const int uses = ++num_uses[prefix];
    if (uses > 1) prefix += "_" + std::to_string(uses);
    clips.push_back({folder / name, name, prefix});
  }
  return clips;
}

}  // namespace colmap_seapoint
