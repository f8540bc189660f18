#include "colmap_seapoint/io/outputs/replaceable_file.h"

#include <iterator>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/input_stream.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr std::streamsize kBeginning = 4096;  // bytes

std::string Beginning(const fs::path& file) {
  std::string text(kBeginning, '\0');
  InputStream stream(file);
  stream.read(text.data(), kBeginning);
  text.resize(static_cast<size_t>(stream.gcount()));
  return text;
}

}  // namespace

void CheckReplaceable(const fs::path& file, const std::string& our_words,
                      const std::string& remedy) {
  std::error_code error;
  const fs::file_status status = fs::symlink_status(file, error);
  if (status.type() == fs::file_type::not_found) return;
  if (status.type() == fs::file_type::directory) return;  // who writes it says so
  if (status.type() == fs::file_type::symlink) {
    throw Error(file.string(), "is a link, and what it leads to is never overwritten", remedy);
  }
  if (status.type() == fs::file_type::regular) {
    if (fs::file_size(file, error) == 0 && !error) return;
    if (Beginning(file).find(our_words) != std::string::npos) return;
  }
  throw Error(file.string(), "is there already, and was not made by colmap_seapoint", remedy);
}

}  // namespace colmap_seapoint
