// A copy of a database, to be changed where the original must not be.
#pragma once

#include <filesystem>

#include "colmap_seapoint/io/colmap/colmap_database.h"

namespace colmap_seapoint {

// Writes all that has been committed to `database` to `copy`, page by page, replacing what is
// there, but for the table of pose priors: its columns changed in 3.11 and 4.0, and a COLMAP that
// finds those of another version may refuse the whole database (4.2.1 those of 3.10, and the other
// way round). No mapper of ours reads it. Throws Error when the copy cannot be written.
void CopyDatabase(const ColmapDatabase& database, const std::filesystem::path& copy);

// Whether there is such a table, which every COLMAP from 3.10 on makes when it opens a database.
bool HasPosePriorTable(const ColmapDatabase& database);

// Removes the file and what SQLite keeps beside it, as far as they are there and can be removed.
void RemoveDatabase(const std::filesystem::path& path);

}  // namespace colmap_seapoint
