#include "colmap_seapoint/orthomosaic/render_tile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>

#include "colmap_seapoint/orthomosaic/ground/patch_projection.h"
#include "colmap_seapoint/orthomosaic/relief/line_of_sight.h"

namespace colmap_seapoint {
namespace {

constexpr uint8_t kAllCorners = 15;
constexpr double kShadowCells = 1.5;  // what hides a place must be higher by, in cells

// The square between the centres of four blocks: block (x, y) is its upper left one. `corners`: bit
// k is set where corner k (left to right, top to bottom) has chosen this picture.
struct Patch {
  uint32_t picture;
  int x, y;
  uint8_t corners;

  bool operator<(const Patch& other) const {
    return std::tie(picture, y, x) < std::tie(other.picture, other.y, other.x);
  }
};

// A pixel of the tile that waits for another picture.
struct Gap {
  uint32_t picture;
  int x, y;

  bool operator<(const Gap& other) const {
    return std::tie(picture, y, x) < std::tie(other.picture, other.y, other.x);
  }
};

struct Sum {  // of what pictures show of a pixel
  Light light = {0, 0, 0};
  float weight = 0;
  float highest = 0;  // weight of any one of them
};

// What a picture's light is multiplied with about one place of it, linear in its pixels.
class LocalExposure {
 public:
  LocalExposure() = default;
  LocalExposure(const Exposure& exposure, const Eigen::Vector2d& on_map, uint32_t picture_idx,
                const Picture& picture, float x, float y)
      : x_(x), y_(y) {
    const auto at = [&](float px, float py) {
      return exposure.FactorAt(picture_idx, px / static_cast<float>(picture.luma.width),
                               py / static_cast<float>(picture.luma.height));
    };
    constexpr float kStep = kBlockSize;
    factor_ = at(x, y);
    const Light right = at(x + kStep, y), below = at(x, y + kStep);
    const Light of_all = exposure.FactorOnMap(on_map);
    for (size_t c = 0; c < 3; ++c) {
      along_x_[c] = of_all[c] * (right[c] - factor_[c]) / kStep;
      along_y_[c] = of_all[c] * (below[c] - factor_[c]) / kStep;
      factor_[c] *= of_all[c];
    }
  }

  void Apply(float x, float y, Light* light) const {
    for (size_t c = 0; c < 3; ++c) {
      (*light)[c] *= factor_[c] + (x - x_) * along_x_[c] + (y - y_) * along_y_[c];
    }
  }

 private:
  float x_ = 0, y_ = 0;
  Light factor_ = {1, 1, 1}, along_x_ = {0, 0, 0}, along_y_ = {0, 0, 0};
};

class TileCanvas {
 public:
  TileCanvas(const MapScene& scene, int tile_idx, MapPictures* pictures)
      : scene_(scene),
        box_(scene.relief.Grid().Tile(tile_idx)),
        relief_(scene.relief.Read(tile_idx)),
        sight_(relief_, box_, scene.relief.Blocks(),
               kShadowCells * scene.relief.CellSide(tile_idx)),
        pictures_(*pictures),
        sums_(static_cast<size_t>(box_.width) * static_cast<size_t>(box_.height)),
        source_(box_.width, box_.height, 1, kNoSource) {}

  void DrawChosen();
  void DrawOthers();
  MapTile Finish();

 private:
  class Brush;
  void AddPatch(int x, int y, std::vector<Patch>* patches) const;
  void DrawPatch(const Patch& patch, Brush* brush);
  std::vector<Gap> FindGaps() const;  // pixels without a colour
  void OfferSources(int rank, std::vector<Gap>* gaps) const;
  MapGrid::Box Within(int x, int y, int width, int height) const {  // what of it is in the tile
    const int left = std::max(x, 0), top = std::max(y, 0);
    return {left, top, std::min(x + width, box_.width) - left,
            std::min(y + height, box_.height) - top};
  }
  void AddColor(int x, int y, uint32_t picture, const Light& light, float weight);
  size_t At(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(box_.width) + static_cast<size_t>(x);
  }

  const MapScene& scene_;
  const MapGrid::Box box_;
  ReliefTile relief_;
  LineOfSight sight_;
  MapPictures& pictures_;
  std::vector<Sum> sums_;
  Image<int32_t> source_;
};

// One picture, to colour pixels of the tile with.
class TileCanvas::Brush {
 public:
  Brush(const TileCanvas& canvas, uint32_t picture)
      : canvas_(canvas),
        view_(canvas.scene_.views[picture]),
        picture_idx_(picture),
        picture_(canvas.pictures_.Get(picture)),
        scale_x_(static_cast<float>(picture_->luma.width) /
                 static_cast<float>(view_.GetCamera().width)),
        scale_y_(static_cast<float>(picture_->luma.height) /
                 static_cast<float>(view_.GetCamera().height)) {
    const MapGrid& grid = canvas.scene_.relief.Grid();
    camera_ << grid.PixelOf(view_.Center().x(), view_.Center().y()), view_.Center().z();
  }

  // The pixels to come are in this part of the tile, no larger than a block: what the lens and the
  // exposure do is worked out in its middle and taken for linear. False where it has no surface.
  bool MoveTo(const MapGrid::Box& area);

  // Calls paint(x, light) for every pixel of the row, from `x` on, that has a surface and that the
  // picture shows. No more than a block's side.
  template <typename Paint>
  void ColorRow(int x, int y, int count, const Paint& paint) const {
    if (picture_->Empty()) return;  // a file may be gone by now
    std::array<float, kBlockSize> px, py;
    const float* heights = canvas_.relief_.heights.Row(y + kReliefMargin) + x + kReliefMargin;
    projection_->PixelsOfRow(canvas_.box_.x + x + 0.5, canvas_.box_.y + y + 0.5, heights, count,
                             px.data(), py.data());
    const uint8_t* surface = canvas_.relief_.surface.Row(y) + x;
    for (int i = 0; i < count; ++i) {
      const auto at = static_cast<size_t>(i);
      if (surface[i] == 0 || std::isnan(px[at])) continue;
      const float u = scale_x_ * px[at], v = scale_y_ * py[at];
      const MapPlace place = PlaceAt(x + i, y);
      if (IsMasked(*picture_, u, v) || IsHidden(place)) continue;
      Light light = LightAt(*picture_, u, v);
      if (canvas_.scene_.restoration != nullptr) Restore(place, &light);
      exposure_.Apply(u, v, &light);
      paint(x + i, light);
    }
  }

 private:
  float HeightAt(int x, int y) const {
    return canvas_.relief_.heights.At(x + kReliefMargin, y + kReliefMargin);
  }
  MapPlace PlaceAt(int x, int y) const {
    return {canvas_.box_.x + x + 0.5, canvas_.box_.y + y + 0.5, double{HeightAt(x, y)}};
  }
  // From afar, all of a block lies in one direction of the camera.
  bool IsHidden(const MapPlace& place) const {
    constexpr double kFar = 20 * kBlockSize;
    if (!(rise_.length > kFar)) return canvas_.sight_.IsHidden(place, camera_);
    Rise rise = rise_;
    rise.slope = (camera_.z() - place.z()) / rise.length;
    return canvas_.sight_.IsHiddenAlong(place, rise);
  }
  void Restore(const MapPlace& place, Light* light) const {
    const Eigen::Vector2d on_map = canvas_.scene_.relief.Grid().PlaceOf(place.x(), place.y());
    const Eigen::Vector3d in_map(on_map.x(), on_map.y(), place.z());
    const double range = (view_.Center() - in_map).norm();
    *light = (*canvas_.scene_.restoration)(*light, static_cast<float>(range),
                                           static_cast<float>(view_.DepthOf(in_map) / range));
  }

  const TileCanvas& canvas_;
  const MapView& view_;
  uint32_t picture_idx_;
  std::shared_ptr<const Picture> picture_;
  float scale_x_, scale_y_;
  MapPlace camera_;
  std::optional<PatchProjection> projection_;
  LocalExposure exposure_;
  Rise rise_;
};

bool TileCanvas::Brush::MoveTo(const MapGrid::Box& area) {
  float lowest = std::numeric_limits<float>::infinity();
  for (int y = area.y; y < area.y + area.height; ++y) {
    for (int x = area.x; x < area.x + area.width; ++x) {
      if (canvas_.relief_.surface.At(x, y) != 0) lowest = std::min(lowest, HeightAt(x, y));
    }
  }
  if (!std::isfinite(lowest) || picture_->Empty()) return false;
  const MapPlace middle(canvas_.box_.x + area.x + 0.5 * area.width,
                        canvas_.box_.y + area.y + 0.5 * area.height, double{lowest});
  projection_.emplace(view_, canvas_.scene_.relief.Grid(), middle);
  rise_ = LineOfSight::RiseTo(middle, camera_);
  rise_.reach = canvas_.sight_.ReachOf(middle, rise_);
  const auto pixel = projection_->PixelOf(middle);  // of a picture's edge, the middle of it
  const Camera& camera = view_.GetCamera();
  const Eigen::Vector2d at =
      pixel.value_or(Eigen::Vector2d(0.5 * camera.width, 0.5 * camera.height));
  const Eigen::Vector2d on_map = canvas_.scene_.relief.Grid().PlaceOf(middle.x(), middle.y());
  exposure_ =
      LocalExposure(canvas_.scene_.exposure, on_map, picture_idx_, *picture_,
                    scale_x_ * static_cast<float>(at.x()), scale_y_ * static_cast<float>(at.y()));
  return true;
}

void TileCanvas::AddPatch(int x, int y, std::vector<Patch>* patches) const {
  const BlockRelief& blocks = scene_.relief.Blocks();
  std::array<uint32_t, 4> chosen;
  for (int k = 0; k < 4; ++k) {
    const int bx = x + k % 2, by = y + k / 2;
    chosen[static_cast<size_t>(k)] =
        blocks.Contains(bx, by) ? scene_.sources.PictureOf(blocks.At(bx, by)) : kNoPicture;
  }
  for (size_t k = 0; k < 4; ++k) {
    const bool is_first = std::find(chosen.begin(), chosen.end(), chosen[k]) ==
                          chosen.begin() + static_cast<std::ptrdiff_t>(k);
    if (chosen[k] == kNoPicture || !is_first) continue;
    uint8_t corners = 0;
    for (size_t i = 0; i < 4; ++i) {
      if (chosen[i] == chosen[k]) corners = static_cast<uint8_t>(corners | 1u << i);
    }
    patches->push_back({chosen[k], x, y, corners});
  }
}

void TileCanvas::AddColor(int x, int y, uint32_t picture, const Light& light, float weight) {
  Sum& sum = sums_[At(x, y)];
  for (size_t c = 0; c < 3; ++c) sum.light[c] += weight * light[c];
  sum.weight += weight;
  if (weight <= sum.highest) return;
  sum.highest = weight;
  source_.At(x, y) = static_cast<int32_t>(picture);
}

// Weights fall off between the blocks' centres, fast about the middle.
void TileCanvas::DrawPatch(const Patch& patch, Brush* brush) {
  constexpr float kStep = 1.0f / kBlockSize;
  const int left = patch.x * kBlockSize + kBlockSize / 2 - box_.x;
  const int top = patch.y * kBlockSize + kBlockSize / 2 - box_.y;
  const MapGrid::Box area = Within(left, top, kBlockSize, kBlockSize);
  if (!brush->MoveTo(area)) return;
  const auto weight_at = [&](int x, int y) {
    if (patch.corners == kAllCorners) return 1.0f;
    const float fx = (static_cast<float>(x - left) + 0.5f) * kStep;
    const float fy = (static_cast<float>(y - top) + 0.5f) * kStep;
    const float corner[4] = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
    float weight = 0;
    for (int k = 0; k < 4; ++k) weight += patch.corners >> k & 1 ? corner[k] : 0;
    return weight * weight * weight * weight;
  };
  for (int y = area.y; y < area.y + area.height; ++y) {
    brush->ColorRow(area.x, y, area.width, [&](int x, const Light& light) {
      AddColor(x, y, patch.picture, light, weight_at(x, y));
    });
  }
}

void TileCanvas::DrawChosen() {
  std::vector<Patch> patches;
  const int first_x = box_.x / kBlockSize - 1, first_y = box_.y / kBlockSize - 1;
  for (int y = first_y; y * kBlockSize < box_.y + box_.height; ++y) {
    for (int x = first_x; x * kBlockSize < box_.x + box_.width; ++x) AddPatch(x, y, &patches);
  }
  std::sort(patches.begin(), patches.end());
  for (size_t i = 0; i < patches.size();) {
    const uint32_t picture = patches[i].picture;
    Brush brush(*this, picture);
    for (; i < patches.size() && patches[i].picture == picture; ++i) DrawPatch(patches[i], &brush);
  }
}

std::vector<Gap> TileCanvas::FindGaps() const {
  std::vector<Gap> gaps;
  for (int y = 0; y < box_.height; ++y) {
    for (int x = 0; x < box_.width; ++x) {
      if (relief_.surface.At(x, y) != 0 && !(sums_[At(x, y)].weight > 0)) {
        gaps.push_back({kNoPicture, x, y});
      }
    }
  }
  return gaps;
}

// Leaves those that still have no colour and whose block has a source of that rank.
void TileCanvas::OfferSources(int rank, std::vector<Gap>* gaps) const {
  const BlockRelief& blocks = scene_.relief.Blocks();
  const auto is_done = [&](Gap& gap) {
    if (sums_[At(gap.x, gap.y)].weight > 0) return true;
    const int32_t at =
        scene_.sources
            .slot[blocks.At((box_.x + gap.x) / kBlockSize, (box_.y + gap.y) / kBlockSize)];
    gap.picture = at < 0 ? kNoPicture : scene_.sources.Of(at)[rank].picture;
    return gap.picture == kNoPicture;  // then those of the next ranks are none either
  };
  gaps->erase(std::remove_if(gaps->begin(), gaps->end(), is_done), gaps->end());
}

void TileCanvas::DrawOthers() {
  std::vector<Gap> gaps = FindGaps();
  for (int rank = 0; rank < kMaxSources; ++rank) {
    OfferSources(rank, &gaps);
    std::sort(gaps.begin(), gaps.end());
    for (size_t i = 0; i < gaps.size();) {
      const uint32_t picture = gaps[i].picture;
      Brush brush(*this, picture);
      for (int x = -kBlockSize, y = -1; i < gaps.size() && gaps[i].picture == picture; ++i) {
        if (gaps[i].y != y || gaps[i].x >= x + kBlockSize) {
          x = gaps[i].x;
          y = gaps[i].y;
          if (!brush.MoveTo(Within(x, y, kBlockSize, 1))) continue;
        }
        brush.ColorRow(gaps[i].x, y, 1,
                       [&](int at, const Light& light) { AddColor(at, y, picture, light, 1); });
      }
    }
  }
}

MapTile TileCanvas::Finish() {
  MapTile tile;
  tile.x = box_.x;
  tile.y = box_.y;
  tile.relief = FloatImage(box_.width, box_.height, 1, kNoHeight);
  tile.rgba = Image<uint8_t>(box_.width, box_.height, 4);
  tile.surface = std::move(relief_.surface);
  tile.source = std::move(source_);
  for (int y = 0; y < box_.height; ++y) {
    for (int x = 0; x < box_.width; ++x) {
      uint8_t& flags = tile.surface.At(x, y);
      if (flags == 0) continue;
      tile.relief.At(x, y) = relief_.heights.At(x + kReliefMargin, y + kReliefMargin);
      const Sum& sum = sums_[At(x, y)];
      if (!(sum.weight > 0)) {
        flags |= kUncolored;
        continue;
      }
      for (size_t c = 0; c < 3; ++c) {
        tile.rgba.At(x, y, static_cast<int>(c)) = ScreenOf(sum.light[c] / sum.weight);
      }
      tile.rgba.At(x, y, 3) = 255;
    }
  }
  return tile;
}

}  // namespace

MapTile RenderTile(const MapScene& scene, int tile_idx, MapPictures* pictures) {
  TileCanvas canvas(scene, tile_idx, pictures);
  canvas.DrawChosen();
  canvas.DrawOthers();
  return canvas.Finish();
}

}  // namespace colmap_seapoint
