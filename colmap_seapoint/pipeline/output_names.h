// The files that each command writes into its output folder: what it claims before it writes.
#pragma once

#include <string>
#include <vector>

namespace colmap_seapoint {

// partial_densifier.
std::vector<std::string> CloudNames();
// The same with write_maps: what comes on top for these pictures.
std::vector<std::string> DenseMapNames(const std::vector<std::string>& pictures);
// model_scaler, without the cloud, which keeps its own name.
std::vector<std::string> ScaledModelNames();
// cloud_comparer, into --difference_path.
std::vector<std::string> DifferenceNames();

}  // namespace colmap_seapoint
