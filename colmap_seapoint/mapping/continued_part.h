// The part of a model that pictures which came in since touch: COLMAP's mapper is given that alone,
// so that what they cost does not grow with the survey (ours).
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

using ImageIds = std::set<uint32_t>;

ImageIds IdsOf(const SparseModel& model);

// These pictures of a model, and the points that two of them see.
SparseModel PartOf(const SparseModel& whole, const ImageIds& images);

// The pictures that the database ties to others and that are not in the model, and these others of
// the model.
struct PicturesToAdd {
  std::vector<std::string> names;  // of all; none where nothing ties any to the model
  SparseModel part;                // the model's: what the mapper continues
};
// A picture of the part has all SeaPoints that the database holds of it, also those that came
// behind the ones that the model was made of. Throws Error when database or model cannot be read.
PicturesToAdd FindPicturesToAdd(const std::filesystem::path& database_path,
                                const std::filesystem::path& model_path);

// What the mapper made of a part, in the whole that it is of: the pictures that are new, and what
// they see. A point of theirs that a feature of the whole has already is that one's, others follow
// under new ids. Pictures of the part get the SeaPoints that they have there. Nothing else of the
// whole changes.
void PutPartBack(const SparseModel& part, const SparseModel& grown, SparseModel* whole);

}  // namespace colmap_seapoint
