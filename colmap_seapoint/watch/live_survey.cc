#include "colmap_seapoint/watch/live_survey.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <iterator>
#include <nlohmann/json.hpp>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/hold/quiet_thread.h"
#include "colmap_seapoint/base/median.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/files/input_stream.h"
#include "colmap_seapoint/pipeline/reconstruct.h"
#include "colmap_seapoint/system/failure_line.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr size_t kNamedPictures = 3;

// Of a coarse answer (scripts/mission/run_step.py): a sixth of the work, and a covered share within
// some points of the whole job's.
AutomaticReconstructorOptions LiveOptions(AutomaticReconstructorOptions options,
                                          const LiveFolders& folders) {
  options.image_path = folders.images.string();
  options.workspace_path = folders.root.string();
  options.quality = "field";
  options.extraction.min_num_features = 600;
  options.extraction.max_num_features = 800;
  options.extraction.descriptor = SeaPointExtractionOptions().descriptor;
  options.densification.step = 2;
  options.densification.write_maps = false;
  options.reader.camera_params.clear();
  options.reader.mask_path.clear();
  options.scale = ScaleSources();
  return options;
}

// What the last round left out.
std::set<std::string> LeftOut(const fs::path& workspace) {
  std::set<std::string> names;
  const auto file = OpenIfThere(workspace / "report" / "run.json");
  if (file == nullptr) return names;
  const auto report = nlohmann::ordered_json::parse(*file, nullptr, false);
  for (const auto& entry : report.value("left_out", nlohmann::ordered_json::array())) {
    names.insert(entry.value("name", ""));
  }
  return names;
}

// "c.jpg (71 %)" of a picture and its overlap with the last ones.
std::string NameOf(const NewPicture& picture) {
  const NewOverlap& overlap = picture.overlap;
  if (overlap.is_first) return picture.arrival.name;
  return picture.arrival.name + " (" + std::to_string(std::lround(100 * overlap.overlap)) + " %)";
}

std::string NamesOf(const std::vector<NewPicture>& pictures) {
  std::string names;
  for (size_t i = 0; i < std::min(pictures.size(), kNamedPictures); ++i) {
    names += (i > 0 ? ", " : "") + NameOf(pictures[i]);
  }
  if (pictures.size() <= kNamedPictures) return names;
  return names + " and " + std::to_string(pictures.size() - kNamedPictures) + " more";
}

std::string Range(const std::vector<double>& seconds) {
  const auto [least, most] = std::minmax_element(seconds.begin(), seconds.end());
  const std::string last = DurationText(*most);
  return seconds.size() == 1 ? last : DurationText(*least) + " to " + last;
}

}  // namespace

LiveFolders::LiveFolders(const std::string& workspace_path)
    : root(fs::absolute(workspace_path).lexically_normal() / "watch"),
      incoming(root / "incoming"),
      images(root / "images") {}

LiveSurvey::LiveSurvey(const AutomaticReconstructorOptions& options)
    : folders_(options.workspace_path), options_(LiveOptions(options, folders_)) {}

void LiveSurvey::Add(const NewPicture& picture) {
  const fs::path to = folders_.images / picture.copy_name;
  std::error_code error;
  fs::create_directories(to.parent_path(), error);
  if (!error) fs::rename(folders_.incoming / picture.copy_name, to, error);
  if (error) {
    throw Error(to.string(), "cannot be put there (" + error.message() + ")",
                "check the folder's permissions, and the disk");
  }
  pictures_.insert(picture.copy_name);
  since_[picture.copy_name] = picture.arrival.seconds;
  new_.push_back(picture);
}

bool LiveSurvey::HasNews() const { return !new_.empty() && pictures_.size() >= kMinLivePictures; }

void LiveSurvey::RunRound(const std::function<double()>& now) {
  ++num_rounds_;
  try {
    const QuietThread quiet(GetLogLevel() < LogLevel::kDebug);
    RunAutomaticReconstructor(options_);
  } catch (const UsageError&) {
    throw;
  } catch (const std::exception& error) {
    LogWarning("Round " + std::to_string(num_rounds_) + ": " + NamesOf(new_) + ": " +
               FailureLine(error));
    new_.clear();
    return;
  }
  TellOfRound(LeftOut(folders_.root), now());
}

void LiveSurvey::TellOfRound(const std::set<std::string>& left_out, double now) {
  std::vector<double> seconds;
  for (auto picture = since_.begin(); picture != since_.end();) {
    const bool is_in_map = left_out.count(picture->first) == 0;
    if (is_in_map) seconds.push_back(now - picture->second);
    picture = is_in_map ? since_.erase(picture) : std::next(picture);
  }
  LogInfo("Round " + std::to_string(num_rounds_) + ": " + NamesOf(new_) + "; " +
          std::to_string(pictures_.size() - since_.size()) + " of " +
          std::to_string(pictures_.size()) + " pictures in the map" +
          (seconds.empty() ? "" : ", the new ones " + Range(seconds) + " after they came"));
  seconds_.insert(seconds_.end(), seconds.begin(), seconds.end());
  new_.clear();
}

std::string LiveSurvey::Summary() const {
  std::string line = "No more pictures are expected: " + std::to_string(pictures_.size()) +
                     " came, " + std::to_string(num_rounds_) + " rounds";
  if (!seconds_.empty()) {
    line += "; in the map after " + DurationText(Quantile(seconds_, 0.5)) +
            " (median), 95 % within " + DurationText(Quantile(seconds_, 0.95));
  }
  return line + ". Now the whole of it";
}

}  // namespace colmap_seapoint
