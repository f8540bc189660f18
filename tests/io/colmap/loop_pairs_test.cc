#include "tests/io/test_database.h"

namespace colmap_seapoint {
namespace {

class LoopPairs : public testing::Test {
 protected:
  LoopPairs() : database_(dir_ / "loops.db", ColmapDatabase::Mode::kCreateIfMissing) {
    const Camera camera = MakeCamera(CameraModel::kPinhole, 500, 640, 480);
    const uint32_t camera_id = database_.AddCamera(camera);
    for (unsigned i = 1; i <= 4; ++i) {
      const uint32_t id = database_.AddImage(std::to_string(i) + ".jpg", camera_id);
      database_.WriteFeatures(id, MakeFeatures(9, i), "picture");
    }
  }

  void WriteRow(uint32_t id1, uint32_t id2) {
    database_.WriteMatches(id1, id2, {{1, 2}, {3, 4}}, MakeGeometry({{1, 2}}));
  }

  TempDir dir_;
  ColmapDatabase database_;
};

using Pairs = std::vector<ImagePair>;

TEST_F(LoopPairs, AreReadBackForTheSameFingerprintOnly) {
  EXPECT_FALSE(database_.ReadLoopPairs("a"));
  EXPECT_TRUE(database_.ReadLoopPairs().empty());
  database_.WriteLoopPairs("a", {{2, 4}, {1, 3}});
  EXPECT_EQ(database_.ReadLoopPairs("a"), Pairs({{2, 4}, {1, 3}}));
  EXPECT_EQ(database_.ReadLoopPairs(), Pairs({{2, 4}, {1, 3}}));
  EXPECT_FALSE(database_.ReadLoopPairs("b"));
  database_.WriteLoopPairs("b", {});
  EXPECT_FALSE(database_.ReadLoopPairs("a"));
  EXPECT_EQ(database_.ReadLoopPairs("b"), Pairs());
  ExpectSound(dir_ / "loops.db");
}

TEST_F(LoopPairs, LeavingTheListTakesTheirRowsAlong) {
  database_.WriteLoopPairs("a", {{1, 3}, {1, 4}, {2, 4}});
  WriteRow(1, 2);  // by other matching
  WriteRow(1, 3);
  WriteRow(2, 4);
  database_.WriteLoopPairs("b", {{2, 4}, {1, 2}});
  EXPECT_TRUE(database_.HasMatches({1, 2}));
  EXPECT_FALSE(database_.HasMatches({1, 3}));
  EXPECT_TRUE(database_.ReadMatches({1, 3}).empty());
  EXPECT_EQ(database_.ReadMatches({2, 4}).size(), 2u);
  EXPECT_EQ(database_.ReadVerifiedPairs(), Pairs({{1, 2}, {2, 4}}));
}

TEST_F(LoopPairs, DamageIsAnError) {
  database_.WriteLoopPairs("a", {{1, 3}, {2, 4}});
  Execute(dir_ / "loops.db", "UPDATE seapoint_loop_pairs SET data = x'01020304'");
  EXPECT_ERROR(database_.ReadLoopPairs("a"), "loop pairs is damaged");
  Execute(dir_ / "loops.db", "UPDATE seapoint_loop_pairs SET data = zeroblob(16)");
  EXPECT_ERROR(database_.ReadLoopPairs("a"), "loop pairs is damaged");
}

}  // namespace
}  // namespace colmap_seapoint
