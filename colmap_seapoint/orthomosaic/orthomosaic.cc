#include "colmap_seapoint/orthomosaic/orthomosaic.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/median.h"
#include "colmap_seapoint/base/parallel.h"
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
    sink_.Take(std::move(tile));
  }

  std::vector<size_t> PicturesUsed() const {
    std::vector<size_t> used;
    for (size_t i = 0; i < is_used_.size(); ++i) {
      if (is_used_[i]) used.push_back(i);
    }
    return used;
  }

 private:
  MapTileSink& sink_;
  OrthomosaicSummary& summary_;
  std::vector<uint8_t> is_used_;
};

void RenderTiles(const MapScene& scene, int num_threads,
                 const std::function<void(double)>& progress, MapPictures* pictures,
                 TileWriter* writer) {
  std::vector<int> tiles = TilesAlongCurve(scene.relief.Grid());
  tiles.erase(std::remove_if(tiles.begin(), tiles.end(),
                             [&](int tile) { return !scene.relief.HasSurface(tile); }),
              tiles.end());
  OrderedPipeline<MapTile>(
      num_threads, static_cast<int64_t>(tiles.size()),
      std::min(EffectiveNumThreads(num_threads), kMaxTilesAtOnce),
      [&](int64_t i) { return RenderTile(scene, tiles[static_cast<size_t>(i)], pictures); },
      [&](int64_t i, MapTile&& tile) {
        writer->Take(std::move(tile));
        progress(static_cast<double>(i + 1) / static_cast<double>(tiles.size()));
      });
}

// The points by tiles are gone again when the relief is there.
Relief MakeRelief(const OrthomosaicOptions& options, const OrthomosaicInputs& inputs, double ground,
                  OrthomosaicSummary* summary) {
  const CloudTiles cloud(inputs.cloud_path, summary->frame.map_from_cloud, summary->grid, ground,
                         inputs.temporary_folder);
  summary->cell_size = cloud.UsualCellSize();
  summary->num_points_outside = cloud.NumOutside();
  return Relief(cloud, summary->grid, options.fill, options.num_threads, inputs.temporary_folder);
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

}  // namespace

OrthomosaicSummary MakeOrthomosaic(const OrthomosaicOptions& options,
                                   const OrthomosaicInputs& inputs, MapTileSink* sink) {
  OrthomosaicSummary summary;
  const auto progress = [&](double before, double share, double done) {
    if (inputs.progress) inputs.progress(before + share * done);
  };
  const std::vector<Eigen::Vector3d> cloud_sample = SampleCloud(inputs.cloud_path);
  summary.frame = FindMapFrame(options.plane, inputs.model, cloud_sample, inputs.units);
  const std::vector<Eigen::Vector3d> sample = InMap(summary.frame, cloud_sample);
  const std::vector<MapView> views = MakeMapViews(inputs.model, summary.frame.map_from_cloud);
  summary.gsd = FindGsd(views, sample, inputs.cloud_path.string());
  summary.grid = MakeMapGrid(sample, options.pixel_size > 0 ? options.pixel_size : summary.gsd);

  const double ground = MedianHeight(sample);
  const Relief relief = MakeRelief(options, inputs, ground, &summary);
  progress(0, kReliefShare, 1);

  MapPictures pictures(inputs.read, Reductions(views, ground, summary.grid.pixel_size),
                       options.picture_bytes);
  SourceBlocks sources = FindSources(relief, views, options.num_threads);
  const auto num_views = static_cast<double>(views.size());
  summary.pictures_unread = LookAtSources(
      relief, views, options.num_threads,
      [&](int64_t i) { progress(kReliefShare, kSourcesShare, static_cast<double>(i) / num_views); },
      &pictures, &sources);
  const std::optional<Restoration> restoration =
      options.restore ? RestoreColors(relief, views, &sources, &summary) : std::nullopt;
  const Exposure exposure =
      options.balance ? BalanceExposure(relief, views, sources) : EqualExposure(views.size());
  ChooseSources(relief.Blocks(), exposure, options.num_threads, &sources);

  sink->Begin(summary.frame, summary.grid);
  TileWriter writer(views.size(), sink, &summary);
  constexpr double kBefore = kReliefShare + kSourcesShare;
  RenderTiles(
      {relief, views, sources, exposure, restoration ? &*restoration : nullptr},
      options.num_threads, [&](double share) { progress(kBefore, 1 - kBefore, share); }, &pictures,
      &writer);
  summary.pictures_used = writer.PicturesUsed();
  summary.num_picture_reads = pictures.NumReads();
  return summary;
}

}  // namespace colmap_seapoint
