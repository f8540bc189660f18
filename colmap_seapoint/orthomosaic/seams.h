// Which picture colours each block: few seams, and those where pictures agree (ours).
#pragma once

#include <vector>

#include "colmap_seapoint/orthomosaic/exposure.h"
#include "colmap_seapoint/orthomosaic/source_blocks.h"

namespace colmap_seapoint {

// Sets `choice`. Each block begins with its cheapest source; then, several times over all blocks
// like the squares of a chessboard, each takes the source that costs least together with the seams
// to its four neighbours. A seam costs a constant and the difference of the two pictures' balanced
// colours in both blocks. The same for any number of threads. About a microsecond a block.
void ChooseSources(const BlockRelief& blocks, const Exposure& exposure, int num_threads,
                   SourceBlocks* sources);

}  // namespace colmap_seapoint
