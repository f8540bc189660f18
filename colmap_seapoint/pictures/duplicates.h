// The same picture twice: a folder copied beside itself, a card read twice (ours).
#pragma once

#include <filesystem>
#include <vector>

#include "colmap_seapoint/pictures/image_reader.h"

namespace colmap_seapoint {

// Takes out every picture that has, byte for byte, what one before it has, says so in one line, and
// returns them. A picture without a partner of its size is not read.
std::vector<RunReport::LeftOut> LeaveOutDuplicates(const std::filesystem::path& image_path,
                                                   int num_threads,
                                                   std::vector<ReadablePicture>* pictures);

}  // namespace colmap_seapoint
