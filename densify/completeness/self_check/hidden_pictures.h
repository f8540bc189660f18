// A survey without some of its pictures: as if they had never been posed.
#pragma once

#include <vector>

#include "densify/completeness/assess_completeness.h"

namespace colmap_seapoint {

// Which pictures (image_idx) are hidden the `fold`-th time of kNumFolds: every fourth in the order
// of their names, so that the survey's outline stays. Over all folds each picture is hidden once.
inline constexpr int kNumFolds = 4;
std::vector<bool> HiddenInFold(const SparseModel& model, int fold);

// What is left of the model: pictures that are not hidden, and points that two of them still hold.
SparseModel WithoutHidden(const SparseModel& model, const std::vector<bool>& is_hidden);

// What is left of the rest: points that no hidden picture has a part in; hidden pictures are lost.
// Refers to `full`, `rest` and `is_hidden`.
CompletenessInput InputWithoutHidden(const CompletenessInput& full, const SparseModel& rest,
                                     const std::vector<bool>& is_hidden);

}  // namespace colmap_seapoint
