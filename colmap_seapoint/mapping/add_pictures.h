// Pictures that came in later are adjusted to a model that stays as it is (ours): what was made of
// it stays true, and the cost is that of the pictures that are new.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/mapping/adjust_lens.h"

namespace colmap_seapoint {

struct AddedPictures {
  std::optional<SparseModel> model;  // as `folder` holds it afterwards; nullopt: of no use
  std::string outcome;               // one line for the user
};

// `before` holds a model of ours, `part` what the mapper was given of it (continued_part.h), and
// `folder` what that made of the part, with more pictures. These are measured again
// (measure_again.h) together with those that see the same points, and their poses and these points
// are adjusted; poses and lenses of `before` stay as they are. Of no use is a part that has lost
// one of its pictures, or has lenses that were not there. Writes the whole model into `folder`.
// Throws Error when a model cannot be read or written. The same model for any number of threads.
AddedPictures AdjustAddedPictures(const AdjustmentJob& job, const std::filesystem::path& before,
                                  const SparseModel& part, const std::filesystem::path& folder);

}  // namespace colmap_seapoint
