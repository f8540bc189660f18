// Runs a check once with every instruction set that this machine and this build have, from the
// plain loops (of any machine) up.
#pragma once

#include <gtest/gtest.h>

#include <functional>

#include "hwy/targets.h"

namespace colmap_seapoint {

inline void ForEachVectorTarget(const std::function<void()>& check) {
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    check();
  }
  hwy::SetSupportedTargetsForTest(0);
}

}  // namespace colmap_seapoint
