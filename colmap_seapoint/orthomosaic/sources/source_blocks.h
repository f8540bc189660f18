// Which pictures may colour which part of a map, block by block.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "colmap_seapoint/orthomosaic/ground/map_view.h"
#include "colmap_seapoint/orthomosaic/relief/relief.h"

namespace colmap_seapoint {

inline constexpr int kMaxSources = 6;  // a block
inline constexpr uint32_t kNoPicture = 0xffffffff;

// A picture that sees a block's surface from the front, and what it shows there.
struct Source {
  uint32_t picture = kNoPicture;           // position in the model's images
  float cost = 0;                          // the less the better; about 1 for twice the GSD
  std::array<uint8_t, 3> rgb = {0, 0, 0};  // mean of the block in that picture
  uint8_t sharpness = 0;                   // of the contrast of neighbours, in 16ths of an octave;
                                           // 0: not looked at
};

// kMaxSources a block with a surface, the cheapest first, then those without a picture.
struct SourceBlocks {
  std::vector<int32_t> slot;    // by block; -1 where there is no surface
  std::vector<Source> sources;  // kMaxSources a slot
  std::vector<uint8_t> choice;  // by slot: which of its sources colours it (seams.h)
  // By slot: whether it is as in the map that is continued; empty: there is none.
  std::vector<uint8_t> is_kept;

  bool IsKept(int32_t at) const { return !is_kept.empty() && is_kept[static_cast<size_t>(at)]; }

  const Source* Of(int32_t at) const { return &sources[static_cast<size_t>(at) * kMaxSources]; }
  Source* Of(int32_t at) { return &sources[static_cast<size_t>(at) * kMaxSources]; }
  // The picture's place among a slot's sources; nullptr where it is none of them.
  const Source* Find(int32_t at, uint32_t picture) const {
    const Source* found = std::find_if(Of(at), Of(at) + kMaxSources, [&](const Source& source) {
      return source.picture == picture;
    });
    return found == Of(at) + kMaxSources ? nullptr : found;
  }
  // For taking some of the slots, from all over the map and along no row of it.
  static size_t Scattered(int32_t at) {
    return (static_cast<size_t>(at) * 0x9e3779b97f4a7c15ull) >> 32;
  }
  size_t NumSlots() const { return sources.size() / kMaxSources; }
  // The block's chosen picture; kNoPicture where there is none.
  uint32_t PictureOf(size_t block) const {
    const int32_t at = slot[block];
    return at < 0 ? kNoPicture : Of(at)[choice[static_cast<size_t>(at)]].picture;
  }
};

// By geometry alone: the pictures that hold a block's centre and from where no surface hides it.
// Cost: the ground sampling distance there, the angle from the map's normal, and the distance from
// the middle of the picture, where lenses draw best and lamps reach. Pictures that see all of it
// are looked for by their footprints: about 60 ns for each block and picture whose footprints meet.
// With a map that is continued, `kept` has for each block its slot there, -1 where sources are to
// be found anew.
SourceBlocks FindSources(const Relief& relief, const std::vector<MapView>& views, int num_threads,
                         const SourceBlocks* before = nullptr,
                         const std::vector<int32_t>& kept = {});

// The place of a block's centre on the surface, in the map's frame; and the one `dx`, `dy` pixels
// (columns, rows) beside it at the same height.
Eigen::Vector3d PlaceInBlock(const Relief& relief, int x, int y, double dx = 0, double dy = 0);

// The range of blocks that a picture may see, first and last: x, y, x, y; empty where first > last.
std::vector<std::array<int, 4>> FootprintBlocks(const BlockRelief& blocks, const MapGrid& grid,
                                                const std::vector<MapView>& views);

}  // namespace colmap_seapoint
