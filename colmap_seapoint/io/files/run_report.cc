#include "colmap_seapoint/io/files/run_report.h"

#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/content_hash.h"

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

RunReport FromJson(const Json& json) {
  RunReport report;
  report.version = json.at("version").get<std::string>();
  report.fingerprint = json.value("fingerprint", "");
  report.command = json.at("command").get<std::string>();
  for (const auto& option : json.at("options").items()) {
    report.options.emplace_back(option.key(), option.value().get<std::string>());
  }
  report.seed = json.at("seed").get<int>();
  report.num_threads = json.at("num_threads").get<int>();
  report.images_in = json.at("images_in").get<int64_t>();
  report.images_used = json.at("images_used").get<int64_t>();
  for (const Json& item : json.at("left_out")) {
    report.left_out.push_back({item.at("name"), item.at("reason")});
  }
  report.pairs = json.at("pairs").get<int64_t>();
  report.points = json.at("points").get<int64_t>();
  report.units = json.value("units", "");
  for (const Json& item : json.at("stages")) {
    report.stages.push_back({item.at("name"), item.at("wall_seconds"), item.at("cpu_seconds")});
  }
  for (const Json& item : json.at("inputs")) {
    report.inputs.push_back({item.at("name"), item.at("size"), item.at("hash")});
  }
  return report;
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

void WriteRunReport(const std::filesystem::path& path, const RunReport& report) {
  Json json;
  json["version"] = report.version;
  json["command"] = report.command;
  if (!report.fingerprint.empty()) json["fingerprint"] = report.fingerprint;
  json["options"] = Json::object();
  for (const auto& [name, value] : report.options) json["options"][name] = value;
  json["seed"] = report.seed;
  json["num_threads"] = report.num_threads;
  json["images_in"] = report.images_in;
  json["images_used"] = report.images_used;
  json["left_out"] = Json::array();
  for (const auto& [name, reason] : report.left_out) {
    json["left_out"].push_back({{"name", name}, {"reason", reason}});
  }
  json["pairs"] = report.pairs;
  json["points"] = report.points;
  if (!report.units.empty()) json["units"] = report.units;
  json["stages"] = Json::array();
  for (const auto& [name, wall_seconds, cpu_seconds] : report.stages) {
    json["stages"].push_back(
        {{"name", name}, {"wall_seconds", wall_seconds}, {"cpu_seconds", cpu_seconds}});
  }
  json["peak_rss_bytes"] = PeakRssBytes();
  json["inputs"] = Json::array();
  for (const auto& [name, size, hash] : report.inputs) {
    json["inputs"].push_back({{"name", name}, {"size", size}, {"hash", hash}});
  }
  WriteTextFile(path, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

std::optional<RunReport> ReadRunReport(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) return std::nullopt;
  try {
    return FromJson(Json::parse(file));
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

}  // namespace colmap_seapoint
