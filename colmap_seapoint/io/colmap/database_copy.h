// A copy of a database, to be changed where the original must not be.
#pragma once

#include <filesystem>

#include "colmap_seapoint/io/colmap/colmap_database.h"

namespace colmap_seapoint {

// Writes all that has been committed to `database` to `copy`, page by page, replacing what is
// there. Throws Error when it cannot be written.
void CopyDatabase(const ColmapDatabase& database, const std::filesystem::path& copy);

}  // namespace colmap_seapoint
