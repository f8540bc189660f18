#include "colmap_seapoint/orthomosaic/sources/water_samples.h"

#include <algorithm>

#include "colmap_seapoint/water/srgb.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kMaxPlaces = 10000;

int NumSources(const Source* sources) {
  int count = 0;
  while (count < kMaxSources && sources[count].picture != kNoPicture) ++count;
  return count;
}

// Where a picture's camera is from a place: how far, and the cosine off its axis.
struct Sightline {
  float range = 0, axis_cosine = 1;
};

Sightline SightlineOf(const MapView& view, const Eigen::Vector3d& place) {
  const double range = (view.Center() - place).norm();
  return {static_cast<float>(range), static_cast<float>(view.DepthOf(place) / range)};
}

// Calls work(place, slot) for every block with sources.
template <typename WorkOnBlock>
void ForEachBlock(const Relief& relief, const SourceBlocks& sources, const WorkOnBlock& work) {
  for (int y = 0; y < relief.Blocks().height; ++y) {
    for (int x = 0; x < relief.Blocks().width; ++x) {
      const int32_t at = sources.slot[relief.Blocks().At(x, y)];
      if (at >= 0) work(PlaceInBlock(relief, x, y), at);
    }
  }
}

}  // namespace

std::vector<WaterSample> CollectWaterSamples(const Relief& relief,
                                             const std::vector<MapView>& views,
                                             const SourceBlocks& sources) {
  size_t num_places = 0;
  for (size_t i = 0; i < sources.NumSlots(); ++i) {
    num_places += NumSources(sources.Of(static_cast<int32_t>(i))) >= 2 ? 1 : 0;
  }
  const size_t stride = num_places / kMaxPlaces + 1;
  std::vector<WaterSample> samples;
  ForEachBlock(relief, sources, [&](const Eigen::Vector3d& place, int32_t at) {
    const Source* of_block = sources.Of(at);
    const int count = NumSources(of_block);
    if (count < 2 || SourceBlocks::Scattered(at) % stride != 0) return;
    for (int k = 0; k < count; ++k) {
      WaterSample sample;
      sample.place = static_cast<uint32_t>(at);
      sample.picture = of_block[k].picture;
      const Sightline sight = SightlineOf(views[of_block[k].picture], place);
      sample.range = sight.range;
      sample.axis_cosine = sight.axis_cosine;
      for (size_t c = 0; c < 3; ++c) sample.rgb[c] = LinearFromSrgb(of_block[k].rgb[c]);
      samples.push_back(sample);
    }
  });
  return samples;
}

double MaxRange(const Relief& relief, const std::vector<MapView>& views,
                const SourceBlocks& sources) {
  double most = 0;
  ForEachBlock(relief, sources, [&](const Eigen::Vector3d& place, int32_t at) {
    const Source* of_block = sources.Of(at);
    for (int k = 0; k < NumSources(of_block); ++k) {
      most = std::max(most, (views[of_block[k].picture].Center() - place).norm());
    }
  });
  return most;
}

void RestoreSources(const Relief& relief, const std::vector<MapView>& views,
                    const Restoration& restoration, SourceBlocks* sources) {
  ForEachBlock(relief, *sources, [&](const Eigen::Vector3d& place, int32_t at) {
    Source* of_block = sources->Of(at);
    for (int k = 0; k < NumSources(of_block); ++k) {
      std::array<uint8_t, 3>& rgb = of_block[k].rgb;
      const Sightline sight = SightlineOf(views[of_block[k].picture], place);
      const auto restored =
          restoration({LinearFromSrgb(rgb[0]), LinearFromSrgb(rgb[1]), LinearFromSrgb(rgb[2])},
                      sight.range, sight.axis_cosine);
      for (size_t c = 0; c < 3; ++c) rgb[c] = SrgbFromLinear(restored[c]);
    }
  });
}

}  // namespace colmap_seapoint
