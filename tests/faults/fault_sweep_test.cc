// A part of the sweep, another one for each version; scripts/sweep_faults.sh makes the whole.
#include "tests/faults/fault_sweep.h"

#include <gtest/gtest.h>

#include <numeric>

#include "colmap_seapoint/base/version.h"
#include "tests/faults/fault_injector.h"

namespace colmap_seapoint {
namespace {

// Of the version's letters: the same with every compiler.
unsigned SeedOfVersion() {
  const std::string version = Version();
  return std::accumulate(version.begin(), version.end(), 0u,
                         [](unsigned sum, char letter) { return 31 * sum + letter; });
}

class FaultSweep : public testing::TestWithParam<std::string> {};

TEST_P(FaultSweep, APartOfTheCalls) {
  if (!CanInjectFaults()) GTEST_SKIP() << "this system answers no calls for others";
  const int stride = GetParam() == "automatic_reconstructor" ? 800 : 100;
  const FaultSweepFigures figures = SweepFaults(GetParam(), stride, SeedOfVersion(), nullptr);
  EXPECT_GT(figures.num_faults, 10);
  EXPECT_GT(figures.num_kills, 0);
  EXPECT_GT(figures.num_failed, 0);
  for (const std::string& complaint : figures.complaints) ADD_FAILURE() << complaint;
}

INSTANTIATE_TEST_SUITE_P(Commands, FaultSweep, testing::ValuesIn(SweptCommands()),
                         [](const auto& name) { return name.param; });

}  // namespace
}  // namespace colmap_seapoint
