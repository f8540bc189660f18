#include "colmap_seapoint/pairing/feature_store.h"

#include <thread>

#include "tests/io/database_calls.h"
#include "tests/io/test_database.h"

namespace colmap_seapoint {
namespace {

class FeatureStoreTest : public testing::Test {
 protected:
  FeatureStoreTest() {
    const uint32_t camera = AddCamera(&database_, MakeCamera(CameraModel::kPinhole, 500, 640, 480));
    for (unsigned i = 1; i <= 5; ++i) {
      ids_.push_back(AddImage(&database_, std::to_string(i) + ".jpg", camera));
      WriteFeatures(&database_, ids_.back(), MakeFeatures(10 + static_cast<int>(i), i), "picture");
    }
    empty_ = AddImage(&database_, "empty.jpg", camera);
  }

  TempDir dir_;
  ColmapDatabase database_{dir_ / "features.db", ColmapDatabase::Mode::kCreateIfMissing};
  std::vector<uint32_t> ids_;
  uint32_t empty_ = 0;
};

TEST_F(FeatureStoreTest, ReadsOnceAndKeeps) {
  FeatureStore store(&database_);
  const auto first = store.Read(ids_[1]);
  ASSERT_NE(first, nullptr);
  ExpectSameFeatures(*first, MakeFeatures(12, 2));
  // What others write meanwhile is not seen: the same object comes back.
  WriteFeatures(&database_, ids_[1], MakeFeatures(3, 9), "picture");
  EXPECT_EQ(store.Read(ids_[1]), first);
  EXPECT_EQ(FeatureStore(&database_).Read(ids_[1])->points.size(), 3u);
}

TEST_F(FeatureStoreTest, NoSeaPointsOfOursIsNullptr) {
  FeatureStore store(&database_);
  EXPECT_EQ(store.Read(empty_), nullptr);
  EXPECT_EQ(store.Read(999), nullptr);
}

TEST_F(FeatureStoreTest, FromManyThreads) {
  FeatureStore store(&database_);
  std::vector<std::thread> threads;
  std::vector<int> num_wrong(4, 0);
  for (size_t t = 0; t < num_wrong.size(); ++t) {
    threads.emplace_back([&, t] {
      for (size_t i = 0; i < 100; ++i) {
        const size_t k = (i * (t + 1)) % ids_.size();
        const auto features = store.Read(ids_[k]);
        if (features == nullptr || features->points.size() != 11 + k) ++num_wrong[t];
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(num_wrong, std::vector<int>(4, 0));
}

}  // namespace
}  // namespace colmap_seapoint
