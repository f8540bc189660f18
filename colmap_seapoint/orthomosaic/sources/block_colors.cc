#include "colmap_seapoint/orthomosaic/sources/block_colors.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>

#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/orthomosaic/ground/patch_projection.h"
#include "colmap_seapoint/orthomosaic/sources/picture_sample.h"

namespace colmap_seapoint {
namespace {

constexpr int kSamples = 4;           // along each side of a block
constexpr double kSharpWeight = 0.5;  // of a halving of the contrast, against one of the GSD
constexpr float kMinBlur = 0.6f;      // octaves below the sharpest: less is noise
constexpr float kMaxBlur = 3;         // what is duller still is as bad

// The contrast of a pixel with its neighbours, over its brightness.
float ContrastAt(const GrayImage& luma, int x, int y) {
  if (x < 1 || y < 1 || x + 1 >= luma.width || y + 1 >= luma.height) return 0;
  const int here = luma.At(x, y);
  const int across = std::abs(2 * here - luma.At(x - 1, y) - luma.At(x + 1, y));
  const int along = std::abs(2 * here - luma.At(x, y - 1) - luma.At(x, y + 1));
  return static_cast<float>(across + along) / static_cast<float>(here + 10);
}

// In steps of a sixteenth of an octave above the least contrast that counts.
constexpr float kOctaveSteps = 16, kLeastContrast = 1.0f / 4096;

uint8_t SharpnessOf(float contrast) {
  const float octaves = std::log2(std::max(contrast, kLeastContrast) / kLeastContrast);
  return static_cast<uint8_t>(std::clamp(1 + kOctaveSteps * octaves, 1.0f, 255.0f));
}

class SourceViewer {
 public:
  SourceViewer(const Relief& relief, const MapView& view, const Picture& picture)
      : relief_(relief),
        view_(view),
        picture_(picture),
        scale_x_(static_cast<double>(picture.luma.width) / view.GetCamera().width),
        scale_y_(static_cast<double>(picture.luma.height) / view.GetCamera().height) {}

  // False where the picture shows too little of the block that may be used.
  void Look(int x, int y, Source* source) const {
    float sum[3] = {0, 0, 0}, contrast = 0;
    int count = 0;
    const BlockRelief& blocks = relief_.Blocks();
    const Eigen::Vector3d middle((x + 0.5) * kBlockSize, (y + 0.5) * kBlockSize,
                                 double{blocks.mean[blocks.At(x, y)]});
    const PatchProjection projection(view_, relief_.Grid(), middle);
    for (int i = 0; i < kSamples * kSamples; ++i) {
      constexpr double kStep = static_cast<double>(kBlockSize) / kSamples;
      const int column = i % kSamples, row = i / kSamples;
      const double dx = (column + 0.5) * kStep - 0.5 * kBlockSize;
      const double dy = (row + 0.5) * kStep - 0.5 * kBlockSize;
      const auto pixel = projection.PixelOf(middle + Eigen::Vector3d(dx, dy, 0));
      if (!pixel) continue;
      const auto px = static_cast<float>(scale_x_ * pixel->x());
      const auto py = static_cast<float>(scale_y_ * pixel->y());
      if (IsMasked(picture_, px, py)) continue;
      const std::array<float, 3> color = ScreenColorAt(picture_, px, py);
      for (size_t c = 0; c < 3; ++c) sum[c] += color[c];
      contrast += ContrastAt(picture_.luma, static_cast<int>(px), static_cast<int>(py));
      ++count;
    }
    if (2 * count < kSamples * kSamples) return;
    for (size_t c = 0; c < 3; ++c) {
      source->rgb[c] = static_cast<uint8_t>(sum[c] / static_cast<float>(count) + 0.5f);
    }
    source->sharpness = SharpnessOf(contrast / static_cast<float>(count));
  }

 private:
  const Relief& relief_;
  const MapView& view_;
  const Picture& picture_;
  double scale_x_, scale_y_;
};

// Touches the sources of this picture alone.
void LookAtPicture(const Relief& relief, const MapView& view, uint32_t picture_idx,
                   const std::array<int, 4>& blocks, const Picture& picture,
                   SourceBlocks* sources) {
  const SourceViewer viewer(relief, view, picture);
  for (int y = blocks[1]; y <= blocks[3]; ++y) {
    for (int x = blocks[0]; x <= blocks[2]; ++x) {
      const int32_t at = sources->slot[relief.Blocks().At(x, y)];
      if (at < 0 || sources->IsKept(at)) continue;
      const Source* source = sources->Find(at, picture_idx);
      if (source) viewer.Look(x, y, &sources->Of(at)[source - sources->Of(at)]);
    }
  }
}

// What was not looked at goes, what is dull becomes dearer.
void SortSources(Source* sources) {
  uint8_t sharpest = 0;
  for (int k = 0; k < kMaxSources; ++k) {
    if (sources[k].sharpness == 0) sources[k] = Source();
    sharpest = std::max(sharpest, sources[k].sharpness);
  }
  for (int k = 0; k < kMaxSources; ++k) {
    if (sources[k].picture == kNoPicture) continue;
    const float blur = static_cast<float>(sharpest - sources[k].sharpness) / kOctaveSteps;
    sources[k].cost +=
        static_cast<float>(kSharpWeight) * (std::clamp(blur, kMinBlur, kMaxBlur) - kMinBlur);
  }
  std::stable_sort(sources, sources + kMaxSources, [](const Source& a, const Source& b) {
    if ((a.picture == kNoPicture) != (b.picture == kNoPicture)) return b.picture == kNoPicture;
    return a.cost < b.cost;
  });
}

// All, or those that may colour a block that is not kept.
std::vector<uint8_t> PicturesToLookAt(const SourceBlocks& sources, size_t num_pictures) {
  std::vector<uint8_t> is_wanted(num_pictures, sources.is_kept.empty() ? 1 : 0);
  for (size_t slot = 0; slot < sources.is_kept.size(); ++slot) {
    if (sources.is_kept[slot]) continue;
    const Source* of_block = sources.Of(static_cast<int32_t>(slot));
    for (int k = 0; k < kMaxSources && of_block[k].picture != kNoPicture; ++k) {
      is_wanted[of_block[k].picture] = 1;
    }
  }
  return is_wanted;
}

bool IsUsable(const Camera& camera, const Picture& picture, int reduction) {
  if (picture.Empty()) return false;
  const int width = std::max(1, camera.width >> reduction);
  const int height = std::max(1, camera.height >> reduction);
  return AreScaledSizes(width, height, picture.luma.width, picture.luma.height);
}

}  // namespace

std::vector<size_t> LookAtSources(const Relief& relief, const std::vector<MapView>& views,
                                  int num_threads, const std::function<void(int64_t)>& progress,
                                  MapPictures* pictures, SourceBlocks* sources) {
  std::vector<uint8_t> is_unusable(views.size(), 0);
  const std::vector<std::array<int, 4>> blocks =
      FootprintBlocks(relief.Blocks(), relief.Grid(), views);
  const std::vector<uint8_t> is_wanted = PicturesToLookAt(*sources, views.size());
  std::mutex mutex;
  int64_t num_done = 0;
  const auto look = [&](size_t i) {
    if (!is_wanted[i]) return;
    if (blocks[i][0] > blocks[i][2] || blocks[i][1] > blocks[i][3]) return;
    const auto picture_idx = static_cast<uint32_t>(i);
    const std::shared_ptr<const Picture> picture = pictures->Get(picture_idx);
    is_unusable[i] = !IsUsable(views[i].GetCamera(), *picture, pictures->Reduction(picture_idx));
    if (is_unusable[i]) return;
    LookAtPicture(relief, views[i], picture_idx, blocks[i], *picture, sources);
  };
  ParallelFor(num_threads, static_cast<int64_t>(views.size()), [&](int64_t i) {
    look(static_cast<size_t>(i));
    const std::lock_guard<std::mutex> lock(mutex);
    progress(++num_done);
  });
  ParallelFor(num_threads, static_cast<int64_t>(sources->NumSlots()), [&](int64_t i) {
    const auto slot = static_cast<int32_t>(i);
    if (!sources->IsKept(slot)) SortSources(sources->Of(slot));
  });
  std::vector<size_t> unusable;
  for (size_t i = 0; i < views.size(); ++i) {
    if (is_unusable[i]) unusable.push_back(i);
  }
  return unusable;
}

}  // namespace colmap_seapoint
