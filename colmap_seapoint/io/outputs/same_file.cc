#include "colmap_seapoint/io/outputs/same_file.h"

#include <system_error>

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

// Without the empty last name of "folder/", which leads to the same place.
fs::path Canonical(const fs::path& path) {
  std::error_code ignored;
  const fs::path canonical = fs::weakly_canonical(fs::absolute(path, ignored), ignored);
  return canonical.has_filename() ? canonical : canonical.parent_path();
}

}  // namespace

bool IsSameFile(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  return fs::equivalent(a, b, ignored) || Canonical(a) == Canonical(b);
}

}  // namespace colmap_seapoint
