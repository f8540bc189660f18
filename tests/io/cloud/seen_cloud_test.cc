#include "colmap_seapoint/io/cloud/seen_cloud.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "tests/expect_error.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

class SeenCloud : public testing::Test {
 protected:
  void Write(const std::string& name, const std::vector<std::vector<uint32_t>>& seen_by) const {
    CloudWriter writer(dir_ / name);
    float x = 0;
    for (const std::vector<uint32_t>& pictures : seen_by) {
      CloudPoint point;
      point.xyz = {x += 1.1f, 2, 3};
      point.normal = {0, 0, -1};
      point.rgb = {1, 2, 3};
      point.confidence = 0.25f;
      writer.Add(point, pictures.data(), static_cast<uint32_t>(pictures.size()));
    }
    writer.Finish();
  }

  std::vector<std::array<uint32_t, 2>> Read(const std::string& name) const {
    std::vector<std::array<uint32_t, 2>> pairs;
    ReadSeenCloud(dir_ / name, [&](const CloudPoint& point, uint32_t a, uint32_t b) {
      pairs.push_back({a, b});
      EXPECT_EQ(point.xyz.y(), 2);
      EXPECT_EQ(point.normal.z(), -1);
      EXPECT_EQ(point.rgb[2], 3);
      EXPECT_EQ(point.confidence, 0.25f);
    });
    return pairs;
  }

  const TempDir dir_;
};

TEST_F(SeenCloud, GivesEachPointWithItsTwoPictures) {
  Write("a.ply", {{0, 1}, {0, 1}, {7, 3}});
  EXPECT_EQ(Read("a.ply"), (std::vector<std::array<uint32_t, 2>>{{0, 1}, {0, 1}, {7, 3}}));
  Write("none.ply", {});
  EXPECT_TRUE(Read("none.ply").empty());
}

TEST_F(SeenCloud, RefusesWhatBelongsToAnotherCloudOrTellsOfNoPair) {
  Write("a.ply", {{0, 1}, {1, 2}});
  Write("b.ply", {{0, 1}});
  std::filesystem::copy_file(dir_ / "b.ply.vis", dir_ / "a.ply.vis",
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_ERROR(Read("a.ply"), "belongs to another cloud");
  Write("one.ply", {{4}});
  EXPECT_ERROR(Read("one.ply"), "two pictures of every point");
}

}  // namespace
}  // namespace colmap_seapoint
