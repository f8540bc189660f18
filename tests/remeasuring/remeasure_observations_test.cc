#include "colmap_seapoint/remeasuring/remeasure_observations.h"

#include <gtest/gtest.h>

#include <limits>
#include <mutex>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "tests/remeasuring/measured_world.h"

namespace colmap_seapoint {
namespace {

// Drawn once for all tests.
const MeasuredWorld& TheWorld() {
  static const MeasuredWorld world(1.2);
  return world;
}

GrayImage ReadPicture(const PosedImage& image) { return TheWorld().PictureOf(image); }

Remeasurement Remeasure(const SparseModel& model, int num_threads = 2) {
  RemeasuringOptions options;
  options.num_threads = num_threads;
  return RemeasureObservations(options, model, ReadPicture);
}

size_t NumObservations(const SparseModel& model) {
  size_t num = 0;
  for (const auto& [id, point] : model.points3D) num += point.track.size();
  return num;
}

// Every track and its pictures name each other.
void ExpectConsistent(const SparseModel& model) {
  size_t num = 0;
  for (const PosedImage& image : model.images) {
    for (const uint64_t id : image.point3D_ids) num += id != kNoPoint3D;
  }
  EXPECT_EQ(num, NumObservations(model));
  for (const auto& [id, point] : model.points3D) {
    EXPECT_GE(point.track.size(), 2u);
    for (const SparsePoint::TrackElement& element : point.track) {
      EXPECT_EQ(model.images[element.image_id - 1].point3D_ids[element.point2D_idx], id);
    }
  }
}

void ExpectEqual(const SparseModel& a, const SparseModel& b) {
  ASSERT_EQ(a.images.size(), b.images.size());
  for (size_t i = 0; i < a.images.size(); ++i) {
    EXPECT_EQ(a.images[i].points2D, b.images[i].points2D);
    EXPECT_EQ(a.images[i].point3D_ids, b.images[i].point3D_ids);
  }
  EXPECT_EQ(NumObservations(a), NumObservations(b));
  EXPECT_EQ(a.points3D.size(), b.points3D.size());
}

// The observation of a point in the first picture that is not its reference.
struct Place {
  size_t image_idx;
  uint32_t point2D_idx;
  uint64_t point3D_id;
};

// Observations that RemeasureObservations moves, of tracks of three and more: every `step`-th.
std::vector<Place> MovedPlaces(const SparseModel& before, const SparseModel& after, size_t step) {
  std::vector<Place> moved, places;
  for (size_t i = 0; i < after.images.size(); ++i) {
    for (size_t k = 0; k < after.images[i].points2D.size(); ++k) {
      const uint64_t id = after.images[i].point3D_ids[k];
      if (id == kNoPoint3D || after.points3D.at(id).track.size() < 3) continue;
      if (after.images[i].points2D[k] == before.images[i].points2D[k]) continue;
      moved.push_back({i, static_cast<uint32_t>(k), id});
    }
  }
  for (size_t k = 0; k < moved.size(); k += step) places.push_back(moved[k]);
  return places;
}

TEST(RemeasureObservations, BringsThemToWhereTheyShouldBe) {
  const SparseModel& before = TheWorld().Model();
  ASSERT_GT(NumObservations(before), 1000u);
  const Remeasurement measured = Remeasure(before);
  ExpectConsistent(measured.model);
  const MeasuredErrors errors = ErrorsOfMoved(TheWorld(), before, measured.model);
  EXPECT_GT(errors.before, 1.2);
  EXPECT_LT(errors.after, 0.05);
  const RemeasuringCounts& c = measured.counts;
  EXPECT_EQ(c.references + c.moved + c.unmeasured + c.unlike + c.diverged + c.unsure + c.elsewhere +
                c.twice,
            NumObservations(before));
  EXPECT_GT(c.moved, 8 * (NumObservations(before) - c.references) / 10);
  EXPECT_LT(c.unlike + c.diverged + c.unsure + c.elsewhere, c.moved / 50);
  EXPECT_EQ(c.twice, 0u);
}

TEST(RemeasureObservations, IsTheSameForAnyNumberOfThreads) {
  const Remeasurement one = Remeasure(TheWorld().Model(), 1);
  for (const int num_threads : {2, 5}) {
    ExpectEqual(one.model, Remeasure(TheWorld().Model(), num_threads).model);
  }
}

TEST(RemeasureObservations, LeavesPosesPointsAndLenses) {
  const SparseModel& before = TheWorld().Model();
  const SparseModel after = Remeasure(before).model;
  EXPECT_EQ(after.cameras.at(1).params, before.cameras.at(1).params);
  for (size_t i = 0; i < before.images.size(); ++i) {
    EXPECT_EQ(after.images[i].cam_from_world.translation,
              before.images[i].cam_from_world.translation);
    for (size_t k = 0; k < before.images[i].points2D.size(); ++k) {
      if (before.images[i].point3D_ids[k] != kNoPoint3D) continue;
      EXPECT_EQ(after.images[i].points2D[k], before.images[i].points2D[k]);
    }
  }
  for (const auto& [id, point] : after.points3D) EXPECT_EQ(point.xyz, before.points3D.at(id).xyz);
}

TEST(RemeasureObservations, TakesOutWhatIsPlainlyElsewhere) {
  SparseModel planted = TheWorld().Model();
  const std::vector<Place> places = MovedPlaces(planted, Remeasure(planted).model, 10);
  ASSERT_GT(places.size(), 50u);
  double angle = 0;
  for (const Place& place : places) {
    planted.images[place.image_idx].points2D[place.point2D_idx] +=
        8 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    angle += 1;
  }
  const Remeasurement measured = Remeasure(planted);
  ExpectConsistent(measured.model);
  size_t num_left = 0;
  for (const Place& place : places) {
    num_left += measured.model.images[place.image_idx].point3D_ids[place.point2D_idx] != kNoPoint3D;
  }
  EXPECT_EQ(num_left, 0u);
  EXPECT_LT(ErrorsOfMoved(TheWorld(), planted, measured.model).after, 0.05);
}

// Two pictures that show different places agree on a point that is nowhere.
TEST(RemeasureObservations, TakesOutPointsThatAreNowhere) {
  SparseModel planted = TheWorld().Model();
  std::vector<uint64_t> ids;
  for (auto& [id, point] : planted.points3D) {
    if (id % 10 != 0) continue;
    point.xyz.z() -= 0.8;  // before the surface
    for (const SparsePoint::TrackElement& element : point.track) {
      PosedImage& image = planted.images[element.image_id - 1];
      const auto pixel = planted.cameras.at(1).ImgFromCam(image.cam_from_world * point.xyz);
      image.points2D[element.point2D_idx] = *pixel;
    }
    ids.push_back(id);
  }
  ASSERT_GT(ids.size(), 20u);
  const Remeasurement measured = Remeasure(planted);
  ExpectConsistent(measured.model);
  size_t num_measured = 0;
  for (const uint64_t id : ids) {
    const auto point = measured.model.points3D.find(id);
    if (point == measured.model.points3D.end()) continue;
    for (const SparsePoint::TrackElement& element : point->second.track) {
      const size_t image_idx = element.image_id - 1;
      num_measured += measured.model.images[image_idx].points2D[element.point2D_idx] !=
                      planted.images[image_idx].points2D[element.point2D_idx];
    }
  }
  EXPECT_LE(num_measured, ids.size() / 20);
}

TEST(RemeasureObservations, KeepsOneObservationOfAPointInAPicture) {
  SparseModel doubled = TheWorld().Model();
  for (auto& [id, point] : doubled.points3D) {
    if (id % 7 != 0) continue;
    const SparsePoint::TrackElement element = point.track[id % point.track.size()];
    PosedImage& image = doubled.images[element.image_id - 1];
    point.track.push_back({element.image_id, static_cast<uint32_t>(image.points2D.size())});
    image.points2D.push_back(image.points2D[element.point2D_idx] + Eigen::Vector2d(3, 0));
    image.point3D_ids.push_back(id);
  }
  const Remeasurement measured = Remeasure(doubled);
  ExpectConsistent(measured.model);
  EXPECT_EQ(measured.counts.twice, NumObservations(doubled) - NumObservations(TheWorld().Model()));
  EXPECT_LT(ErrorsOfMoved(TheWorld(), doubled, measured.model).after, 0.05);
}

TEST(RemeasureObservations, APictureThatCannotBeReadEndsIt) {
  for (const uint32_t bad : {1u, 2u, 4u}) {
    const auto read = [&](const PosedImage& image) -> GrayImage {
      if (image.image_id == bad) throw Error(image.name, "is damaged", "copy it again");
      return ReadPicture(image);
    };
    EXPECT_THROW(RemeasureObservations({}, TheWorld().Model(), read), Error);
  }
}

TEST(RemeasureObservations, LeavesWhatIsOfAnotherSize) {
  const SparseModel& before = TheWorld().Model();
  const RemeasuringOptions options;
  const auto check = [&](const GrayPictureReader& read, uint32_t image_id) {
    const Remeasurement measured = RemeasureObservations(options, before, read);
    ExpectConsistent(measured.model);
    EXPECT_EQ(measured.of_other_size, std::vector<std::string>{before.images[image_id - 1].name});
    EXPECT_EQ(measured.model.images[image_id - 1].points2D, before.images[image_id - 1].points2D);
    EXPECT_GT(measured.counts.moved, 0u);
  };
  for (const uint32_t bad : {1u, 2u, 4u}) {
    check(
        [&](const PosedImage& image) -> GrayImage {
          return image.image_id == bad ? GrayImage(100, 100) : ReadPicture(image);
        },
        bad);
  }
}

TEST(RemeasureObservations, LeavesWhatAMaskHides) {
  const SparseModel& before = TheWorld().Model();
  RemeasuringOptions options;
  options.read_mask = [](const PosedImage& image) {
    if (image.image_id != 2) return GrayImage();
    const GrayImage picture = ReadPicture(image);
    GrayImage mask(picture.width, picture.height, 1, 255);
    for (int y = 0; y < mask.height; ++y) {
      std::fill(mask.Row(y), mask.Row(y) + mask.width / 2, uint8_t{0});
    }
    return mask;
  };
  const Remeasurement all = Remeasure(before);
  const Remeasurement masked = RemeasureObservations(options, before, ReadPicture);
  ExpectConsistent(masked.model);
  EXPECT_TRUE(masked.of_other_size.empty());
  EXPECT_GT(masked.counts.unmeasured, all.counts.unmeasured);
  const double middle = TheWorld().Model().cameras.begin()->second.width / 2.0;
  const PosedImage& image = masked.model.images[1];
  size_t num_moved_left = 0, num_moved_right = 0;
  for (size_t i = 0; i < image.points2D.size(); ++i) {
    const double x = before.images[1].points2D[i].x();
    const bool is_moved = image.points2D[i] != before.images[1].points2D[i];
    num_moved_left += is_moved && x < middle - 4;
    num_moved_right += is_moved && x > middle + 20;
  }
  EXPECT_EQ(num_moved_left, 0u);
  EXPECT_GT(num_moved_right, 0u);
}

TEST(RemeasureObservations, ReadsEachPictureTwiceAtMost) {
  std::mutex mutex;
  std::map<std::string, int> num_reads;
  RemeasureObservations({}, TheWorld().Model(), [&](const PosedImage& image) {
    const std::lock_guard<std::mutex> lock(mutex);
    ++num_reads[image.name];
    return ReadPicture(image);
  });
  EXPECT_EQ(num_reads.size(), 4u);
  for (const auto& [name, num] : num_reads) EXPECT_LE(num, 2) << name;
}

TEST(RemeasureObservations, TakesAnyModel) {
  EXPECT_TRUE(Remeasure({}).model.images.empty());
  SparseModel one = TheWorld().Model();
  one.images.resize(1);  // tracks name pictures that are not there
  EXPECT_TRUE(Remeasure(one).model.points3D.empty());

  SparseModel bad = TheWorld().Model();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  size_t k = 0;
  for (auto& [id, point] : bad.points3D) {
    switch (++k % 12) {
      case 0:
        point.xyz.z() = -5;  // behind all cameras
        break;
      case 1:
        point.xyz.x() = nan;
        break;
      case 2:
        point.xyz = bad.images[0].cam_from_world.OriginInSource();
        break;
      case 3:
        point.track.push_back({99, 0});
        break;
      case 4:
        point.track.push_back({1, 1u << 30});
        break;
      case 5:
        bad.images[point.track[0].image_id - 1].points2D[point.track[0].point2D_idx].y() = nan;
        break;
      case 6:
        point.track.clear();
        break;
      default:
        break;
    }
  }
  EXPECT_GT(Remeasure(bad).counts.moved, 100u);
  bad.images[2].cam_from_world.translation.x() = nan;
  bad.cameras[1].params[0] = nan;
  EXPECT_EQ(Remeasure(bad).counts.moved, 0u);
}

}  // namespace
}  // namespace colmap_seapoint
