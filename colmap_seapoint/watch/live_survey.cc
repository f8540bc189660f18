#include "colmap_seapoint/watch/live_survey.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <iterator>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/hold/quiet_thread.h"
#include "colmap_seapoint/base/median.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/pipeline/reconstruct.h"
#include "colmap_seapoint/system/failure_line.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kNamedPictures = 3;

// What is made while pictures come: the last run, of all of them, makes the rest.
AutomaticReconstructorOptions LiveOptions(AutomaticReconstructorOptions options) { return options; }

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

LiveSurvey::LiveSurvey(const AutomaticReconstructorOptions& options)
    : options_(LiveOptions(options)) {}

void LiveSurvey::Add(const NewPicture& picture) {
  pictures_.insert(picture.arrival.name);
  since_[picture.arrival.name] = picture.arrival.seconds;
  new_.push_back(picture);
}

bool LiveSurvey::HasNews() const { return !new_.empty() && pictures_.size() >= kMinLivePictures; }

void LiveSurvey::RunRound(const std::function<double()>& now) {
  ++num_rounds_;
  const std::string round = "Round " + std::to_string(num_rounds_) + ": ";
  std::set<std::string> left_out;
  try {
    const QuietThread quiet(GetLogLevel() < LogLevel::kDebug);
    for (const auto& entry : ReconstructLive(options_, pictures_).left_out) {
      left_out.insert(entry.name);
    }
  } catch (const UsageError&) {
    throw;  // which no further picture mends
  } catch (const std::exception& error) {
    LogWarning(round + NamesOf(new_) + ": " + FailureLine(error));
    new_.clear();
    return;
  }
  TellOfRound(left_out, now());
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
