#include "colmap_seapoint/pictures/duplicates.h"

#include <map>
#include <string>
#include <system_error>
#include <tuple>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/files/content_hash.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

// By the sizes of picture and file; 0 where that cannot be told.
using SizeKey = std::tuple<int, int, uintmax_t>;

std::vector<SizeKey> SizeKeys(const fs::path& image_path,
                              const std::vector<ReadablePicture>& pictures) {
  std::vector<SizeKey> keys;
  for (const ReadablePicture& picture : pictures) {
    std::error_code error;
    const uintmax_t bytes = fs::file_size(image_path / picture.name, error);
    keys.emplace_back(picture.info.width, picture.info.height, error ? 0 : bytes);
  }
  return keys;
}

// "" of pictures whose size no other one has, and of those that cannot be read.
std::vector<std::string> HashesOfLikeSizes(const fs::path& image_path, int num_threads,
                                           const std::vector<ReadablePicture>& pictures) {
  const std::vector<SizeKey> keys = SizeKeys(image_path, pictures);
  std::map<SizeKey, int> counts;
  for (const SizeKey& key : keys) ++counts[key];
  std::vector<std::string> hashes(pictures.size());
  ParallelFor(num_threads, static_cast<int64_t>(pictures.size()), [&](int64_t index) {
    const auto i = static_cast<size_t>(index);
    if (counts.at(keys[i]) < 2) return;
    try {
      hashes[i] = HashFile(image_path / pictures[i].name);
    } catch (const Error&) {
      // Who reads the picture says what is wrong with it.
    }
  });
  return hashes;
}

}  // namespace

std::vector<RunReport::LeftOut> LeaveOutDuplicates(const fs::path& image_path, int num_threads,
                                                   std::vector<ReadablePicture>* pictures) {
  const std::vector<std::string> hashes = HashesOfLikeSizes(image_path, num_threads, *pictures);
  std::map<std::string, std::string> first_of;  // hash -> name
  std::vector<ReadablePicture> kept;
  std::vector<RunReport::LeftOut> left_out;
  for (size_t i = 0; i < hashes.size(); ++i) {
    ReadablePicture& picture = (*pictures)[i];
    const auto [first, is_new] = first_of.emplace(hashes[i], picture.name);
    if (hashes[i].empty() || is_new) {
      kept.push_back(std::move(picture));
    } else {
      left_out.push_back({picture.name, "is the same file as " + first->second});
    }
  }
  *pictures = std::move(kept);
  if (left_out.empty()) return left_out;
  LogWarning(std::to_string(left_out.size()) +
             (left_out.size() == 1
                  ? " picture is there twice and left out once: "
                  : " pictures are there twice and left out once, the first one: ") +
             left_out.front().name + " " + left_out.front().reason);
  return left_out;
}

}  // namespace colmap_seapoint
