// Which pairs are worth matching by their place in the order of names alone.
#pragma once

#include <vector>

#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"

namespace colmap_seapoint {

void SortNaturally(std::vector<DatabaseImage>* images);

// Pictures in the natural order of their whole names, each with its `overlap` successors: as in
// COLMAP, a sequence goes on from one folder into the next.
std::vector<ImagePair> SequentialPairs(std::vector<DatabaseImage> images, int overlap);

// Every pair, in blocks of pictures, so that few pictures are needed at a time.
std::vector<ImagePair> ExhaustivePairs(std::vector<DatabaseImage> images);

}  // namespace colmap_seapoint
