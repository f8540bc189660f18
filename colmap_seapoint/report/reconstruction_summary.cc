#include "colmap_seapoint/report/reconstruction_summary.h"

#include <sstream>

#include "colmap_seapoint/base/progress.h"

namespace colmap_seapoint {

std::string SummaryText(const std::vector<ModelSummary>& models, const RunReport& report) {
  std::ostringstream out;
  out << report.images_used << " of " << report.images_in << " pictures used, " << models.size()
      << (models.size() == 1 ? " model, " : " models, ") << report.points << " points\n";
  for (const std::string& camera : report.cameras) out << camera << "\n";
  for (const ModelSummary& model : models) {
    out << "model " << model.name << ": " << model.pictures.size() << " pictures, "
        << model.densification.pairs << " pairs, " << model.densification.points << " points";
    if (model.densification.points > 0) out << " in " << model.cloud_path.string();
    out << "\n  " << model.units;
    if (!model.scaling.empty()) out << " (" << model.scaling << ")";
    out << "\n";
    if (!model.map.empty()) {
      out << "  map in " << model.map_path.string() << ": " << model.map << "\n";
    }
    if (!model.completeness.empty()) out << "  completeness: " << model.completeness << "\n";
  }
  for (const RunReport::LeftOut& left_out : report.left_out) {
    out << "left out: " << left_out.name << ": " << left_out.reason << "\n";
  }
  for (const RunReport::Stage& stage : report.stages) {
    out << stage.name << ": " << DurationText(stage.wall_seconds) << "\n";
  }
  return out.str();
}

}  // namespace colmap_seapoint
