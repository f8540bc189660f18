// Whether two paths lead to one file or folder.
#pragma once

#include <filesystem>

namespace colmap_seapoint {

// By device and inode, so through links of both kinds too. Where one of them does not exist yet, by
// the folder that it would come to lie in and its name there.
bool IsSameFile(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace colmap_seapoint
