// An output that is a single file among the user's own: what it holds tells whose it is.
#pragma once

#include <filesystem>
#include <string>

namespace colmap_seapoint {

// Throws Error unless `file` may be written: it does not exist, is empty, or begins (within 4 kB)
// with words that only we write (`our_words`). A link or a device is refused too. `remedy` as in
// class Error.
void CheckReplaceable(const std::filesystem::path& file, const std::string& our_words,
                      const std::string& remedy);

}  // namespace colmap_seapoint
