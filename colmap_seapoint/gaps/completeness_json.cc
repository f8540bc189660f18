#include "colmap_seapoint/gaps/completeness_json.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <nlohmann/json.hpp>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/version.h"
#include "colmap_seapoint/gaps/gap_files.h"
#include "colmap_seapoint/io/files/input_stream.h"

namespace colmap_seapoint {
namespace {

using Json = nlohmann::ordered_json;

Json Vector(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Json GapJson(const Gap& gap, const SparseModel& model) {
  Json pictures = Json::array(), outline = Json::array();
  for (const int i : gap.pictures) pictures.push_back(model.images[static_cast<size_t>(i)].name);
  for (const auto& corners : gap.outline) {
    Json& ring = outline.emplace_back(Json::array());
    for (const Eigen::Vector3d& corner : corners) ring.push_back(Vector(corner));
  }
  return {{"id", gap.id},
          {"area", gap.region.area},
          {"cause", GapCauseName(gap.region.cause)},
          {"centroid", Vector(gap.centroid)},
          {"layer", LayerName(gap.region.layer)},
          {"pictures", std::move(pictures)},
          {"outline", std::move(outline)}};
}

// Of the pictures' own cells: what was covered, what not, and the commonest causes.
Json PictureJson(const PictureRecord& record, const std::string& name) {
  std::array<int64_t, kNumGapCauses> counts = {};
  for (const GapCause cause : record.causes) ++counts[static_cast<size_t>(cause)];
  Json causes = Json::object();
  for (size_t c = 1; c < counts.size(); ++c) {
    if (counts[c] == 0) continue;
    causes[GapCauseName(static_cast<GapCause>(c))] =
        static_cast<double>(counts[c]) / static_cast<double>(record.causes.size());
  }
  return {{"name", name},
          {"is_bad", record.is_bad},
          {"sharpness", record.sharpness},
          {"covered", record.Share(CellState::kCovered)},
          {"not_covered", record.Share(CellState::kNotCovered)},
          {"unknown", record.Share(CellState::kUnknown)},
          {"causes", std::move(causes)}};
}

Json LostRunJson(const LostRun& run, const SparseModel& model) {
  const auto name = [&](int i) {
    return i < 0 ? Json(nullptr) : Json(model.images[static_cast<size_t>(i)].name);
  };
  return {{"pictures", run.names}, {"between", {name(run.before), name(run.after)}}};
}

Json CoverageJson(const CompletenessResult& result) {
  Json coverage = Json::array();
  for (const CoverageAt& at : result.coverage) {
    coverage.push_back({{"spacing", at.spacing}, {"area", at.area}, {"share", at.share}});
  }
  return coverage;
}

// null where nothing was checked.
Json SelfCheckJson(const SelfCheck& check) {
  if (check.num_folds == 0) return nullptr;
  return {{"folds", check.num_folds},           {"hidden_area", check.hidden_area},
          {"beyond_share", check.beyond_share}, {"found_share", check.found_share},
          {"false_share", check.false_share},   {"area_error", check.area_error}};
}

Json MissingJson(const CompletenessResult& result) {
  Json missing = Json::object();
  for (size_t c = 1; c < result.missing_area.size(); ++c) {
    if (result.missing_area[c] > 0) {
      missing[GapCauseName(static_cast<GapCause>(c))] = result.missing_area[c];
    }
  }
  return missing;
}

FormerOutline ReadGap(const Json& json) {
  FormerOutline gap;
  gap.id = json.at("id").get<int>();
  ParseLayerName(json.at("layer").get<std::string>(), &gap.layer);
  for (const Json& ring : json.at("outline")) {
    auto& corners = gap.rings.emplace_back();
    for (const Json& p : ring) {
      corners.emplace_back(p.at(0).get<double>(), p.at(1).get<double>(), p.at(2).get<double>());
    }
  }
  return gap;
}

}  // namespace

std::string CompletenessJson(const CompletenessResult& result, const SparseModel& model,
                             const GapPlaces& places) {
  Json json = {{"version", Version()},
               {"spacing", result.spacing},
               {"unit", places.Unit()},
               {"covered_share", result.coverage[0].share},
               {"covered_share_tolerance", result.share_tolerance},
               {"self_check", SelfCheckJson(result.self_check)},
               {"covered_area", result.coverage[0].area},
               {"expected_area", result.expected_area},
               {"gsd", result.gsd},
               {"coverage", CoverageJson(result)},
               {"missing_area", MissingJson(result)},
               {"unlisted_area", result.unlisted_area},
               {"points_per_area", result.points_per_area},
               {"mean_views", result.mean_views},
               {"median_parallax_deg", result.median_parallax_deg},
               {"route_length", result.route_length}};
  int last_id = 0;
  Json gaps = Json::array();
  for (const Gap& gap : result.gaps) {
    gaps.push_back(GapJson(gap, model));
    last_id = std::max(last_id, gap.id);
  }
  json["gaps"] = std::move(gaps);
  json["last_gap_id"] = std::max(last_id, result.last_id);
  Json lost = Json::array();
  for (const LostRun& run : result.lost_runs) lost.push_back(LostRunJson(run, model));
  json["pictures_without_pose"] = std::move(lost);
  Json pictures = Json::array();
  for (size_t i = 0; i < result.records.size(); ++i) {
    pictures.push_back(PictureJson(result.records[i], model.images[i].name));
  }
  json["pictures"] = std::move(pictures);
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

FormerReport ReadFormerReport(const std::filesystem::path& path) {
  FormerReport report;
  const auto in = OpenIfThere(path);
  if (in == nullptr) return report;
  const std::string text{std::istreambuf_iterator<char>(*in), {}};
  try {
    const Json json = Json::parse(text);
    report.last_id = json.at("last_gap_id").get<int>();
    for (const Json& gap : json.at("gaps")) report.gaps.push_back(ReadGap(gap));
  } catch (const Json::exception& e) {
    throw Error(path.string(), "is no report of ours (" + std::string(e.what()) + ")",
                "move it away, or choose another --output_path");
  }
  return report;
}

}  // namespace colmap_seapoint
