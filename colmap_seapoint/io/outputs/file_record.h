// What a finished file was like, so that a later run sees whether it still is.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace colmap_seapoint {

struct FileRecord {
  std::string path;  // relative to the folder of the records
  uint64_t size = 0;
  std::string hash;  // content_hash.h
};

// A record a file, in the order of `outputs`; of a folder, one of every file below it, by name.
// Throws Error for what is not there or cannot be read. Cost: a read of every file.
std::vector<FileRecord> RecordFiles(const std::filesystem::path& root,
                                    const std::vector<std::filesystem::path>& outputs);

// "" when the file is as it was recorded; else the file and what is wrong, as words for the user.
// Cost: a read of the file, if its size is right.
std::string RecordProblem(const std::filesystem::path& root, const FileRecord& record);

}  // namespace colmap_seapoint
