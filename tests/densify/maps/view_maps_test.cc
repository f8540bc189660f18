// Maps of exact clouds of exact worlds: depth, normals, occlusion, gaps.
#include "densify/maps/view_maps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/synthetic/world.h"

namespace colmap_seapoint {
namespace {

constexpr int kWidth = 200, kHeight = 150;

Camera Pinhole() {
  Camera camera = MakeCamera(CameraModel::kPinhole, 180, kWidth, kHeight);
  camera.params[1] = 190;
  camera.params[2] += 7.25;
  return camera;
}

// Exact samples of what the first picture of a pair sees, `step` pixels apart.
struct Samples {
  SampleFrame frame;
  std::vector<DensePoint> points;
};

Samples Sample(const World& world, const Viewpoint& view1, const Viewpoint& view2, int step,
               double normal_sign = 1) {
  const auto geometry =
      MakePairGeometry(view1.camera, view1.cam_from_world, view2.camera, view2.cam_from_world);
  Samples samples{{*geometry, static_cast<double>(step)}, {}};
  const double reach = 2 * kWidth;
  for (double y = -reach; y < reach; y += step) {
    for (double x = -reach; x < reach; x += step) {
      const auto ray = [&](double dx, double dy) {
        return Eigen::Vector3d(geometry->world_from_rect * geometry->RayAt(x + dx, y + dy));
      };
      const auto point = world.Cast(geometry->center1, ray(0, 0));
      const auto right = world.Cast(geometry->center1, ray(1e-3, 0));
      const auto below = world.Cast(geometry->center1, ray(0, 1e-3));
      if (!point || !right || !below) continue;
      Eigen::Vector3d normal = (*right - *point).cross(*below - *point).normalized();
      if (normal.dot(ray(0, 0)) > 0) normal = -normal;
      samples.points.push_back(
          {point->cast<float>(), (normal_sign * normal).cast<float>(), {0, 0, 0}, 1});
    }
  }
  return samples;
}

ViewMaps Draw(const Viewpoint& view, const std::vector<Samples>& parts) {
  ViewMapRenderer renderer(view.camera, view.cam_from_world);
  for (const Samples& part : parts) {
    renderer.Add(part.frame, part.points.data(), part.points.size());
  }
  return renderer.Finish();
}

// What COLMAP's fusion takes the value at (c, r) for.
std::optional<double> TrueDepth(const World& world, const Viewpoint& view, int c, int r) {
  const auto point = SurfaceAt(world, view, {c, r});
  if (!point) return std::nullopt;
  return (view.cam_from_world * *point).z();
}

TEST(ViewMaps, PlaneIsExactAndWithoutGaps) {
  const World world = SlantedWorld(3, 25);
  const Viewpoint view1 = StandAt(Pinhole(), {0, 0, 0}, {2, -3, 10});
  const Viewpoint view2 = StandAt(Pinhole(), {0.4, 0.05, 0}, {0, 1, 0});
  for (const int step : {1, 2, 4}) {
    const Samples samples = Sample(world, view1, view2, step);
    // Turned upside down, nearer, farther, from aside.
    for (const Viewpoint& view : {view1, StandAt(Pinhole(), {0.1, 0.1, 0.5}, {3, 5, 180}),
                                  StandAt(Pinhole(), {0, 0.2, -0.8}, {0, 0, 45}),
                                  StandAt(Pinhole(), {-0.6, 0, 0.1}, {0, 20, 0})}) {
      const ViewMaps maps = Draw(view, {samples});
      int num_seen = 0;
      for (int r = 0; r < kHeight; ++r) {
        for (int c = 0; c < kWidth; ++c) {
          const auto depth = TrueDepth(world, view, c, r);
          ASSERT_TRUE(depth.has_value());
          const Eigen::Vector3d normal =
              view.cam_from_world.rotation *
              (Eigen::AngleAxisd(25 * M_PI / 180, Eigen::Vector3d::UnitY()) *
               -Eigen::Vector3d::UnitZ());
          if (maps.depth.At(c, r) == 0) continue;
          ++num_seen;
          ASSERT_NEAR(maps.depth.At(c, r), *depth, 1e-5 * *depth) << c << ' ' << r;
          const Eigen::Vector3d found(maps.normal.At(c, r, 0), maps.normal.At(c, r, 1),
                                      maps.normal.At(c, r, 2));
          ASSERT_LT((found - normal).norm(), 1e-3)
              << found.transpose() << " / " << normal.transpose();
        }
      }
      // Samples reach beyond all of these pictures.
      EXPECT_EQ(num_seen, kWidth * kHeight) << "step " << step;
    }
  }
}

TEST(ViewMaps, NearHidesFarInAnyOrder) {
  const World world = StepWorld(2, 3, -1);  // near where x < 0
  const Viewpoint view1 = StandAt(Pinhole(), {0, 0, 0});
  const Viewpoint view2 = StandAt(Pinhole(), {0.3, 0, 0});
  const Samples all = Sample(world, view1, view2, 2);
  Samples near{all.frame, {}}, far{all.frame, {}};
  for (const DensePoint& point : all.points) {
    const double z = point.xyz.z();
    if (std::abs(z - 2) < 1e-4) near.points.push_back(point);
    if (std::abs(z - 3) < 1e-4) far.points.push_back(point);
  }
  ASSERT_GT(near.points.size(), 1000u);
  ASSERT_GT(far.points.size(), 1000u);
  // From the left the near level hides what view1 sees of the far one.
  const Viewpoint view = StandAt(Pinhole(), {-0.8, 0, 0}, {0, -14, 0});
  const ViewMaps maps = Draw(view, {near, far}), other = Draw(view, {far, near});
  EXPECT_EQ(maps.depth.data, other.depth.data);
  EXPECT_EQ(maps.normal.data, other.normal.data);
  int num_near = 0, num_far = 0, num_hidden_far = 0;
  for (int r = 0; r < kHeight; ++r) {
    for (int c = 0; c < kWidth; ++c) {
      const float depth = maps.depth.At(c, r);
      const auto truth = SurfaceAt(world, view, {c, r});
      ASSERT_TRUE(truth.has_value());
      if (std::abs(truth->x()) < 0.05) continue;  // patches reach over the edge by half a sample
      const double expected = (view.cam_from_world * *truth).z();
      const bool is_near = truth->z() < 2.5;
      // The near level is seen in full; of the far one what view1 has seen.
      if (is_near) {
        ASSERT_GT(depth, 0) << c << ' ' << r;
      }
      if (depth > 0) {
        ASSERT_NEAR(depth, expected, 1e-3) << c << ' ' << r;
      }
      num_near += is_near;
      num_far += !is_near && depth > 0;
    }
  }
  for (const DensePoint& point : far.points) {
    num_hidden_far += !PixelOf(world, view, point.xyz.cast<double>()).has_value();
  }
  EXPECT_GT(num_near, 3000);
  EXPECT_GT(num_far, 3000);
  EXPECT_GT(num_hidden_far, 100);  // or the test shows nothing
}

TEST(ViewMaps, FromBehindHidesAndIsNotSeen) {
  const Viewpoint view1 = StandAt(Pinhole(), {0, 0, 0}), view2 = StandAt(Pinhole(), {0.3, 0, 0});
  const Samples far = Sample(FlatWorld(3), view1, view2, 2);
  const World patch({{{0, 0, 2}, {0.3, 0, 0}, {0, 0.3, 0}}}, NoiseTexture(1, 0.1, 2));
  const Samples behind = Sample(patch, view1, view2, 2, -1);
  const ViewMaps maps = Draw(view1, {far, behind});
  int num_hidden = 0;
  for (int r = 0; r < kHeight; ++r) {
    for (int c = 0; c < kWidth; ++c) {
      const auto point = SurfaceAt(FlatWorld(2), view1, {c, r});
      const double aside = point->head<2>().cwiseAbs().maxCoeff();
      if (aside < 0.28) {
        ASSERT_EQ(maps.depth.At(c, r), 0);
        ++num_hidden;
      }
      if (aside > 0.34) {
        ASSERT_NEAR(maps.depth.At(c, r), 3, 1e-4);
      }
    }
  }
  EXPECT_GT(num_hidden, 1000);
}

TEST(ViewMaps, NothingBehindTheCamera) {
  const Viewpoint view1 = StandAt(Pinhole(), {0, 0, 0}), view2 = StandAt(Pinhole(), {0.3, 0, 0});
  const Samples samples = Sample(FlatWorld(3), view1, view2, 2);
  const ViewMaps maps = Draw(StandAt(Pinhole(), {0, 0, 3.5}), {samples});
  for (const float depth : maps.depth.data) ASSERT_EQ(depth, 0);
}

// Spheres are kept whenever a point of them is in the picture; far ones aside are not.
TEST(ViewMaps, MayShowIsNeverWronglyFalse) {
  const Viewpoint view = StandAt(Pinhole(), {0.5, -0.2, 1}, {5, -8, 30});
  const ViewMapRenderer renderer(view.camera, view.cam_from_world);
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> coordinate(-3, 3), small(0, 0.5);
  int num_shown = 0, num_culled = 0;
  for (int i = 0; i < 100000; ++i) {
    const Eigen::Vector3d center(coordinate(generator), coordinate(generator),
                                 coordinate(generator));
    const double radius = small(generator);
    const Eigen::Vector3d direction =
        Eigen::Vector3d(coordinate(generator), coordinate(generator), coordinate(generator))
            .normalized();
    const Eigen::Vector3d point = center + 0.999 * radius * direction;
    const auto pixel = view.camera.ImgFromCam(view.cam_from_world * point);
    const bool in_picture = pixel && view.camera.InImage(*pixel);
    num_shown += in_picture;
    num_culled += !renderer.MayShow(center, radius);
    if (in_picture) {
      ASSERT_TRUE(renderer.MayShow(center, radius));
    }
  }
  EXPECT_GT(num_shown, 500);
  EXPECT_GT(num_culled, 25000);
}

}  // namespace
}  // namespace colmap_seapoint
