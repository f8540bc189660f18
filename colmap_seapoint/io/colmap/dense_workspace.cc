#include "colmap_seapoint/io/colmap/dense_workspace.h"

#include <iterator>
#include <set>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/input_stream.h"
#include "colmap_seapoint/io/image/image_file.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the files are little-endian");

constexpr int kMaxSide = 1 << 20;
constexpr int kMaxChannels = 4;
constexpr const char* kNotAMap = "is no depth or normal map of COLMAP";
constexpr const char* kRemedy = "let it be written again";

const std::string& Safe(const std::string& image_name) {
  SEAPOINT_CHECK(IsSafeImageName(image_name));  // ReadSparseModel refuses others
  return image_name;
}

// Before the next '&', which is passed.
int ReadNumber(const fs::path& path, std::istream* stream, int max) {
  std::string text;
  char c = 0;
  while (stream->get(c) && c != '&' && c >= '0' && c <= '9' && text.size() < 8) text += c;
  const int value = c == '&' && !text.empty() ? std::stoi(text) : 0;
  if (value < 1 || value > max) throw Error(path.string(), kNotAMap, kRemedy);
  return value;
}

}  // namespace

fs::path UndistortedImagePath(const fs::path& workspace, const std::string& image_name) {
  return workspace / "images" / Safe(image_name);
}
fs::path DepthMapPath(const fs::path& workspace, const std::string& image_name) {
  return workspace / "stereo" / "depth_maps" / (Safe(image_name) + ".geometric.bin");
}
fs::path NormalMapPath(const fs::path& workspace, const std::string& image_name) {
  return workspace / "stereo" / "normal_maps" / (Safe(image_name) + ".geometric.bin");
}

void CreateDenseWorkspaceFolders(const fs::path& workspace,
                                 const std::vector<std::string>& image_names) {
  const fs::path stereo = workspace / "stereo";
  std::set<fs::path> folders = {workspace / "images", stereo / "depth_maps", stereo / "normal_maps",
                                stereo / "consistency_graphs"};
  for (const std::string& name : image_names) {
    folders.insert(UndistortedImagePath(workspace, name).parent_path());
    folders.insert(DepthMapPath(workspace, name).parent_path());
    folders.insert(NormalMapPath(workspace, name).parent_path());
  }
  for (const fs::path& folder : folders) CheckWritableDir(folder);
}

void RemoveStereoConfigs(const fs::path& workspace) {
  std::error_code ignored;  // what cannot be removed cannot be replaced either, which is told then
  fs::remove(workspace / "stereo" / "fusion.cfg", ignored);
  fs::remove(workspace / "stereo" / "patch-match.cfg", ignored);
}

void WriteStereoConfigs(const fs::path& workspace, const std::vector<std::string>& image_names) {
  std::string fusion, patch_match;
  for (const std::string& name : image_names) {
    fusion += name + "\n";
    patch_match += name + "\n__auto__, 20\n";
  }
  WriteTextFile(workspace / "stereo" / "patch-match.cfg", patch_match);
  WriteTextFile(workspace / "stereo" / "fusion.cfg", fusion);
}

void WriteDenseMap(const fs::path& path, const FloatImage& map) {
  SEAPOINT_CHECK(!map.Empty());
  AtomicFile file(path);
  file.Write(std::to_string(map.width) + "&" + std::to_string(map.height) + "&" +
             std::to_string(map.channels) + "&");
  std::vector<float> row(static_cast<size_t>(map.width));
  for (int k = 0; k < map.channels; ++k) {
    for (int y = 0; y < map.height; ++y) {
      for (int x = 0; x < map.width; ++x) row[static_cast<size_t>(x)] = map.At(x, y, k);
      file.Write(row.data(), row.size() * sizeof(float));
    }
  }
  file.Commit();
}

FloatImage ReadDenseMap(const fs::path& path) {
  InputStream stream(path);
  const uint64_t size = fs::file_size(path);
  const int width = ReadNumber(path, &stream, kMaxSide);
  const int height = ReadNumber(path, &stream, kMaxSide);
  const int channels = ReadNumber(path, &stream, kMaxChannels);
  const uint64_t expected = sizeof(float) * static_cast<uint64_t>(width) *
                            static_cast<uint64_t>(height) * static_cast<uint64_t>(channels);
  if (size - static_cast<uint64_t>(stream.tellg()) != expected) {
    throw Error(path.string(), "is not as long as its size in pixels says: it is damaged", kRemedy);
  }
  FloatImage map(width, height, channels);
  std::vector<float> row(static_cast<size_t>(width));
  for (int k = 0; k < channels; ++k) {
    for (int y = 0; y < height; ++y) {
      stream.read(reinterpret_cast<char*>(row.data()),
                  static_cast<std::streamsize>(row.size() * sizeof(float)));
      for (int x = 0; x < width; ++x) map.At(x, y, k) = row[static_cast<size_t>(x)];
    }
  }
  if (!stream) throw Error(path.string(), "has become shorter", kRemedy);
  return map;
}

}  // namespace colmap_seapoint
