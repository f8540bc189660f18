// The models of all rounds of the mapper, joined where that can be trusted (ours).
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "colmap_seapoint/mapping/run_mapper.h"

namespace colmap_seapoint {

// Below job.output_path: 0/, 1/ ... Every two models are tried (joining/join_models.h), the largest
// ones first, until no two can be joined. `polish` is called with the folder of a joined model. The
// models that are left are numbered from 0 again. What was tried, and what came of it, is written
// to job.log_folder / "joining.txt" and logged; nothing of a single model. Throws Error when a
// model cannot be read or written.
void JoinModelsOfRounds(const MapperJob& job,
                        const std::function<void(const std::filesystem::path&)>& polish);

}  // namespace colmap_seapoint
