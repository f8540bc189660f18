#include "colmap_seapoint/merging/cloud_merger.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/cloud/seen_cloud.h"
#include "tests/expect_error.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

constexpr float kSpacing = 0.1f;

class CloudMerger : public testing::Test {
 protected:
  // A lattice of points from column `begin` to `end`, 20 rows, of pictures `picture` and the next.
  std::string WriteColumns(const std::string& name, int begin, int end, uint32_t picture,
                           float shift = 0) const {
    CloudWriter writer(dir_ / name);
    for (int column = begin; column < end; ++column) {
      for (int row = 0; row < 20; ++row) {
        CloudPoint point;
        point.xyz = {kSpacing * static_cast<float>(column) + shift,
                     kSpacing * static_cast<float>(row) + shift,
                     0.01f * static_cast<float>(picture)};
        point.normal = {0, 0, -1};
        point.rgb = {static_cast<uint8_t>(picture), 0, 0};
        point.confidence = 0.5f;
        const uint32_t pictures[] = {picture, picture + 1};
        writer.Add(point, pictures, 2);
      }
    }
    writer.Finish();
    return (dir_ / name).string();
  }

  void Merge(const std::string& inputs) const {
    CloudMergerOptions options;
    options.input_path = inputs;
    options.output_path = (dir_ / "all.ply").string();
    RunCloudMerger(options);
  }

  std::vector<CloudPoint> All() const { return ReadCloud(dir_ / "all.ply"); }

  const TempDir dir_;
};

TEST_F(CloudMerger, TakesWhatEachCloudAddsToThoseBeforeIt) {
  const std::string a = WriteColumns("a.ply", 0, 30, 1);
  const std::string b = WriteColumns("b.ply", 25, 50, 5, 0.3f * kSpacing);
  Merge(a + "," + b);
  const std::vector<CloudPoint> all = All();
  // The border may stay open by a column or two, and nothing stands there twice.
  EXPECT_LE(all.size(), 50u * 20);
  EXPECT_GE(all.size(), 48u * 20);
  for (size_t i = 0; i < 30u * 20; ++i) EXPECT_EQ(all[i].rgb[0], 1);
  std::vector<size_t> seen(8);
  ReadSeenCloud(dir_ / "all.ply", [&](const CloudPoint& point, uint32_t x, uint32_t y) {
    EXPECT_EQ(point.rgb[0], x);
    EXPECT_EQ(point.confidence, 0.5f);
    EXPECT_EQ(y, x + 1);
    ++seen[x];
  });
  EXPECT_EQ(seen[1], 30u * 20);
  EXPECT_EQ(seen[5], all.size() - 30 * 20);
  // Over it again, as the same command may be given again.
  Merge(b + "," + a);
  EXPECT_EQ(All()[0].rgb[0], 5);
}

TEST_F(CloudMerger, KeepsLayersAndCloudsWithoutPictures) {
  const std::string a = WriteColumns("a.ply", 0, 10, 1);
  const std::string above = WriteColumns("above.ply", 0, 10, 200);  // two units away
  std::filesystem::remove(dir_ / "above.ply.vis");
  Merge(a + "," + above);
  EXPECT_EQ(All().size(), 400u);
}

TEST_F(CloudMerger, RefusesWhatItCannotMerge) {
  const std::string a = WriteColumns("a.ply", 0, 10, 1);
  EXPECT_USAGE_ERROR(Merge(a), "two clouds or more");
  EXPECT_ERROR(Merge(a + "," + (dir_ / "none.ply").string()), "none.ply");
  EXPECT_FALSE(std::filesystem::exists(dir_ / "all.ply"));
  CloudMergerOptions options;
  options.input_path = a + "," + WriteColumns("b.ply", 0, 10, 1);
  options.output_path = a;
  EXPECT_USAGE_ERROR(RunCloudMerger(options), "is one of the clouds that are read");
}

}  // namespace
}  // namespace colmap_seapoint
