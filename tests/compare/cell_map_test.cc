#include "colmap_seapoint/compare/cell_map.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace colmap_seapoint {
namespace {

TEST(CellMap, CountsAsAMapDoes) {
  std::mt19937 random(1);
  CellMap<int> cells;
  std::map<CellKey, int> oracle;
  std::vector<CellKey> first_seen;
  for (int i = 0; i < 100000; ++i) {
    const CellKey key = {static_cast<int64_t>(random() % 40) - 20,
                         (static_cast<int64_t>(random() % 40) - 20) << 40,
                         static_cast<int64_t>(random() % 9)};
    ++cells[key];
    if (++oracle[key] == 1) first_seen.push_back(key);
  }
  ASSERT_EQ(cells.Items().size(), oracle.size());
  for (size_t i = 0; i < first_seen.size(); ++i) {
    EXPECT_EQ(cells.Items()[i].first, first_seen[i]);
    EXPECT_EQ(cells.Items()[i].second, oracle[first_seen[i]]);
  }
}

}  // namespace
}  // namespace colmap_seapoint
