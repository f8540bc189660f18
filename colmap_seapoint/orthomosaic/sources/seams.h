// Which picture colours each block: few seams, and those where pictures agree (ours).
#pragma once

#include <vector>

#include "colmap_seapoint/orthomosaic/sources/exposure.h"
#include "colmap_seapoint/orthomosaic/sources/source_blocks.h"

namespace colmap_seapoint {

// Sets `choice`. Each block begins with its cheapest source; then, several times, every row and
// every column of blocks is given what costs it least in all, its neighbours on either side as they
// are (dynamic programming, every second row or column at once). A seam between two blocks costs a
// constant and the difference of the two pictures' balanced colours in both. The same for any
// number of threads. Blocks that are kept stay as they are. About 10 microseconds a block.
void ChooseSources(const BlockRelief& blocks, const Exposure& exposure, int num_threads,
                   SourceBlocks* sources);

}  // namespace colmap_seapoint
