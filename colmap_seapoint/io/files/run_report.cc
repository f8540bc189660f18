#include "colmap_seapoint/io/files/run_report.h"

#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/io/files/run_report_json.h"

namespace colmap_seapoint {
namespace {

using Json = nlohmann::ordered_json;

double ChildrenCpuSeconds() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

// VmHWM rather than ru_maxrss, which a program inherits from the one that started it.
uint64_t OwnPeakRssBytes() {
  std::ifstream status("/proc/self/status");
  std::string key;
  while (status >> key) {
    uint64_t kilobytes = 0;
    if (key == "VmHWM:" && status >> kilobytes) return 1024 * kilobytes;
    std::getline(status, key);
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024 * static_cast<uint64_t>(usage.ru_maxrss);
}

}  // namespace

std::string OptionsFingerprint(const OptionList& options) {
  std::string text;
  for (const auto& [name, value] : options) text += name + "=" + value + "\n";
  return HashText(text);
}

void LeaveOut(const std::string& name, const std::string& reason, RunReport* report) {
  LogWarning(name + " is left out: " + reason);
  report->left_out.push_back({name, reason});
}

void AddPart(const RunReport& part, RunReport* report) {
  report->stages.insert(report->stages.end(), part.stages.begin(), part.stages.end());
  if (!part.cameras.empty()) report->cameras = part.cameras;
  std::set<std::string> named;
  for (const auto& left_out : report->left_out) named.insert(left_out.name);
  for (const auto& left_out : part.left_out) {
    if (named.insert(left_out.name).second) report->left_out.push_back(left_out);
  }
}

CommandResult ResultOf(const RunReport& report) { return {report.left_out.empty(), ""}; }

StageTimer::StageTimer(RunReport* report, const std::string& name)
    : report_(report), name_(name), children_cpu_start_(ChildrenCpuSeconds()) {}

StageTimer::~StageTimer() {
  const double children_cpu = ChildrenCpuSeconds() - children_cpu_start_;
  report_->stages.push_back({name_, timer_.WallSeconds(), timer_.CpuSeconds() + children_cpu});
}

uint64_t PeakRssBytes() {
  rusage children{};
  getrusage(RUSAGE_CHILDREN, &children);
  return std::max(OwnPeakRssBytes(), 1024 * static_cast<uint64_t>(children.ru_maxrss));
}

RunReport::Input DescribeInput(const std::string& name, const std::filesystem::path& path) {
  RunReport::Input input;
  input.name = name;
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  if (error) return input;
  input.size = size;
  try {
    input.hash = HashFile(path);
  } catch (const Error&) {
    // The stage that needs the file says what is wrong with it.
  }
  return input;
}

void to_json(Json& json, const RunReport::Stage& stage) {
  json = {{"name", stage.name},
          {"wall_seconds", stage.wall_seconds},
          {"cpu_seconds", stage.cpu_seconds}};
}

void from_json(const Json& json, RunReport::Stage& stage) {
  stage = {json.at("name"), json.at("wall_seconds"), json.at("cpu_seconds")};
}

void to_json(Json& json, const RunReport::LeftOut& left_out) {
  json = {{"name", left_out.name}, {"reason", left_out.reason}};
}

void from_json(const Json& json, RunReport::LeftOut& left_out) {
  left_out = {json.at("name"), json.at("reason")};
}

void to_json(Json& json, const RunReport::Input& input) {
  json = {{"name", input.name}, {"size", input.size}, {"hash", input.hash}};
}

void from_json(const Json& json, RunReport::Input& input) {
  input = {json.at("name"), json.at("size"), json.at("hash")};
}

void to_json(Json& json, const RunReport& report) {
  json = Json::object();
  json["version"] = report.version;
  json["command"] = report.command;
  json["options"] = Json::object();
  for (const auto& [name, value] : report.options) json["options"][name] = value;
  json["seed"] = report.seed;
  json["num_threads"] = report.num_threads;
  json["images_in"] = report.images_in;
  json["images_used"] = report.images_used;
  json["left_out"] = report.left_out;
  if (!report.cameras.empty()) json["cameras"] = report.cameras;
  json["pairs"] = report.pairs;
  json["points"] = report.points;
  if (!report.units.empty()) json["units"] = report.units;
  json["stages"] = report.stages;
  json["inputs"] = report.inputs;
}

void from_json(const Json& json, RunReport& report) {
  report.version = json.at("version");
  report.command = json.at("command");
  for (const auto& option : json.at("options").items()) {
    report.options.emplace_back(option.key(), option.value().get<std::string>());
  }
  report.seed = json.at("seed");
  report.num_threads = json.at("num_threads");
  report.images_in = json.at("images_in");
  report.images_used = json.at("images_used");
  report.left_out = json.at("left_out").get<std::vector<RunReport::LeftOut>>();
  report.cameras = json.value("cameras", std::vector<std::string>());
  report.pairs = json.at("pairs");
  report.points = json.at("points");
  report.units = json.value("units", "");
  report.stages = json.at("stages").get<std::vector<RunReport::Stage>>();
  report.inputs = json.at("inputs").get<std::vector<RunReport::Input>>();
}

void WriteRunReport(const std::filesystem::path& path, const RunReport& report) {
  Json json = report;
  json.erase("inputs");  // a line a picture: they come last
  json["peak_rss_bytes"] = PeakRssBytes();
  json["inputs"] = report.inputs;
  WriteTextFile(path, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace colmap_seapoint
