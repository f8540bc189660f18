#include "colmap_seapoint/compare/compare_clouds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/options.h"
#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/compare/cell_measures.h"
#include "colmap_seapoint/compare/nearest.h"
#include "colmap_seapoint/compare/order_statistic.h"
#include "colmap_seapoint/compare/reduced_cloud.h"
#include "colmap_seapoint/io/cloud/ply_reader.h"

namespace colmap_seapoint {
namespace {

constexpr uint64_t kMaxSample = 1000000;  // points of both clouds that lay out view and tiles
constexpr int kMaxThreads = 8;
constexpr int kSpacingTiles = 16;

// Input and reference, in this order everywhere.
using Paths = std::array<std::filesystem::path, 2>;

// Neither copied nor moved, since the clouds keep references to view and partition.
struct TiledClouds {
  TiledClouds(const Paths& paths, const std::filesystem::path& temporary_folder, double tile_points,
              const CompareCallbacks& callbacks);
  TiledClouds(const TiledClouds&) = delete;
  TiledClouds& operator=(const TiledClouds&) = delete;

  PlanView view;
  std::array<CloudSurvey, 2> surveys;  // without their samples
  std::unique_ptr<TilePartition> partition;
  std::array<std::unique_ptr<PointTiles>, 2> clouds;
};

TiledClouds::TiledClouds(const Paths& paths, const std::filesystem::path& temporary_folder,
                         double tile_points, const CompareCallbacks& callbacks) {
  std::array<uint64_t, 2> announced;
  for (size_t c = 0; c < 2; ++c) announced[c] = CloudReader(paths[c]).NumPoints();
  const uint64_t total = announced[0] + announced[1];
  const uint64_t stride = total / kMaxSample + 1;
  auto counter = [&](const char* stage, size_t cloud) -> CountCallback {
    const uint64_t before = cloud == 0 ? 0 : announced[0];
    return [&callbacks, stage, before, total](int64_t done) {
      callbacks.progress(stage, static_cast<int64_t>(before) + done, static_cast<int64_t>(total));
    };
  };
  for (size_t c = 0; c < 2; ++c) {
    surveys[c] = SurveyCloud(paths[c], stride, counter("Reading points", c));
  }
  view = FitPlanView(surveys[0].sample, surveys[1].sample,
                     surveys[0].normal_sum + surveys[1].normal_sum);
  std::vector<Eigen::Array2d> places;
  for (CloudSurvey& survey : surveys) {
    for (const auto& xyz : survey.sample) places.push_back(view.FromWorld(xyz).head<2>().array());
    PointVector().swap(survey.sample);
  }
  partition =
      std::make_unique<TilePartition>(std::move(places), static_cast<double>(stride), tile_points);
  for (size_t c = 0; c < 2; ++c) {
    clouds[c] = std::make_unique<PointTiles>(paths[c], surveys[c].fits_float, temporary_folder,
                                             view, *partition, counter("Sorting points", c));
  }
}

// Sets the spacing of `way`, as kSpacingDefinition says.
void MeasureSpacing(const PointTiles& cloud, int num_threads, const CompareCallbacks& callbacks,
                    OneWay* way) {
  std::vector<int> tiles;
  for (int tile = 0; tile < cloud.Partition().NumTiles(); ++tile) {
    if (cloud.NumPoints(tile) > 0) tiles.push_back(tile);
  }
  const size_t num_chosen = std::min<size_t>(kSpacingTiles, tiles.size());
  std::vector<double> squared;
  OrderedPipeline<std::vector<double>>(
      num_threads, static_cast<int64_t>(num_chosen), 2 * num_threads,
      [&](int64_t i) {
        const int tile = tiles[static_cast<size_t>(i) * tiles.size() / num_chosen];
        return NearestSquared(cloud, tile, cloud.Read(tile), kBeyond, NearestOf::kOtherPlace);
      },
      [&](int64_t i, std::vector<double>&& found) {
        squared.insert(squared.end(), found.begin(), found.end());
        callbacks.progress("Measuring the spacing", i + 1, static_cast<int64_t>(num_chosen));
      });
  const auto middle = squared.begin() + static_cast<std::ptrdiff_t>((squared.size() - 1) / 2);
  std::nth_element(squared.begin(), middle, squared.end());
  way->num_in_spacing = squared.size();
  way->spacing = std::isfinite(*middle) ? std::sqrt(*middle) : 0;
}

// Every cell must have a number, and every place in it one of its own: a double has 53 bits.
void CheckPrecision(double farthest, const std::filesystem::path& path,
                    const CloudComparison& result) {
  constexpr double kMaxCells = 1ll << 50;
  const double least = std::min(
      {0.5 * result.distances.front(), result.voxel_size, result.cell_size, result.area_cell_size});
  if (farthest <= kMaxCells * least) return;
  double distance = result.distances.front();
  throw Error(path.string(),
              "has coordinates up to " + OptionValueText(&farthest) +
                  ", too large for a distance of " + OptionValueText(&distance),
              "move the cloud to the origin, or give larger --distances");
}

void ChooseLengths(const CompareOptions& options, const std::filesystem::path& reference,
                   CloudComparison* result) {
  const double spacing = result->reference.spacing;
  result->distances = options.distances;
  if (options.distances.empty()) {
    if (spacing <= 0) {
      throw Error(reference.string(), "all its points lie in one place: it has no spacing",
                  "give --distances");
    }
    result->distances = {spacing, 2 * spacing, 4 * spacing};
    result->distances_from_spacing = true;
  }
  auto choose = [](double given, double otherwise, double without_spacing) {
    if (given > 0) return given;
    return otherwise > 0 ? otherwise : without_spacing;
  };
  const double least = result->distances.front();
  result->max_distance = choose(options.max_distance, 10 * result->distances.back(), 0);
  result->voxel_size = choose(options.voxel_size, least, 0);
  result->cell_size = choose(options.cell_size, spacing, least);
  result->area_cell_size =
      choose(options.area_cell_size, 4 * std::max(spacing, result->input.spacing), least);
  for (OneWay* way : {&result->input, &result->reference}) {
    way->at.resize(result->distances.size());
  }
}

struct TileWay {
  PointVector points;
  std::vector<double> squared;
  CellLayers cells;
  double sum = 0, sum_squared = 0;  // of distances within max_distance
  uint64_t num_beyond = 0;
  std::vector<uint64_t> num_within;
};

struct TileResult {
  std::array<TileWay, 2> ways;
  std::vector<ReducedShares> reduced;  // by distance
};

TileWay CompareOneWay(const PointTiles& from, const PointTiles& to, int tile,
                      const CloudComparison& setup) {
  TileWay way;
  way.points = from.Read(tile);
  way.squared = NearestSquared(to, tile, way.points, setup.max_distance, NearestOf::kAnyPoint);
  way.num_within.resize(setup.distances.size());
  for (const double squared : way.squared) {
    if (squared == kBeyond) {
      ++way.num_beyond;
      continue;
    }
    way.sum += std::sqrt(squared);
    way.sum_squared += squared;
    for (size_t k = 0; k < setup.distances.size(); ++k) {
      way.num_within[k] += squared <= setup.distances[k] * setup.distances[k];
    }
  }
  way.cells = MeasureCells(from, tile, way.points, way.squared, setup);
  return way;
}

TileResult CompareTile(const TiledClouds& tiled, int tile, const CloudComparison& setup) {
  TileResult result;
  for (size_t c = 0; c < 2; ++c) {
    result.ways[c] = CompareOneWay(*tiled.clouds[c], *tiled.clouds[1 - c], tile, setup);
  }
  for (const double distance : setup.distances) {
    result.reduced.push_back(MeasureReduced(*tiled.clouds[0], *tiled.clouds[1], tile, distance));
  }
  return result;
}

// Adds up what the tiles give, one after the other.
class Summary {
 public:
  Summary(const std::filesystem::path& temporary_folder, int num_tiles)
      : squared_{TileStore(temporary_folder, num_tiles, sizeof(double)),
                 TileStore(temporary_folder, num_tiles, sizeof(double))} {}

  void Add(int tile, const TileResult& found, CloudComparison* result) {
    const std::array<OneWay*, 2> ways = {&result->input, &result->reference};
    for (size_t c = 0; c < 2; ++c) {
      const TileWay& way = found.ways[c];
      squared_[c].Append(tile, way.squared.data(), way.squared.size());
      cells_[c].Merge(way.cells);
      sum_[c] += way.sum;
      sum_squared_[c] += way.sum_squared;
      ways[c]->num_beyond += way.num_beyond;
      for (size_t k = 0; k < found.reduced.size(); ++k) {
        ways[c]->at[k].num_within += way.num_within[k];
      }
    }
    for (size_t k = 0; k < found.reduced.size(); ++k) {
      const ReducedShares& shares = found.reduced[k];
      ways[0]->at[k].num_reduced += shares.num_input;
      ways[0]->at[k].num_reduced_within += shares.num_input_within;
      ways[1]->at[k].num_reduced += shares.num_reference;
      ways[1]->at[k].num_reduced_within += shares.num_reference_within;
    }
  }

  void Finish(CloudComparison* result) {
    const std::array<OneWay*, 2> ways = {&result->input, &result->reference};
    for (size_t c = 0; c < 2; ++c) {
      OneWay& way = *ways[c];
      const auto num_near = static_cast<double>(way.num_points - way.num_beyond);
      way.mean = sum_[c] / num_near;
      way.rms = std::sqrt(sum_squared_[c] / num_near);
      squared_[c].Finish();
      way.median = std::sqrt(KthSmallest(squared_[c], (way.num_points - 1) / 2));
      FinishCells(cells_[c], *result, &way);
    }
  }

 private:
  std::array<TileStore, 2> squared_;
  std::array<CellLayers, 2> cells_;
  std::array<double, 2> sum_ = {}, sum_squared_ = {};
};

void CompareTiles(const TiledClouds& tiled, const std::filesystem::path& temporary_folder,
                  int num_threads, const CompareCallbacks& callbacks, CloudComparison* result) {
  const int num_tiles = tiled.partition->NumTiles();
  Summary summary(temporary_folder, num_tiles);
  const CloudComparison setup = *result;
  const auto total = static_cast<int64_t>(setup.input.num_points + setup.reference.num_points);
  int64_t done = 0;
  OrderedPipeline<TileResult>(
      num_threads, num_tiles, num_threads + 1,
      [&](int64_t tile) { return CompareTile(tiled, static_cast<int>(tile), setup); },
      [&](int64_t tile, TileResult&& found) {
        summary.Add(static_cast<int>(tile), found, result);
        for (size_t c = 0; c < 2; ++c) {
          const TileWay& way = found.ways[c];
          if (callbacks.difference) callbacks.difference(c == 0, way.points, way.squared);
          done += static_cast<int64_t>(way.points.size());
        }
        callbacks.progress("Comparing points", done, total);
      });
  summary.Finish(result);
}

}  // namespace

CloudComparison CompareClouds(const std::filesystem::path& input,
                              const std::filesystem::path& reference,
                              const std::filesystem::path& temporary_folder,
                              const CompareOptions& options, const CompareCallbacks& callbacks) {
  const int num_threads = std::min(kMaxThreads, EffectiveNumThreads(options.num_threads));
  const TiledClouds tiled({input, reference}, temporary_folder, options.tile_points, callbacks);
  CloudComparison result;
  result.input.num_points = tiled.surveys[0].num_points;
  result.reference.num_points = tiled.surveys[1].num_points;
  MeasureSpacing(*tiled.clouds[0], num_threads, callbacks, &result.input);
  MeasureSpacing(*tiled.clouds[1], num_threads, callbacks, &result.reference);
  ChooseLengths(options, reference, &result);
  CheckPrecision(tiled.surveys[0].farthest, input, result);
  CheckPrecision(tiled.surveys[1].farthest, reference, result);
  if (callbacks.begin) {
    callbacks.begin({result, tiled.view, tiled.surveys[0].fits_float, tiled.surveys[1].fits_float});
  }
  CompareTiles(tiled, temporary_folder, num_threads, callbacks, &result);
  return result;
}

}  // namespace colmap_seapoint
