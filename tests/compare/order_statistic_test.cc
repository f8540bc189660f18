#include "colmap_seapoint/compare/order_statistic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <random>

namespace colmap_seapoint {
namespace {

TEST(KthSmallest, IsWhatSortingGives) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> exponent(-40, 40);
  TileStore store(std::filesystem::temp_directory_path(), 3, sizeof(double));
  std::vector<double> values = {0,
                                0,
                                0,
                                std::numeric_limits<double>::infinity(),
                                std::numeric_limits<double>::denorm_min(),
                                1.0,
                                std::nextafter(1.0, 2.0)};
  for (int i = 0; i < 5000; ++i) values.push_back(std::exp2(exponent(random)));
  for (size_t i = 0; i < values.size(); ++i) store.Append(static_cast<int>(i % 3), &values[i]);
  store.Finish();
  std::sort(values.begin(), values.end());
  for (const size_t k : {size_t{0}, size_t{2}, size_t{3}, size_t{1000}, values.size() / 2,
                         values.size() - 2, values.size() - 1}) {
    EXPECT_EQ(KthSmallest(store, k), values[k]) << k;
  }
}

}  // namespace
}  // namespace colmap_seapoint
