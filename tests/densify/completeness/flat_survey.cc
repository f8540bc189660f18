#include "tests/densify/completeness/flat_survey.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

namespace colmap_seapoint {
namespace {

constexpr int kWidth = 320, kHeight = 240;

std::vector<Eigen::Vector3d> Lattice(const SparseModel& model, double step) {
  Eigen::Vector3d low(1e9, 1e9, 0), high = -low;
  for (const PosedImage& image : model.images) {
    const Eigen::Vector3d center = image.cam_from_world.OriginInSource();
    low = low.cwiseMin(center);
    high = high.cwiseMax(center);
  }
  std::vector<Eigen::Vector3d> places;
  for (double y = low.y() - 5; y < high.y() + 5; y += step) {
    for (double x = low.x() - 7; x < high.x() + 7; x += step) places.emplace_back(x, y, 0);
  }
  return places;
}

// The two pictures right above a place, or nearly.
std::array<uint32_t, 2> NearestPictures(const SparseModel& model, const Eigen::Vector3d& place) {
  std::vector<std::pair<double, uint32_t>> order;
  for (uint32_t i = 0; i < model.images.size(); ++i) {
    const Eigen::Vector3d center = model.images[i].cam_from_world.OriginInSource();
    order.emplace_back((center - place).squaredNorm(), i);
  }
  std::partial_sort(order.begin(), order.begin() + 2, order.end());
  return {order[0].second, order[1].second};
}

}  // namespace

int TimesSeen(const SparseModel& model, const Eigen::Vector3d& place, double margin) {
  int count = 0;
  for (const PosedImage& image : model.images) {
    const Camera& camera = model.cameras.at(image.camera_id);
    const auto pixel = camera.ImgFromCam(image.cam_from_world * place);
    const Eigen::Vector2d inset(margin, margin);
    count += pixel && camera.InImage(*pixel + inset) && camera.InImage(*pixel - inset) ? 1 : 0;
  }
  return count;
}

SparseModel MakeFlatSurvey(const FlatSurveyOptions& options) {
  SparseModel model;
  Camera camera;
  camera.camera_id = 1;
  camera.model = CameraModel::kPinhole;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.params = {250, 250, kWidth / 2.0, kHeight / 2.0};
  model.cameras[1] = camera;
  for (int s = 0; s < options.num_strips; ++s) {
    for (int k = 0; k < options.per_strip; ++k) {
      PosedImage image;
      image.image_id = static_cast<uint32_t>(model.images.size() + 1);
      image.camera_id = 1;
      image.name = "s" + std::to_string(s) + (k < 10 ? "_0" : "_") + std::to_string(k) + ".jpg";
      // x to the right, y (down in the picture) to -y, z down.
      image.cam_from_world.rotation = Eigen::Quaterniond(0, 1, 0, 0);
      image.cam_from_world.translation =
          -(image.cam_from_world.rotation *
            Eigen::Vector3d(s * options.side, k * options.forward, kFlatAltitude));
      model.images.push_back(image);
    }
  }
  return model;
}

void RemoveImages(const std::set<std::string>& names, SparseModel* model) {
  std::vector<PosedImage> kept;
  for (PosedImage& image : model->images) {
    if (names.count(image.name) == 0) kept.push_back(std::move(image));
  }
  model->images = std::move(kept);
}

PictureFacts TexturedFacts() {
  PictureFacts facts;
  facts.width = kWidth / kPictureCell;
  facts.height = kHeight / kPictureCell;
  facts.texture.assign(static_cast<size_t>(facts.width * facts.height), 80);
  facts.flags.assign(facts.texture.size(), 0);
  facts.sharpness = 0.6;
  return facts;
}

CompletenessInput FlatInput(const SparseModel& model, const KeepPoint& keep) {
  auto points = std::make_shared<std::vector<ConfidentPoint>>();
  for (const Eigen::Vector3d& place : Lattice(model, kFlatGsd)) {
    if (keep(place.head<2>()) && TimesSeen(model, place) >= 2) {
      points->push_back({{place, Eigen::Vector3d::UnitZ()}, 1, NearestPictures(model, place)});
    }
  }
  CompletenessInput input;
  input.model = &model;
  input.num_points = points->size();
  input.for_each_point = [points](const auto& take) {
    for (const ConfidentPoint& point : *points) take(point);
  };
  input.facts.assign(model.images.size(), TexturedFacts());
  return input;
}

double AreaWhere(const SparseModel& model,
                 const std::function<bool(const Eigen::Vector3d&)>& holds) {
  constexpr double kStep = 0.05;
  double area = 0;
  for (const Eigen::Vector3d& place : Lattice(model, kStep)) {
    area += holds(place) ? kStep * kStep : 0;
  }
  return area;
}

double AreaSeen(const SparseModel& model, int times) {
  return AreaWhere(model, [&](const auto& place) { return TimesSeen(model, place) >= times; });
}

double AreaOf(const CompletenessResult& result, GapCause cause) {
  double area = 0;
  for (const Gap& gap : result.gaps) area += gap.region.cause == cause ? gap.region.area : 0;
  return area;
}

}  // namespace colmap_seapoint
