// What is known of a survey while it is being made: rounds that take in what has come, and how long
// each picture was on its way into the map.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "colmap_seapoint/pipeline/reconstruct_options.h"
#include "colmap_seapoint/watch/arrival_queue.h"

namespace colmap_seapoint {

// Fewer make no model that others could be added to.
inline constexpr size_t kMinLivePictures = 3;

class LiveSurvey {
 public:
  explicit LiveSurvey(const AutomaticReconstructorOptions& options);

  void Add(const NewPicture& picture);
  // Whether something has come since the last round, and there is enough for one.
  bool HasNews() const;
  // Takes in all that has come, and says in one line what is in the map and how long that took, or
  // why the round failed. `now`: the clock of the arrivals.
  void RunRound(const std::function<double()>& now);
  // One line: how many pictures, and their times from the folder into the map.
  std::string Summary() const;

 private:
  void TellOfRound(const std::set<std::string>& left_out, double now);

  const AutomaticReconstructorOptions options_;
  std::set<std::string> pictures_;       // all that have come
  std::map<std::string, double> since_;  // those that are not in the map: when they came
  std::vector<NewPicture> new_;          // since the last round
  std::vector<double> seconds_;          // from the folder into the map
  int num_rounds_ = 0;
};

}  // namespace colmap_seapoint
