#include "colmap_seapoint/orthomosaic/orthomosaic.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/median.h"
#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/orthomosaic/continue_map.h"
#include "colmap_seapoint/orthomosaic/relief/cloud_tiles.h"
#include "colmap_seapoint/orthomosaic/relief/relief.h"
#include "colmap_seapoint/orthomosaic/render_tile.h"
#include "colmap_seapoint/orthomosaic/sources/block_colors.h"
#include "colmap_seapoint/orthomosaic/sources/exposure.h"
#include "colmap_seapoint/orthomosaic/sources/seams.h"
#include "colmap_seapoint/orthomosaic/sources/water_samples.h"
#include "colmap_seapoint/water/estimate_water.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kGsdPoints = 1000;
constexpr int kMaxReduction = 8;
constexpr int kMaxTilesAtOnce = 6;  // about 50 MB each

// Of the time that a map takes.
constexpr double kReliefShare = 0.25, kSourcesShare = 0.25;

std::vector<Eigen::Vector3d> InMap(const MapFrame& frame, std::vector<Eigen::Vector3d> points) {
  for (Eigen::Vector3d& point : points) point = frame.map_from_cloud * point;
  return points;
}

double FindGsd(const std::vector<MapView>& views, const std::vector<Eigen::Vector3d>& sample,
               const std::string& cloud_path) {
  std::vector<Eigen::Vector3d> points;
  for (size_t i = 0; i < sample.size(); i += sample.size() / kGsdPoints + 1) {
    points.push_back(sample[i]);
  }
  const std::optional<double> gsd = SurveyGsd(views, points);
  if (!gsd) {
    throw Error(cloud_path,
                "lies, but for less than half, where no picture of the model looks: they are of "
                "different frames",
                "give the model that this cloud was made from");
  }
  return *gsd;
}

double MedianHeight(const std::vector<Eigen::Vector3d>& sample) {
  std::vector<double> heights;
  for (const Eigen::Vector3d& point : sample) heights.push_back(point.z());
  return UpperMedian(std::move(heights));
}

// How often pictures are halved so that a pixel of theirs is not much smaller than one of the map.
std::vector<int> Reductions(const std::vector<MapView>& views, double ground, double pixel_size) {
  std::vector<int> reductions;
  for (const MapView& view : views) {
    const Eigen::Vector3d below(view.Center().x(), view.Center().y(), ground);
    const double gsd = (view.Center() - below).norm() / view.GetCamera().MeanFocal();
    const double halvings = std::floor(std::log2(pixel_size / gsd) + 0.25);
    reductions.push_back(std::isfinite(halvings)
                             ? static_cast<int>(std::clamp(halvings, 0.0, double{kMaxReduction}))
                             : 0);
  }
  return reductions;
}

// The order of tiles and what is counted of them; the sink sees them in that order.
class TileWriter {
 public:
  TileWriter(size_t num_pictures, MapTileSink* sink, OrthomosaicSummary* summary)
      : sink_(*sink), summary_(*summary), is_used_(num_pictures, 0) {}

  void Take(MapTile&& tile) {
    Count(tile);
    ++summary_.num_tiles_drawn;
    sink_.Take(std::move(tile));
  }

  void TakeOver(const MapGrid::Box& box, int x, int y) { Count(sink_.TakeOver(box, x, y)); }

  std::vector<size_t> PicturesUsed() const {
    std::vector<size_t> used;
    for (size_t i = 0; i < is_used_.size(); ++i) {
      if (is_used_[i]) used.push_back(i);
    }
    return used;
  }

 private:
  void Count(const MapTile& tile) {
    ++summary_.num_tiles;
    for (const uint8_t flags : tile.surface.data) {
      summary_.num_surface_pixels += flags != 0;
      summary_.num_bridged_pixels += (flags & kBridged) != 0;
      summary_.num_filled_pixels += (flags & kFilled) != 0;
      summary_.num_overhang_pixels += (flags & kOverhang) != 0;
      summary_.num_colored_pixels += flags != 0 && (flags & kUncolored) == 0;
    }
    for (const int32_t source : tile.source.data) {
      if (source != kNoSource) is_used_[static_cast<size_t>(source)] = 1;
    }
  }

  MapTileSink& sink_;
  OrthomosaicSummary& summary_;
  std::vector<uint8_t> is_used_;
};

// Whether the tile has a block with a surface.
bool HasBlocks(const BlockRelief& blocks, const MapGrid::Box& box) {
  for (int y = box.y / kBlockSize; y * kBlockSize < box.y + box.height; ++y) {
    for (int x = box.x / kBlockSize; x * kBlockSize < box.x + box.width; ++x) {
      if (!std::isnan(blocks.mean[blocks.At(x, y)])) return true;
    }
  }
  return false;
}

// What is not drawn is taken over.
void RenderTiles(const MapScene& scene, const MapGrowth* growth, int num_threads,
                 const std::function<void(double)>& progress, MapPictures* pictures,
                 TileWriter* writer) {
  const MapGrid& grid = scene.relief.Grid();
  std::vector<int> tiles = TilesAlongCurve(grid);
  tiles.erase(
      std::remove_if(tiles.begin(), tiles.end(),
                     [&](int tile) { return !HasBlocks(scene.relief.Blocks(), grid.Tile(tile)); }),
      tiles.end());
  OrderedPipeline<MapTile>(
      num_threads, static_cast<int64_t>(tiles.size()),
      std::min(EffectiveNumThreads(num_threads), kMaxTilesAtOnce),
      [&](int64_t i) {
        const int tile = tiles[static_cast<size_t>(i)];
        return scene.relief.HasSurface(tile) ? RenderTile(scene, tile, pictures) : MapTile();
      },
      [&](int64_t i, MapTile&& drawn) {
        const int tile = tiles[static_cast<size_t>(i)];
        if (scene.relief.HasSurface(tile)) {
          writer->Take(std::move(drawn));
        } else {
          const MapGrid::Box box = grid.Tile(tile);
          writer->TakeOver(box, box.x - growth->left * kBlockSize,
                           box.y - growth->above * kBlockSize);
        }
        progress(static_cast<double>(i + 1) / static_cast<double>(tiles.size()));
      });
}

// The points by tiles are gone again when the relief is there.
Relief MakeRelief(const OrthomosaicOptions& options, const OrthomosaicInputs& inputs,
                  const MapGrowth* growth, OrthomosaicSummary* summary) {
  const CloudTiles cloud(inputs.cloud_path, summary->frame.map_from_cloud, summary->grid,
                         summary->memory.ground, inputs.temporary_folder,
                         growth ? growth->relief.is_wanted : std::vector<uint8_t>());
  summary->cell_size = growth ? inputs.before->cell_size : cloud.UsualCellSize();
  summary->num_points_outside = cloud.NumOutside();
  return Relief(cloud, summary->grid, options.fill, options.num_threads, inputs.temporary_folder,
                growth ? &growth->relief : nullptr);
}

// nullopt where the survey does not tell what the water does; else the sources are restored.
std::optional<Restoration> RestoreColors(const Relief& relief, const std::vector<MapView>& views,
                                         SourceBlocks* sources, OrthomosaicSummary* summary) {
  summary->water = EstimateWater(CollectWaterSamples(relief, views, *sources));
  const double max_range = MaxRange(relief, views, *sources);
  if (!summary->water->IsDetermined() || !(max_range > 0)) return std::nullopt;
  const Restoration restoration(*summary->water, static_cast<float>(max_range));
  RestoreSources(relief, views, restoration, sources);
  return restoration;
}

// Frame and grid of a map, or those of the map before.
std::optional<MapGrowth> LayOut(const OrthomosaicOptions& options, const OrthomosaicInputs& inputs,
                                std::vector<MapView>* views, OrthomosaicSummary* summary) {
  const MapMemory* before = inputs.before;
  const std::vector<Eigen::Vector3d> cloud_sample = SampleCloud(inputs.cloud_path);
  summary->frame = before ? before->frame
                          : FindMapFrame(options.plane, inputs.model, cloud_sample, inputs.units);
  const std::vector<Eigen::Vector3d> sample = InMap(summary->frame, cloud_sample);
  *views = MakeMapViews(inputs.model, summary->frame.map_from_cloud);
  summary->gsd = before ? before->gsd : FindGsd(*views, sample, inputs.cloud_path.string());
  summary->memory.ground = before ? before->ground : MedianHeight(sample);
  const double pixel_size = options.pixel_size > 0 ? options.pixel_size : summary->gsd;
  summary->grid = MakeMapGrid(sample, pixel_size);
  if (before == nullptr) return std::nullopt;
  MapGrowth growth = GrowMap(*before, summary->grid, inputs.cloud_path, *views);
  summary->grid = growth.grid;
  return growth;
}

Exposure FindExposure(const OrthomosaicOptions& options, const MapMemory* before,
                      const Relief& relief, const std::vector<MapView>& views,
                      const SourceBlocks& sources) {
  if (!options.balance) return EqualExposure(views.size());
  if (before) return ContinueExposure(before->exposure, relief, views, sources);
  return BalanceExposure(relief, views, sources);
}

void Remember(const OrthomosaicInputs& inputs, const Relief& relief, SourceBlocks sources,
              const Exposure& exposure, OrthomosaicSummary* summary) {
  MapMemory& memory = summary->memory;
  memory.frame = summary->frame;
  memory.grid = summary->grid;
  memory.gsd = summary->gsd;
  memory.cell_size = summary->cell_size;
  memory.first_pictures =
      inputs.before ? inputs.before->first_pictures : inputs.model.images.size();
  memory.num_points = NumPointsOf(inputs.cloud_path);
  memory.mean = relief.Blocks().mean;
  memory.lowest = relief.Blocks().lowest;
  memory.highest = relief.Blocks().highest;
  sources.is_kept.clear();
  memory.sources = std::move(sources);
  memory.exposure = exposure;
}

}  // namespace

OrthomosaicSummary MakeOrthomosaic(const OrthomosaicOptions& options,
                                   const OrthomosaicInputs& inputs, MapTileSink* sink) {
  OrthomosaicSummary summary;
  const auto progress = [&](double before, double share, double done) {
    if (inputs.progress) inputs.progress(before + share * done);
  };
  std::vector<MapView> views;
  const std::optional<MapGrowth> growth = LayOut(options, inputs, &views, &summary);
  const MapGrowth* const grown = growth ? &*growth : nullptr;
  const Relief relief = MakeRelief(options, inputs, grown, &summary);
  progress(0, kReliefShare, 1);

  MapPictures pictures(inputs.read,
                       Reductions(views, summary.memory.ground, summary.grid.pixel_size),
                       options.picture_bytes);
  SourceBlocks sources =
      grown ? FindSources(relief, views, options.num_threads, &inputs.before->sources,
                          KeptSlots(*inputs.before, *grown, relief, views))
            : FindSources(relief, views, options.num_threads);
  const auto num_views = static_cast<double>(views.size());
  summary.pictures_unread = LookAtSources(
      relief, views, options.num_threads,
      [&](int64_t i) { progress(kReliefShare, kSourcesShare, static_cast<double>(i) / num_views); },
      &pictures, &sources);
  const std::optional<Restoration> restoration =
      options.restore ? RestoreColors(relief, views, &sources, &summary) : std::nullopt;
  const Exposure exposure = FindExposure(options, inputs.before, relief, views, sources);
  ChooseSources(relief.Blocks(), exposure, options.num_threads, &sources);

  sink->Begin(summary.frame, summary.grid);
  TileWriter writer(views.size(), sink, &summary);
  constexpr double kBefore = kReliefShare + kSourcesShare;
  RenderTiles(
      {relief, views, sources, exposure, restoration ? &*restoration : nullptr}, grown,
      options.num_threads, [&](double share) { progress(kBefore, 1 - kBefore, share); }, &pictures,
      &writer);
  summary.pictures_used = writer.PicturesUsed();
  summary.num_picture_reads = pictures.NumReads();
  Remember(inputs, relief, std::move(sources), exposure, &summary);
  return summary;
}

}  // namespace colmap_seapoint
