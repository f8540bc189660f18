#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_loops.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "tests/io/test_database.h"
namespace colmap_seapoint {
namespace {

class LoopPairs : public testing::Test {
 protected:
  LoopPairs() : database_(dir_ / "loops.db", ColmapDatabase::Mode::kCreateIfMissing) {
    const Camera camera = MakeCamera(CameraModel::kPinhole, 500, 640, 480);
    const uint32_t camera_id = AddCamera(&database_, camera);
    for (unsigned i = 1; i <= 4; ++i) {
      const uint32_t id = AddImage(&database_, std::to_string(i) + ".jpg", camera_id);
      WriteFeatures(&database_, id, MakeFeatures(9, i), "picture");
    }
  }

  void WriteRow(uint32_t id1, uint32_t id2) {
    WriteMatches(&database_, id1, id2, {{1, 2}, {3, 4}}, MakeGeometry({{1, 2}}));
  }

  TempDir dir_;
  ColmapDatabase database_;
};

using Pairs = std::vector<ImagePair>;

TEST_F(LoopPairs, AreReadBackForTheSameFingerprintOnly) {
  EXPECT_FALSE(ReadLoopPairs(database_, "a"));
  EXPECT_TRUE(ReadLoopPairs(database_).empty());
  WriteLoopPairs(&database_, "a", {{2, 4}, {1, 3}});
  EXPECT_EQ(ReadLoopPairs(database_, "a"), Pairs({{2, 4}, {1, 3}}));
  EXPECT_EQ(ReadLoopPairs(database_), Pairs({{2, 4}, {1, 3}}));
  EXPECT_FALSE(ReadLoopPairs(database_, "b"));
  WriteLoopPairs(&database_, "b", {});
  EXPECT_FALSE(ReadLoopPairs(database_, "a"));
  EXPECT_EQ(ReadLoopPairs(database_, "b"), Pairs());
  ExpectSound(dir_ / "loops.db");
}

TEST_F(LoopPairs, LeavingTheListTakesTheirRowsAlong) {
  WriteLoopPairs(&database_, "a", {{1, 3}, {1, 4}, {2, 4}});
  WriteRow(1, 2);  // by other matching
  WriteRow(1, 3);
  WriteRow(2, 4);
  WriteLoopPairs(&database_, "b", {{2, 4}, {1, 2}});
  EXPECT_TRUE(HasMatches(database_, {1, 2}));
  EXPECT_FALSE(HasMatches(database_, {1, 3}));
  EXPECT_TRUE(ReadMatches(database_, {1, 3}).empty());
  EXPECT_EQ(ReadMatches(database_, {2, 4}).size(), 2u);
  EXPECT_EQ(ReadVerifiedPairs(database_), Pairs({{1, 2}, {2, 4}}));
}

TEST_F(LoopPairs, DamageIsAnError) {
  WriteLoopPairs(&database_, "a", {{1, 3}, {2, 4}});
  Execute(dir_ / "loops.db", "UPDATE seapoint_loop_pairs SET data = x'01020304'");
  EXPECT_ERROR(ReadLoopPairs(database_, "a"), "loop pairs is damaged");
  Execute(dir_ / "loops.db", "UPDATE seapoint_loop_pairs SET data = zeroblob(16)");
  EXPECT_ERROR(ReadLoopPairs(database_, "a"), "loop pairs is damaged");
}

}  // namespace
}  // namespace colmap_seapoint
