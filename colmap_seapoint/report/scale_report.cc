#include "colmap_seapoint/report/scale_report.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/csv_table.h"
#include "colmap_seapoint/report/format_text.h"

namespace colmap_seapoint {
namespace {

using Json = nlohmann::ordered_json;

constexpr size_t kMaxRows = 20;
constexpr size_t kMaxNamedOutliers = 3;

size_t Count(const std::vector<bool>& used) {
  return static_cast<size_t>(std::count(used.begin(), used.end(), true));
}

std::string Used(bool used) { return used ? "" : "  outlier, not used"; }

void AddPositionRows(const ScaleMeasurements& measurements, const SimilarityEstimate& estimate,
                     std::string* text) {
  const auto& residuals = estimate.position_residuals;
  std::vector<size_t> order(residuals.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  if (order.size() > kMaxRows) {
    std::stable_sort(order.begin(), order.end(),
                     [&](size_t a, size_t b) { return residuals[a].norm() > residuals[b].norm(); });
    order.resize(kMaxRows);
    *text += Format("  (the %zu largest residuals)\n", kMaxRows);
  }
  for (const size_t i : order) {
    const Eigen::Vector3d& r = residuals[i];
    *text += "  " + measurements.position_names[i] +
             Format("  %+.3f %+.3f %+.3f m (%.3f)", r.x(), r.y(), r.z(), r.norm()) +
             Used(estimate.position_used[i]) + "\n";
  }
}

void AddLengthRows(const ScaleMeasurements& measurements, const SimilarityEstimate& estimate,
                   std::string* text) {
  for (size_t i = 0; i < estimate.length_residuals.size(); ++i) {
    const LengthMeasurement& length = measurements.problem.lengths[i];
    *text +=
        "  " + measurements.length_names[i] +
        Format("  %.4f m, residual %+.4f m (%+.2f %%)", length.metres, estimate.length_residuals[i],
               100 * estimate.length_residuals[i] / length.metres) +
        Used(estimate.length_used[i]) + "\n";
  }
}

// " (not b.jpg: 52 m off)", the farthest three; "" without outliers.
std::string OutlierText(const ScaleMeasurements& measurements, const SimilarityEstimate& estimate) {
  std::vector<size_t> outliers;
  for (size_t i = 0; i < estimate.position_used.size(); ++i) {
    if (!estimate.position_used[i]) outliers.push_back(i);
  }
  const auto distance = [&](size_t i) { return estimate.position_residuals[i].norm(); };
  std::stable_sort(outliers.begin(), outliers.end(),
                   [&](size_t a, size_t b) { return distance(a) > distance(b); });
  std::string text;
  for (size_t k = 0; k < std::min(outliers.size(), kMaxNamedOutliers); ++k) {
    text += (k == 0 ? " (not " : ", ") + measurements.position_names[outliers[k]] +
            Format(": %.3g m off", distance(outliers[k]));
  }
  if (text.empty()) return text;
  return text + (outliers.size() > kMaxNamedOutliers ? ", ...)" : ")");
}

Json VectorJson(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Json SimilarityJson(const Similarity3d& similarity) {
  const Eigen::Quaterniond& q = similarity.rotation;
  return {{"scale", similarity.scale},
          {"rotation_wxyz", {q.w(), q.x(), q.y(), q.z()}},
          {"translation", VectorJson(similarity.translation)},
          {"what", "x_new = scale * rotation * x_old + translation"}};
}

}  // namespace

std::string ScaleLine(const ScaleMeasurements& measurements, const SimilarityEstimate& estimate) {
  std::string text =
      Format("scale %.6g +- %.2g", estimate.metric_from_model.scale, estimate.scale_sigma);
  if (estimate.has_frame) {
    text += Format("; positions %zu of %zu, rms %.3f m", Count(estimate.position_used),
                   estimate.position_used.size(), estimate.position_rms);
    text += OutlierText(measurements, estimate);
    if (estimate.is_levelled) {
      text += "; they lie on a line, the turn about it is from where the cameras look";
    }
  }
  if (estimate.is_former) text += "; as before pictures came in, which agree with it";
  if (!estimate.length_used.empty()) {
    text += Format("; lengths %zu of %zu, rms %.4f m", Count(estimate.length_used),
                   estimate.length_used.size(), estimate.length_rms);
  }
  return text;
}

std::string ScaleText(const ScaleMeasurements& measurements, const SimilarityEstimate& estimate) {
  const double scale = estimate.metric_from_model.scale;
  std::string text = Format("scale: %.9g +- %.2g metres a model unit (%.3f %%)\n", scale,
                            estimate.scale_sigma, 100 * estimate.scale_sigma / scale);
  text += "frame: " + UnitsText(measurements.units) + "\n";
  if (estimate.is_levelled) {
    text +=
        "levelled: the positions do not tell the turn about their line; the mean viewing "
        "direction is in the vertical plane of the line\n";
  }
  if (estimate.has_frame) {
    text += Format("rotation: +- %.2f degrees about its least certain axis\n",
                   estimate.rotation_sigma_deg);
    text += Format("positions: %zu of %zu used, rms %.4f m\n", Count(estimate.position_used),
                   estimate.position_used.size(), estimate.position_rms);
    AddPositionRows(measurements, estimate, &text);
  }
  if (!estimate.length_used.empty()) {
    text += Format("lengths: %zu of %zu used, rms %.4f m\n", Count(estimate.length_used),
                   estimate.length_used.size(), estimate.length_rms);
    AddLengthRows(measurements, estimate, &text);
  }
  for (const TargetSummary& target : measurements.targets) {
    text += "target " + target.name + ": ";
    text += target.problem.empty() ? Format("%zu of %zu marks, rms %.2f pixels", target.num_used,
                                            target.num_marks, target.rms_pixels)
                                   : target.problem;
    text += "\n";
  }
  return text;
}

void WriteScaleJson(const std::filesystem::path& path, const ScaleMeasurements& measurements,
                    const SimilarityEstimate& estimate) {
  Json json;
  json["scale"] = estimate.metric_from_model.scale;
  json["scale_sigma"] = estimate.scale_sigma;
  json["new_from_old"] = SimilarityJson(estimate.metric_from_model);
  json["frame"] = UnitsText(measurements.units);
  json["levelled"] = estimate.is_levelled;
  json["kept_from_before"] = estimate.is_former;
  json["rotation_sigma_deg"] = estimate.rotation_sigma_deg;
  json["position_rms_m"] = estimate.position_rms;
  json["length_rms_m"] = estimate.length_rms;
  json["warnings"] = estimate.warnings;
  json["positions"] = Json::array();
  for (size_t i = 0; i < estimate.position_residuals.size(); ++i) {
    json["positions"].push_back({{"image", measurements.position_names[i]},
                                 {"used", static_cast<bool>(estimate.position_used[i])},
                                 {"residual_m", VectorJson(estimate.position_residuals[i])},
                                 {"sigma_m", VectorJson(estimate.position_sigmas[i])}});
  }
  json["lengths"] = Json::array();
  for (size_t i = 0; i < estimate.length_residuals.size(); ++i) {
    json["lengths"].push_back({{"name", measurements.length_names[i]},
                               {"used", static_cast<bool>(estimate.length_used[i])},
                               {"length_m", measurements.problem.lengths[i].metres},
                               {"model_length", measurements.problem.lengths[i].in_model},
                               {"residual_m", estimate.length_residuals[i]},
                               {"sigma_m", estimate.length_sigmas[i]}});
  }
  json["targets"] = Json::array();
  for (const TargetSummary& target : measurements.targets) {
    json["targets"].push_back({{"name", target.name},
                               {"problem", target.problem},
                               {"marks", target.num_marks},
                               {"used", target.num_used},
                               {"rms_pixels", target.rms_pixels}});
  }
  WriteTextFile(path, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

void WriteScaleCsv(const std::filesystem::path& path, const ScaleMeasurements& measurements,
                   const SimilarityEstimate& estimate) {
  std::string text = std::string(kScaleCsvHeader) + "\n";
  for (size_t i = 0; i < estimate.position_residuals.size(); ++i) {
    const Eigen::Vector3d& r = estimate.position_residuals[i];
    text += "position," + CsvField(measurements.position_names[i]) +
            Format(",%d,%.6f,%.6f,%.6f,%.6f,%.6f,,\n", estimate.position_used[i] ? 1 : 0, r.x(),
                   r.y(), r.z(), r.norm(), estimate.position_sigmas[i].maxCoeff());
  }
  for (size_t i = 0; i < estimate.length_residuals.size(); ++i) {
    const LengthMeasurement& length = measurements.problem.lengths[i];
    text += "length," + CsvField(measurements.length_names[i]) +
            Format(",%d,,,,%.6f,%.6f,%.9g,%.6f\n", estimate.length_used[i] ? 1 : 0,
                   estimate.length_residuals[i], estimate.length_sigmas[i], length.in_model,
                   length.metres);
  }
  WriteTextFile(path, text);
}

}  // namespace colmap_seapoint
