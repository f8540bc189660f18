#include "colmap_seapoint/system/memory_limit.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kNoLimit = std::numeric_limits<uint64_t>::max();
constexpr char kUnits[] = "KMGT";

// "max", a missing file or anything else that is no number: no limit.
uint64_t LimitIn(const fs::path& path) {
  uint64_t limit = 0;
  return std::ifstream(path) >> limit && limit > 0 ? limit : kNoLimit;
}

// The group's own limit and those of all groups that it is in.
uint64_t LimitOfGroup(const fs::path& mount, std::string group, const char* file) {
  uint64_t limit = LimitIn(mount / file);
  while (!group.empty()) {
    limit = std::min(limit, LimitIn(mount / group.substr(1) / file));
    group.resize(group.rfind('/'));
  }
  return limit;
}

// Lines "ID:CONTROLLERS:/GROUP"; version 2 has the ID 0 and names no controllers.
uint64_t LimitOfGroups(const fs::path& root) {
  const fs::path mount = root / "sys/fs/cgroup";
  uint64_t limit = kNoLimit;
  std::ifstream groups(root / "proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    const size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos || line.compare(second + 1, 1, "/") != 0) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const std::string group = line.substr(second + 1);
    if (controllers == ",,") limit = std::min(limit, LimitOfGroup(mount, group, "memory.max"));
    if (controllers.find(",memory,") != std::string::npos) {
      limit = std::min(limit, LimitOfGroup(mount / "memory", group, "memory.limit_in_bytes"));
    }
  }
  return limit;
}

}  // namespace

uint64_t AvailableMemoryBytes(const fs::path& root) {
  uint64_t bytes =
      static_cast<uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
    bytes = std::min<uint64_t>(bytes, limit.rlim_cur);
  }
  return std::min(bytes, LimitOfGroups(root));
}

std::optional<uint64_t> ParseBytes(const std::string& text) {
  double number = 0;
  const auto parsed =
      std::from_chars(text.data(), text.data() + text.size(), number, std::chars_format::fixed);
  if (parsed.ec != std::errc() || !std::isfinite(number)) return std::nullopt;
  std::string unit(parsed.ptr, text.data() + text.size());
  for (char& c : unit) c = static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
  int exponent = 0;
  if (!unit.empty() && unit != "B") {
    const size_t place = std::string(kUnits).find(unit[0]);
    const std::string rest = unit.substr(1);
    if (place == std::string::npos || !(rest.empty() || rest == "B" || rest == "IB")) {
      return std::nullopt;
    }
    exponent = 10 * (static_cast<int>(place) + 1);
  }
  const double bytes = std::ldexp(number, exponent);
  if (!(bytes >= 1) || bytes > 1e18) return std::nullopt;
  return static_cast<uint64_t>(bytes);
}

std::string BytesText(uint64_t bytes) {
  const auto megabytes = static_cast<double>(bytes) / (1 << 20);
  char text[40];
  if (megabytes < 1024) {
    std::snprintf(text, sizeof(text), "%.0f MB", std::ceil(megabytes));
  } else {
    std::snprintf(text, sizeof(text), "%.1f GB", megabytes / 1024);
  }
  return text;
}

}  // namespace colmap_seapoint
