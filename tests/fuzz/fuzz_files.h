// What the fuzz targets of parsers share: the input as a file, and what a parser may do with it.
#pragma once

#include <stdlib.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "tests/fuzz/require.h"

namespace colmap_seapoint {

// Of this process, in memory where the system has such a place; removed at the end.
inline const std::filesystem::path& FuzzFolder() {
  struct Folder {
    Folder() {
      const std::filesystem::path memory = "/dev/shm";
      const bool has_memory = std::filesystem::is_directory(memory);
      std::string name = (has_memory ? memory : std::filesystem::temp_directory_path()).string() +
                         "/seapoint_fuzz_XXXXXX";
      FUZZ_REQUIRE(mkdtemp(name.data()) != nullptr);
      path = name;
    }
    ~Folder() {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
    std::filesystem::path path;
  };
  static const Folder folder;
  return folder.path;
}

inline std::filesystem::path WriteFuzzFile(const std::string& name, const std::string& bytes) {
  const std::filesystem::path path = FuzzFolder() / name;
  std::filesystem::create_directories(path.parent_path());
  std::ofstream file(path, std::ios::binary);
  file << bytes;
  FUZZ_REQUIRE(file.flush());
  return path;
}

inline std::filesystem::path WriteFuzzFile(const std::string& name, const uint8_t* data,
                                           size_t size) {
  return WriteFuzzFile(name, std::string(reinterpret_cast<const char*>(data), size));
}

// Between the files of an input that stands for several.
inline constexpr char kNextFile[] = "\n--- next file ---\n";

// An input as files of these names in a folder; there are none for names that it does not reach.
inline std::filesystem::path WriteFuzzFiles(const std::string& folder,
                                            const std::vector<std::string>& names,
                                            const uint8_t* data, size_t size) {
  const std::filesystem::path path = FuzzFolder() / folder;
  std::filesystem::remove_all(path);
  std::filesystem::create_directories(path);
  const std::string input(reinterpret_cast<const char*>(data), size);
  size_t begin = 0;
  for (const std::string& name : names) {
    const size_t end = input.find(kNextFile, begin);
    WriteFuzzFile(folder + "/" + name, input.substr(begin, end - begin));
    if (end == input.npos) break;
    begin = end + sizeof(kNextFile) - 1;
  }
  return path;
}

// Whether the parser took it. It may refuse by an Error or a UsageError and by nothing else: what
// other exceptions reach the fuzzer is a finding.
template <typename Function>
bool Accepts(const Function& parse) {
  try {
    parse();
    return true;
  } catch (const Error& error) {
    FUZZ_REQUIRE(!error.Finding().empty());
  } catch (const UsageError&) {
  }
  return false;
}

}  // namespace colmap_seapoint
