#include "colmap_seapoint/io/cloud/tile_store.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <numeric>
#include <random>

#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

using Record = std::array<uint32_t, 3>;

TEST(TileStore, GivesEachTileItsRecordsInOrder) {
  const TempDir dir;
  std::mt19937 random(1);
  TileStore store(dir.Path(), 7, sizeof(Record));
  std::vector<std::vector<Record>> oracle(7);
  for (uint32_t i = 0; i < 30000; ++i) {
    const size_t tile = random() % 6;  // the last one stays empty
    oracle[tile].push_back({i, 2 * i, 3 * i});
    store.Append(static_cast<int>(tile), oracle[tile].back().data());
  }
  std::vector<Record> many(5000, Record{1, 2, 3});
  std::iota(many[17].begin(), many[17].end(), 9u);
  oracle[2].insert(oracle[2].end(), many.begin(), many.end());
  store.Append(2, many.data(), many.size());
  store.Finish();
  for (int tile = 0; tile < 7; ++tile) {
    EXPECT_EQ(store.NumRecords(tile), oracle[static_cast<size_t>(tile)].size());
    EXPECT_EQ(store.Read<Record>(tile), oracle[static_cast<size_t>(tile)]);
  }
}

TEST(TileStore, LeavesNoFileAndNamesTheFolder) {
  const TempDir dir;
  TileStore store(dir.Path(), 1, 4);
  store.Append(0, "abcd");
  EXPECT_TRUE(std::filesystem::is_empty(dir.Path()));
  EXPECT_ERROR(TileStore(dir / "missing", 1, 4), "missing: no temporary file");
}

}  // namespace
}  // namespace colmap_seapoint
