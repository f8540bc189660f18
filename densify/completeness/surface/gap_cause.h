// Why a place is not in the cloud (ours; the paper's aim, between two dives, is to know where to go
// back to).
#pragma once

#include <cstdint>

namespace colmap_seapoint {

enum class GapCause : uint8_t {
  kNone = 0,       // covered, or not expected
  kNeverImaged,    // no picture holds it
  kImagedOnce,     // one usable picture sees it
  kNoTexture,      // pictures see it, but show nothing that could be matched
  kBadPicture,     // enough pictures see it, but too many of them are blurred or badly exposed
  kPoseLost,       // pictures that are in no model must have seen it
  kOccluded,       // something stands before it in all but too few pictures
  kSmallParallax,  // two pictures and more see it, under nearly the same angle
  kViewsDisagree,  // good pictures see it from two sides, and yet nothing came out
  kOutOfArea,      // outside of what was asked for, or masked in all pictures
};
inline constexpr int kNumGapCauses = 10;

// As completeness.json spells it.
const char* GapCauseName(GapCause cause);

// What a picture's cell (PictureRecord) is.
enum class CellState : uint8_t { kUnknown = 0, kCovered, kNotCovered };

}  // namespace colmap_seapoint
