#include "colmap_seapoint/io/files/temporary_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <string>
#include <system_error>
#include <vector>

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr char kPrefix[] = ".seapoint_";
constexpr char kSuffix[] = ".tmp";
constexpr size_t kNumDigits = 16;
// mkstemp() made them of six letters and digits.
constexpr const char* kEarlierPrefixes[] = {".seapoint_probe_", ".seapoint_tiles_"};
constexpr size_t kNumEarlierLetters = 6;

constexpr int kMaxAttempts = 100;

std::string RandomName() {
  uint64_t number = 0;
  if (getrandom(&number, sizeof(number), 0) != static_cast<ssize_t>(sizeof(number))) return "";
  char digits[kNumDigits + 1];
  std::snprintf(digits, sizeof(digits), "%016" PRIx64, number);
  return kPrefix + std::string(digits) + kSuffix;
}

bool IsDigit(char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); }

bool IsLetter(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

// Whether `name` is `prefix`, `count` letters that `is_letter` accepts, and `suffix`.
template <typename Predicate>
bool Matches(const std::string& name, const std::string& prefix, size_t count,
             const std::string& suffix, const Predicate& is_letter) {
  if (name.size() != prefix.size() + count + suffix.size()) return false;
  const auto letters = name.begin() + static_cast<std::ptrdiff_t>(prefix.size());
  return name.compare(0, prefix.size(), prefix) == 0 &&
         name.compare(prefix.size() + count, suffix.size(), suffix) == 0 &&
         std::all_of(letters, letters + static_cast<std::ptrdiff_t>(count), is_letter);
}

bool IsTemporaryName(const std::string& name) {
  if (Matches(name, kPrefix, kNumDigits, kSuffix, IsDigit)) return true;
  return std::any_of(
      std::begin(kEarlierPrefixes), std::end(kEarlierPrefixes),
      [&](const char* prefix) { return Matches(name, prefix, kNumEarlierLetters, "", IsLetter); });
}

// False when somebody took the new file for a leftover before it was locked.
bool LockNewFile(int descriptor) {
  flock(descriptor, LOCK_EX | LOCK_NB);  // a file system without locks has no sweepers either
  struct stat status {};
  return fstat(descriptor, &status) != 0 || status.st_nlink > 0;
}

void RemoveUnlessHeld(const fs::path& path) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return;
  struct stat status {};
  if (fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) &&
      flock(descriptor, LOCK_EX | LOCK_NB) == 0) {
    unlink(path.c_str());
  }
  close(descriptor);
}

}  // namespace

TemporaryFile CreateTemporaryFile(const fs::path& folder) {
  TemporaryFile file;
  for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
    const std::string name = RandomName();
    if (name.empty()) break;
    file.path = folder / name;
    file.descriptor = open(file.path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file.descriptor < 0 && errno != EEXIST) break;
    if (file.descriptor < 0) continue;
    if (LockNewFile(file.descriptor)) break;
    close(file.descriptor);
    file.descriptor = -1;
    errno = EAGAIN;
  }
  return file;
}

void RemoveLeftovers(const fs::path& folder) {
  std::vector<fs::path> leftovers;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (IsTemporaryName(entry->path().filename().string())) leftovers.push_back(entry->path());
  }
  for (const fs::path& leftover : leftovers) RemoveUnlessHeld(leftover);
}

}  // namespace colmap_seapoint
