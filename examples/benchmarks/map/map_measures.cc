#include "examples/benchmarks/map/map_measures.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include "colmap_seapoint/base/median.h"
#include "colmap_seapoint/orthomosaic/ground/map_view.h"
#include "colmap_seapoint/orthomosaic/sources/picture_sample.h"
#include "examples/benchmarks/map/color_difference.h"
#include "examples/survey/scene/seabed.h"
#include "examples/survey/visibility.h"

namespace colmap_seapoint {
namespace {

constexpr int kPatch = 16;  // half the side of a mark, pixels
constexpr int kSearch = 4;  // pixels
constexpr int kNumMarks = 200;
constexpr int kColorPatch = 8;  // pixels a side

double QuantileOr0(const std::vector<double>& values, double share) {
  return values.empty() ? 0 : Quantile(values, share);
}

// The true surface below the centre of a pixel, along the map's normal.
std::optional<SurfaceHit> TrueSurface(const SurveyTruth& truth, const MemoryMap& map, double column,
                                      double row) {
  const Eigen::Vector2d place = map.Grid().PlaceOf(column, row);
  const Rigid3d world_from_map = map.Frame().map_from_cloud.Inverse();
  const Eigen::Vector3d from = world_from_map * Eigen::Vector3d(place.x(), place.y(), 100);
  const Eigen::Vector3d down = world_from_map.rotation * -Eigen::Vector3d::UnitZ();
  return truth.surface.Trace(from, down, 0, 200);
}

double HeightOf(const MemoryMap& map, const Eigen::Vector3d& world) {
  return (map.Frame().map_from_cloud * world).z();
}

double Luma(const Image<uint8_t>& rgba, int x, int y) {
  return 0.299 * rgba.At(x, y, 0) + 0.587 * rgba.At(x, y, 1) + 0.114 * rgba.At(x, y, 2);
}

// Correlation of a patch of the map with one of the truth, `dx`, `dy` pixels beside it.
double Correlation(const FloatImage& truth, const Image<uint8_t>& rgba, int x, int y, int dx,
                   int dy) {
  double sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0, n = 0;
  for (int v = -kPatch; v <= kPatch; ++v) {
    for (int u = -kPatch; u <= kPatch; ++u) {
      const double a = Luma(rgba, x + u, y + v);
      const double b = double{truth.At(kPatch + kSearch + u + dx, kPatch + kSearch + v + dy)};
      sa += a, sb += b, saa += a * a, sbb += b * b, sab += a * b, n += 1;
    }
  }
  const double variance = (saa - sa * sa / n) * (sbb - sb * sb / n);
  return variance > 0 ? (sab - sa * sb / n) / std::sqrt(variance) : 0;
}

double Peak(double below, double at, double above) {
  const double bend = below - 2 * at + above;
  return bend < 0 ? 0.5 * (below - above) / bend : 0;
}

SeabedOptions OptionsOfSeabed(const SurveyTruth& truth, const SurveyOptions& options) {
  SeabedOptions seabed;
  seabed.seed = static_cast<uint64_t>(options.seed);
  seabed.relief = options.relief;
  seabed.cell = truth.surface.CellSize();
  return seabed;
}

AlbedoMap ColoursOf(const Seabed& seabed, const SurveyTruth& truth) {
  const GridSpec& ground = truth.surface.Ground().Grid();
  return AlbedoMap(seabed, ground.MinX(), ground.MinY(), ground.MaxX(), ground.MaxY(),
                   size_t{200} << 20);
}

Eigen::Array3d LightOfPixel(const Image<uint8_t>& rgba, int x, int y) {
  return {double{LightOf(rgba.At(x, y, 0))}, double{LightOf(rgba.At(x, y, 1))},
          double{LightOf(rgba.At(x, y, 2))}};
}

// Of the mean of a patch of the map and of the truth; nullopt where it is not all coloured ground.
std::optional<double> ColorError(const SurveyTruth& truth, const MemoryMap& map, int x, int y,
                                 AlbedoMap* colours) {
  Eigen::Array3d shown = Eigen::Array3d::Zero(), there = shown;
  for (int v = y; v < y + kColorPatch; ++v) {
    for (int u = x; u < x + kColorPatch; ++u) {
      const auto hit = TrueSurface(truth, map, u + 0.5, v + 0.5);
      if (map.Whole().rgba.At(u, v, 3) == 0 || !hit || hit->part != SurfacePart::kGround) {
        return std::nullopt;
      }
      constexpr double kTexels = 0.01;  // metres that are prepared around
      colours->Prepare(hit->texture.x() - kTexels, hit->texture.y() - kTexels,
                       hit->texture.x() + kTexels, hit->texture.y() + kTexels, 1);
      const Albedo albedo = colours->At(hit->texture.x(), hit->texture.y());
      there += Eigen::Array3d(albedo.red, albedo.green, albedo.blue);
      shown += LightOfPixel(map.Whole().rgba, u, v);
    }
  }
  constexpr double kNumPixels = kColorPatch * kColorPatch;
  return DeltaE2000(LabFromLinear(shown / kNumPixels), LabFromLinear(there / kNumPixels));
}

// How far a patch of the map lies from where the truth shows it; nullopt where it is not found.
std::optional<double> MarkError(const FloatImage& truth, const Image<uint8_t>& rgba, int x, int y) {
  double best = -1;
  int best_x = 0, best_y = 0;
  for (int dy = -kSearch + 1; dy < kSearch; ++dy) {
    for (int dx = -kSearch + 1; dx < kSearch; ++dx) {
      const double score = Correlation(truth, rgba, x, y, dx, dy);
      if (score <= best) continue;
      best = score;
      best_x = dx;
      best_y = dy;
    }
  }
  if (best < 0.5) return std::nullopt;
  const auto at = [&](int dx, int dy) {
    return Correlation(truth, rgba, x, y, best_x + dx, best_y + dy);
  };
  return std::hypot(best_x + Peak(at(-1, 0), best, at(1, 0)),
                    best_y + Peak(at(0, -1), best, at(0, 1)));
}

bool IsWhole(const MemoryMap& map, int x, int y) {
  for (int v = -kPatch; v <= kPatch; ++v) {
    for (int u = -kPatch; u <= kPatch; ++u) {
      if (map.Whole().rgba.At(x + u, y + v, 3) == 0) return false;
    }
  }
  return true;
}

// The true colours around a pixel, as seen from above, in brightness.
FloatImage TruePatch(const SurveyTruth& truth, const MemoryMap& map, int x, int y,
                     AlbedoMap* colours) {
  constexpr int kHalf = kPatch + kSearch;
  FloatImage patch(2 * kHalf + 1, 2 * kHalf + 1);
  const auto low = TrueSurface(truth, map, x - kHalf, y + kHalf + 1);
  const auto high = TrueSurface(truth, map, x + kHalf + 1, y - kHalf);
  if (!low || !high) return patch;
  const double margin = 0.2;
  colours->Prepare(std::min(low->texture.x(), high->texture.x()) - margin,
                   std::min(low->texture.y(), high->texture.y()) - margin,
                   std::max(low->texture.x(), high->texture.x()) + margin,
                   std::max(low->texture.y(), high->texture.y()) + margin, 1);
  for (int v = -kHalf; v <= kHalf; ++v) {
    for (int u = -kHalf; u <= kHalf; ++u) {
      float sum = 0;
      for (int k = 0; k < 4; ++k) {
        const auto hit =
            TrueSurface(truth, map, x + u + 0.25 + 0.5 * (k % 2), y + v + 0.25 + 0.5 * (k / 2));
        if (!hit || hit->part != SurfacePart::kGround) continue;
        const Albedo colour = colours->At(hit->texture.x(), hit->texture.y());
        sum += 0.299f * colour.red + 0.587f * colour.green + 0.114f * colour.blue;
      }
      patch.At(kHalf + u, kHalf + v) = std::sqrt(sum);
    }
  }
  return patch;
}

// What one picture shows at the centre of a pixel of the map, in brightness; of whole levels a
// channel, as the map's own.
std::optional<double> BrightnessIn(const MapView& view, const Picture& picture,
                                   const MemoryMap& map, int x, int y) {
  const Eigen::Vector2d place = map.Grid().PlaceOf(x + 0.5, y + 0.5);
  const auto pixel = view.PixelOf({place.x(), place.y(), double{map.Whole().relief.At(x, y)}});
  if (!pixel) return std::nullopt;
  const auto color =
      ScreenColorAt(picture, static_cast<float>(pixel->x()), static_cast<float>(pixel->y()));
  return 0.299 * std::rint(color[0]) + 0.587 * std::rint(color[1]) + 0.114 * std::rint(color[2]);
}

// Of neighbours, in per cent of their brightness: the map is balanced, the pictures are not.
double ContrastOf(double left, double right) {
  return 100 * std::abs(left - right) / std::max(1.0, 0.5 * (left + right));
}

// Whether two pictures truly see the surface at a pixel or one beside it: on a steep face they may
// see what lies a pixel farther only.
bool IsSeenNear(const SurveyTruth& truth, const SurfaceVisibility& visibility, const MemoryMap& map,
                int x, int y) {
  for (const int i : {4, 0, 1, 2, 3, 5, 6, 7, 8}) {
    const auto hit = TrueSurface(truth, map, x + 0.5 + i % 3 - 1, y + 0.5 + i / 3 - 1);
    if (!hit) continue;
    const std::vector<size_t> pictures = visibility.PicturesAround({hit->xyz});
    if (visibility.Sightings(hit->xyz, hit->normal, pictures).size() >= 2) return true;
  }
  return false;
}

}  // namespace

ReliefErrors MeasureRelief(const SurveyTruth& truth, const MemoryMap& map) {
  std::vector<double> errors;
  const FloatImage& relief = map.Whole().relief;
  const Eigen::Vector3d up =
      map.Frame().map_from_cloud.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  for (int y = 0; y < relief.height; y += 3) {
    for (int x = 0; x < relief.width; x += 3) {
      if (std::isnan(relief.At(x, y))) continue;
      const auto hit = TrueSurface(truth, map, x + 0.5, y + 0.5);
      if (!hit || hit->normal.dot(up) < 0.5) continue;
      errors.push_back(std::abs(HeightOf(map, hit->xyz) - double{relief.At(x, y)}) / truth.gsd);
    }
  }
  return {QuantileOr0(errors, 0.5), QuantileOr0(errors, 0.95)};
}

MapCoverage MeasureCoverage(const SurveyTruth& truth, const std::vector<Eigen::Vector3f>& points,
                            const MemoryMap& map) {
  MapCoverage coverage;
  double num_points = 0, num_colored = 0, num_pixels = 0, num_unseen = 0;
  for (size_t i = 0; i < points.size(); i += 20) {
    const Eigen::Vector3d place = map.Frame().map_from_cloud * points[i].cast<double>();
    const Eigen::Vector2d pixel = map.Grid().PixelOf(place.x(), place.y());
    const auto hit = TrueSurface(truth, map, pixel.x(), pixel.y());
    if (!hit || std::abs(HeightOf(map, hit->xyz) - place.z()) > 2 * truth.gsd) continue;
    ++num_points;
    const int x = static_cast<int>(std::floor(pixel.x()));
    const int y = static_cast<int>(std::floor(pixel.y()));
    if (map.Whole().rgba.Contains(x, y)) num_colored += map.Whole().rgba.At(x, y, 3) > 0;
  }
  const SurfaceVisibility visibility(truth);
  for (int y = 0; y < map.Grid().height; y += 16) {
    for (int x = 0; x < map.Grid().width; x += 16) {
      if (map.Whole().rgba.At(x, y, 3) == 0) continue;
      ++num_pixels;
      num_unseen += !IsSeenNear(truth, visibility, map, x, y);
    }
  }
  coverage.colored_share = num_colored / std::max(1.0, num_points);
  coverage.unseen_share = num_unseen / std::max(1.0, num_pixels);
  return coverage;
}

MarkErrors MeasureMarks(const SurveyTruth& truth, const SurveyOptions& options,
                        const MemoryMap& map) {
  const Seabed seabed(OptionsOfSeabed(truth, options));
  AlbedoMap colours = ColoursOf(seabed, truth);
  std::vector<double> errors;
  const int side = static_cast<int>(std::sqrt(double{kNumMarks} * 2));
  for (int i = 0; i < side * side; ++i) {
    const int x = (2 * (i % side) + 1) * map.Grid().width / (2 * side);
    const int y = (2 * (i / side) + 1) * map.Grid().height / (2 * side);
    const int margin = kPatch + kSearch;
    if (x < margin || y < margin || x + margin >= map.Grid().width ||
        y + margin >= map.Grid().height || !IsWhole(map, x, y)) {
      continue;
    }
    const auto error = MarkError(TruePatch(truth, map, x, y, &colours), map.Whole().rgba, x, y);
    if (error) errors.push_back(*error);
  }
  return {static_cast<int>(errors.size()), QuantileOr0(errors, 0.5), QuantileOr0(errors, 0.95)};
}

double MeasureColors(const SurveyTruth& truth, const SurveyOptions& options, const MemoryMap& map) {
  const Seabed seabed(OptionsOfSeabed(truth, options));
  AlbedoMap colours = ColoursOf(seabed, truth);
  double sum = 0;
  int count = 0;
  for (int y = kColorPatch; y + kColorPatch < map.Grid().height; y += 7 * kColorPatch) {
    for (int x = kColorPatch; x + kColorPatch < map.Grid().width; x += 7 * kColorPatch) {
      const auto difference = ColorError(truth, map, x, y, &colours);
      if (!difference) continue;
      sum += *difference;
      ++count;
    }
  }
  return count == 0 ? 0 : sum / count;
}

SeamSteps MeasureSeams(const SurveyTruth& truth, const MapPictureReader& read,
                       const MemoryMap& map) {
  const std::vector<MapView> views = MakeMapViews(truth.model, map.Frame().map_from_cloud);
  std::map<int32_t, std::vector<std::array<int, 2>>> seams;  // by the left pixel's source
  const MapTile& whole = map.Whole();
  for (int y = 0; y < whole.source.height; ++y) {
    for (int x = 0; x + 1 < whole.source.width; ++x) {
      const int32_t a = whole.source.At(x, y), b = whole.source.At(x + 1, y);
      if (a != b && a != kNoSource && b != kNoSource) seams[a].push_back({x, y});
    }
  }
  std::vector<double> across, inside;
  for (const auto& [source, places] : seams) {
    const Picture picture = read(static_cast<size_t>(source));
    const MapView& view = views[static_cast<size_t>(source)];
    for (const auto& [x, y] : places) {
      const auto left = BrightnessIn(view, picture, map, x, y);
      const auto right = BrightnessIn(view, picture, map, x + 1, y);
      if (!left || !right) continue;
      inside.push_back(ContrastOf(*left, *right));
      across.push_back(ContrastOf(Luma(whole.rgba, x, y), Luma(whole.rgba, x + 1, y)));
    }
  }
  return {static_cast<int>(across.size()), QuantileOr0(across, 0.5), QuantileOr0(inside, 0.5)};
}

}  // namespace colmap_seapoint
