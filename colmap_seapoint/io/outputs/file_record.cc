#include "colmap_seapoint/io/outputs/file_record.h"

#include <algorithm>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/content_hash.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> FilesBelow(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

FileRecord RecordFile(const fs::path& root, const fs::path& path) {
  const std::string hash = HashFile(path);
  return {path.lexically_relative(root).string(), fs::file_size(path), hash};
}

}  // namespace

std::vector<FileRecord> RecordFiles(const fs::path& root, const std::vector<fs::path>& outputs) {
  std::vector<FileRecord> records;
  for (const fs::path& output : outputs) {
    const bool is_folder = fs::is_directory(output);
    const std::vector<fs::path> files = is_folder ? FilesBelow(output) : std::vector{output};
    for (const fs::path& file : files) records.push_back(RecordFile(root, file));
  }
  return records;
}

std::string RecordProblem(const fs::path& root, const FileRecord& record) {
  const fs::path path = root / record.path;
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return path.string() + " is gone";
  const uint64_t size = fs::file_size(path, error);
  if (error) return path.string() + " cannot be read (" + error.message() + ")";
  if (size != record.size) {
    return path.string() + " holds " + std::to_string(size) + " bytes instead of " +
           std::to_string(record.size);
  }
  try {
    if (HashFile(path) != record.hash) return path.string() + " does not hold what was written";
  } catch (const Error& failure) {
    return path.string() + " " + failure.Finding();
  }
  return "";
}

}  // namespace colmap_seapoint
