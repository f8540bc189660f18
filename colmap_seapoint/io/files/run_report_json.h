// A run report as JSON, for who stores more than one beside other things.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "colmap_seapoint/io/files/run_report.h"

namespace colmap_seapoint {

// As WriteRunReport writes it, but for peak_rss_bytes; and back, where a json exception tells of
// anything else. The names are those that nlohmann's library looks for.
void to_json(nlohmann::ordered_json& json, const RunReport& report);
void from_json(const nlohmann::ordered_json& json, RunReport& report);
void to_json(nlohmann::ordered_json& json, const RunReport::Stage& stage);
void from_json(const nlohmann::ordered_json& json, RunReport::Stage& stage);
void to_json(nlohmann::ordered_json& json, const RunReport::LeftOut& left_out);
void from_json(const nlohmann::ordered_json& json, RunReport::LeftOut& left_out);
void to_json(nlohmann::ordered_json& json, const RunReport::Input& input);
void from_json(const nlohmann::ordered_json& json, RunReport::Input& input);

}  // namespace colmap_seapoint
