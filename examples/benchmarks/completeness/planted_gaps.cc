#include "examples/benchmarks/completeness/planted_gaps.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "colmap_seapoint/io/files/atomic_file.h"
#include "examples/survey/paths/survey_port.h"
#include "examples/survey/scene/noise.h"

namespace colmap_seapoint {
namespace {

using Json = nlohmann::json;
constexpr double kBlurSigma = 4;  // pixels

struct Extent {
  Eigen::Vector2d low, high;
};

Extent ExtentOf(const SurveyTruth& truth) {
  Extent extent{{1e9, 1e9}, {-1e9, -1e9}};
  for (const PosedImage& image : truth.model.images) {
    const Eigen::Vector2d at =
        truth.surface.InGround(image.cam_from_world.OriginInSource()).head<2>();
    extent.low = extent.low.cwiseMin(at);
    extent.high = extent.high.cwiseMax(at);
  }
  return extent;
}

std::optional<Eigen::Vector2d> GroundPlace(const SurveyTruth& truth, const PortCamera& camera,
                                           const Rigid3d& world_from_cam, double x, double y) {
  const auto ray = camera.Ray({x, y});
  if (!ray) return std::nullopt;
  const auto hit = truth.surface.Trace(world_from_cam * ray->origin,
                                       world_from_cam.rotation * ray->direction, 0, 1e3);
  if (!hit || hit->part != SurfacePart::kGround) return std::nullopt;
  return Eigen::Vector2d(truth.surface.InGround(hit->xyz).head<2>());
}

// 0 outside of all discs to 1 inside, over a tenth of the radius.
float Depth(const std::vector<Disc>& discs, const Eigen::Vector2d& place) {
  float depth = 0;
  for (const Disc& disc : discs) {
    const double inside = (disc.radius - (place - disc.center).norm()) / (0.1 * disc.radius);
    depth = std::max(depth, SmoothStep(0, 1, static_cast<float>(inside)));
  }
  return depth;
}

uint8_t Blend(uint8_t old, double value, float weight) {
  return static_cast<uint8_t>(std::clamp(Mix(old, static_cast<float>(value), weight), 0.f, 255.f));
}

Json DiscsJson(const std::vector<Disc>& discs) {
  Json json = Json::array();
  for (const Disc& d : discs) json.push_back({d.center.x(), d.center.y(), d.radius});
  return json;
}

std::vector<Disc> DiscsOf(const Json& json) {
  std::vector<Disc> discs;
  for (const Json& d : json) {
    discs.push_back(
        {Eigen::Vector2d(d.at(0).get<double>(), d.at(1).get<double>()), d.at(2).get<double>()});
  }
  return discs;
}

}  // namespace

PlantedGaps ChooseGaps(const SurveyTruth& truth, int num_strips, int seed) {
  PlantedGaps gaps;
  const Extent extent = ExtentOf(truth);
  const Eigen::Vector2d size = extent.high - extent.low;
  const double radius = 120 * truth.gsd;
  const auto at = [&](double x, double y, int k) -> Disc {
    const double dx = 0.1 * (Uniform(Hash(static_cast<uint64_t>(seed), k)) - 0.5);
    return {extent.low + size.cwiseProduct(Eigen::Vector2d(x + dx, y + dx)), radius};
  };
  gaps.smooth.push_back(at(0.2, 0.25, 1));
  gaps.moving.push_back(at(0.8, 0.75, 2));
  const auto& images = truth.model.images;
  const size_t count = images.size();
  // In the middle of a strip.
  const auto take = [&](int strip, size_t num, std::set<std::string>* names) {
    const double middle = (strip % num_strips + 0.5) * static_cast<double>(count) / num_strips;
    const size_t first = static_cast<size_t>(middle) - num / 2;
    for (size_t i = first; i < std::min(count, first + num); ++i) names->insert(images[i].name);
  };
  take(0, 4, &gaps.blurred);
  take(1, 3, &gaps.lost);
  take(2, 6, &gaps.removed);
  return gaps;
}

void PlantInPicture(const SurveyTruth& truth, const PlantedGaps& gaps, const PosedImage& image,
                    ColorImage* picture) {
  const PortCamera camera(truth.port, truth.model.cameras.at(image.camera_id));
  const Rigid3d world_from_cam = image.cam_from_world.Inverse();
  for (int y = 0; y < picture->height; ++y) {
    for (int x = 0; x < picture->width; ++x) {
      const auto place = GroundPlace(truth, camera, world_from_cam, x + 0.5, y + 0.5);
      if (!place) continue;
      const float smooth = Depth(gaps.smooth, *place), moving = Depth(gaps.moving, *place);
      if (smooth <= 0 && moving <= 0) continue;
      const uint64_t seed = Hash(image.image_id, x, y);
      const double sand = 120 + 1.2 * Bell(seed);
      const double kelp = 110 + 90 * NoiseAt(x, y, 9, image.image_id) +
                          60 * NoiseAt(x, y, 4, image.image_id + 7000);
      for (int c = 0; c < 3; ++c) {
        uint8_t& value = picture->At(x, y, c);
        value = Blend(value, sand, smooth);
        value = Blend(value, kelp, moving);
      }
    }
  }
  if (gaps.blurred.count(image.name) == 0) return;
  cv::Mat view(picture->height, picture->width, CV_8UC3, picture->data.data());
  cv::GaussianBlur(view, view, cv::Size(), kBlurSigma);
}

void WritePlantedGaps(const std::filesystem::path& path, const PlantedGaps& gaps) {
  const Json json = {{"smooth", DiscsJson(gaps.smooth)},
                     {"moving", DiscsJson(gaps.moving)},
                     {"blurred", gaps.blurred},
                     {"lost", gaps.lost},
                     {"removed", gaps.removed}};
  WriteTextFile(path, json.dump(1) + "\n");
}

PlantedGaps ReadPlantedGaps(const std::filesystem::path& path) {
  std::ifstream in(path);
  const Json json = Json::parse(in);
  PlantedGaps gaps;
  gaps.smooth = DiscsOf(json.at("smooth"));
  gaps.moving = DiscsOf(json.at("moving"));
  json.at("blurred").get_to(gaps.blurred);
  json.at("lost").get_to(gaps.lost);
  json.at("removed").get_to(gaps.removed);
  return gaps;
}

}  // namespace colmap_seapoint
