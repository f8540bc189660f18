#include "tests/densify/test_survey.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {

TestSurvey::TestSurvey(const World& world, const Camera& camera) : world_(world) {
  model_.cameras[1] = camera;
}

void TestSurvey::AddPicture(const std::string& name, const Viewpoint& viewpoint) {
  PosedImage image;
  image.image_id = static_cast<uint32_t>(11 + model_.images.size());
  image.camera_id = 1;
  image.name = name;
  image.cam_from_world = viewpoint.cam_from_world;
  model_.images.push_back(image);
  viewpoints_.push_back(viewpoint);
  pictures_.push_back(TakePicture(world_, viewpoint));
  features_.emplace_back();
}

void TestSurvey::AddLandmarks(int count, const Eigen::Vector2d& x_range,
                              const Eigen::Vector2d& y_range) {
  std::mt19937 generator(6);
  std::uniform_real_distribution<double> x(x_range[0], x_range[1]), y(y_range[0], y_range[1]);
  for (uint64_t id = 1; id <= static_cast<uint64_t>(count); ++id) {
    const double at_x = x(generator), at_y = y(generator);
    const auto point = world_.Cast({at_x, at_y, 0}, {0, 0, 1});
    landmarks_[id] = *point;
    Descriptor descriptor{};
    std::memcpy(descriptor.data(), &id, sizeof(id));
    SparsePoint landmark;
    landmark.xyz = *point;
    for (size_t i = 0; i < viewpoints_.size(); ++i) {
      const auto pixel = PixelOf(world_, viewpoints_[i], *point);
      if (!pixel) continue;
      SeaPoint sea_point;
      sea_point.x = static_cast<float>(pixel->x());
      sea_point.y = static_cast<float>(pixel->y());
      features_[i].points.push_back(sea_point);
      features_[i].descriptors.push_back(descriptor);
      PosedImage& image = model_.images[i];
      landmark.track.push_back({image.image_id, static_cast<uint32_t>(image.points2D.size())});
      image.points2D.push_back(*pixel);
      image.point3D_ids.push_back(id);
    }
    if (landmark.track.size() >= 2) {
      model_.points3D[id] = landmark;
    } else {
      for (const auto& element : landmark.track) {
        model_.images[element.image_id - 11].point3D_ids.back() = kNoPoint3D;
      }
    }
  }
}

void TestSurvey::HideBehindFish(int image_idx, const Eigen::Vector2d& center, double half_side) {
  const auto i = static_cast<size_t>(image_idx);
  const auto hidden = [&](double x, double y) {
    return std::abs(x - center.x()) <= half_side && std::abs(y - center.y()) <= half_side;
  };
  std::mt19937 generator(8);
  ColorImage& picture = pictures_[i];
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      if (!hidden(x + 0.5, y + 0.5)) continue;
      for (int c = 0; c < 3; ++c) picture.At(x, y, c) = static_cast<uint8_t>(generator() % 256);
    }
  }
  Features seen;
  for (size_t k = 0; k < features_[i].points.size(); ++k) {
    if (hidden(features_[i].points[k].x, features_[i].points[k].y)) continue;
    seen.points.push_back(features_[i].points[k]);
    seen.descriptors.push_back(features_[i].descriptors[k]);
  }
  features_[i] = seen;
  PosedImage& image = model_.images[i];
  for (size_t k = 0; k < image.points2D.size(); ++k) {
    if (hidden(image.points2D[k].x(), image.points2D[k].y())) image.point3D_ids[k] = kNoPoint3D;
  }
}

Picture TestSurvey::ReadPicture(int image_idx) {
  if (image_idx == unreadable_) throw Error("a.jpg", "is cut short", "copy it again");
  const std::lock_guard<std::mutex> lock(mutex_);
  ++num_decoded[image_idx];
  return PictureOf(pictures_[static_cast<size_t>(image_idx)]);
}

std::optional<Features> TestSurvey::ReadSeaPoints(int image_idx) {
  if (!stores_seapoints) return std::nullopt;
  return features_[static_cast<size_t>(image_idx)];
}

Features TestSurvey::FindSeaPoints(const Picture& picture) {
  ++num_found;
  for (size_t i = 0; i < pictures_.size(); ++i) {
    if (LumaOf(pictures_[i]).data == picture.luma.data) return features_[i];
  }
  ADD_FAILURE() << "no picture of the survey";
  return {};
}

std::optional<FeatureMatches> TestSurvey::ReadMatches(int image_idx1, int image_idx2) {
  ++num_asked[std::minmax(image_idx1, image_idx2)];
  if (!stores_matches) return std::nullopt;
  --num_matched;
  return Match(features_[static_cast<size_t>(image_idx1)],
               features_[static_cast<size_t>(image_idx2)]);
}

FeatureMatches TestSurvey::Match(const Features& features1, const Features& features2) {
  ++num_matched;
  std::map<Descriptor, uint32_t> second;
  for (uint32_t j = 0; j < features2.points.size(); ++j) second[features2.descriptors[j]] = j;
  FeatureMatches matches;
  for (uint32_t i = 0; i < features1.points.size(); ++i) {
    const auto found = second.find(features1.descriptors[i]);
    if (found != second.end()) matches.push_back({i, found->second});
  }
  return matches;
}

const Eigen::Vector3d& TestSurvey::LandmarkOf(int image_idx, size_t seapoint_idx) const {
  uint64_t id = 0;
  std::memcpy(&id, features_[static_cast<size_t>(image_idx)].descriptors[seapoint_idx].data(),
              sizeof(id));
  return landmarks_.at(id);
}

int64_t Outcome::NumPoints() const {
  int64_t count = 0;
  for (const PartialCloud& cloud : clouds) count += static_cast<int64_t>(cloud.points.size());
  return count;
}

Outcome Densify(TestSurvey* survey, const PartialDensificationOptions& options, int num_threads,
                const std::function<void(const PairDebug&)>& debug, const StereoRig& rig) {
  Outcome outcome;
  int64_t last_done = -1;
  SequenceCallbacks callbacks;
  callbacks.sink = [&](const PartialCloud& cloud) { outcome.clouds.push_back(cloud); };
  callbacks.progress = [&](int64_t done, int64_t total) {
    EXPECT_GT(done, last_done);
    EXPECT_LE(done, total);
    last_done = done;
  };
  callbacks.debug = debug;
  outcome.report = DensifySequence(survey->Model(), survey, options, num_threads, callbacks, rig);
  return outcome;
}

void ExpectSameClouds(const Outcome& one, const Outcome& other) {
  ASSERT_EQ(one.clouds.size(), other.clouds.size());
  ASSERT_GT(one.NumPoints(), 30000);
  for (size_t c = 0; c < one.clouds.size(); ++c) {
    ASSERT_EQ(one.clouds[c].points.size(), other.clouds[c].points.size());
    for (size_t i = 0; i < one.clouds[c].points.size(); ++i) {
      const DensePoint &a = one.clouds[c].points[i], &b = other.clouds[c].points[i];
      ASSERT_TRUE(a.xyz == b.xyz && a.normal == b.normal && a.rgb == b.rgb &&
                  a.confidence == b.confidence);
    }
  }
}

std::set<std::pair<int, int>> CoveredSquares(const World& world,
                                             const std::vector<PartialCloud>& clouds, double side,
                                             double tolerance) {
  std::set<std::pair<int, int>> squares;
  for (const PartialCloud& cloud : clouds) {
    for (const DensePoint& point : cloud.points) {
      if (world.Distance(point.xyz.cast<double>()) > tolerance) continue;
      squares.insert({static_cast<int>(std::floor(point.xyz.x() / side)),
                      static_cast<int>(std::floor(point.xyz.y() / side))});
    }
  }
  return squares;
}

double ShareOnSurface(const World& world, const Outcome& outcome, double tolerance) {
  int64_t num_good = 0;
  for (const PartialCloud& cloud : outcome.clouds) {
    for (const DensePoint& point : cloud.points) {
      num_good += world.Distance(point.xyz.cast<double>()) <= tolerance;
    }
  }
  return static_cast<double>(num_good) / static_cast<double>(outcome.NumPoints());
}

}  // namespace colmap_seapoint
