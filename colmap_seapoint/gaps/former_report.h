// The report before: its gaps, and where the pictures stood then, so that the gaps can be found
// again in a model that lies elsewhere by now.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/base/rigid3.h"
#include "colmap_seapoint/base/sparse_model.h"
#include "densify/completeness/assess_completeness.h"

namespace colmap_seapoint {

struct FormerPicture {
  std::string name;
  Rigid3d cam_from_world;
};

struct FormerReport {
  std::vector<FormerOutline> gaps;
  std::vector<double> areas;            // by gap, units^2
  std::vector<FormerPicture> pictures;  // none in reports of earlier versions
  int last_id = 0;
};

// Of an earlier run into the same folder; empty when there is none. Throws Error for a file of that
// name that is none of ours.
FormerReport ReadFormerReport(const std::filesystem::path& path);

// The same as a text that ParseFormerReport takes, as it does completeness.json. Throws Error that
// names `origin`.
std::string FormerReportText(const FormerReport& report);
FormerReport ParseFormerReport(const std::string& text, const std::string& origin);

// w, x, y, z of the rotation, then the translation: as both texts have it.
std::vector<double> PoseNumbers(const Rigid3d& pose);

// Moves the gaps by the similarity that takes the pictures from where they stood to where those of
// the same names stand now; not at all where none has moved, or none is known to have stood
// anywhere. A model that is no such image of the former one (fewer than three pictures in common,
// or one in twenty of their extent off) has none of its gaps: they are dropped.
void MoveToModel(const SparseModel& model, FormerReport* report);

}  // namespace colmap_seapoint
