// What masks hide of a pair: nothing is matched there, and no point comes from there (ours; masks
// are COLMAP's, 0 where a picture shows what is not to be reconstructed: a diver, a frame, water).
#pragma once

#include "densify/match/rectification.h"
#include "densify/match/surface_fit.h"
#include "densify/match/view.h"

namespace colmap_seapoint {

// Whether the mask (nullptr or empty: there is none) is 0 at the pixel that holds the place (x, y),
// pixels. Places beyond it are not hidden.
bool IsHidden(const GrayImage* mask, double x, double y);

// Sets to 0, as if outside the picture, what the mask hides. `map` is the one that the picture was
// rectified by.
void HideInRect(const GrayImage* mask, const RectMap& map, int num_threads, RectPicture* picture);

// Removes the samples that either picture's mask hides: where picture 1 was sampled, and where
// their points lie in picture 2. Costs nothing without masks, about 50 ns a sample with them. The
// same result for any number of threads.
void RemoveHidden(const GrayImage* mask1, const GrayImage* mask2, const View& view2,
                  const PairGeometry& geometry, const RectMap& map1, int num_threads,
                  PartialSurface* surface);

}  // namespace colmap_seapoint
