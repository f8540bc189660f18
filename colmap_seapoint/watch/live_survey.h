// What is known of a survey while it is being made: an answer from small copies of its pictures, in
// a workspace of its own, to which each round adds what has come; and how long each picture was on
// its way into the map.
#pragma once

#include <filesystem>
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

// Below the workspace of the whole job.
struct LiveFolders {
  explicit LiveFolders(const std::string& workspace_path);
  std::filesystem::path root;      // <workspace>/watch: the answer's own workspace
  std::filesystem::path incoming;  // where copies are put that no round has begun with
  std::filesystem::path images;    // those of the answer
};

class LiveSurvey {
 public:
  // `options` of the whole job. What names pictures, or counts in their pixels (a lens, masks,
  // tables of measurements), is left to that.
  explicit LiveSurvey(const AutomaticReconstructorOptions& options);

  // Its copy lies in LiveFolders::incoming. Throws Error when it cannot be moved.
  void Add(const NewPicture& picture);
  // Whether something has come since the last round, and there is enough for one.
  bool HasNews() const;
  // Takes in all that has come, and says in one line what is in the map and how long that took, or
  // why the round failed. `now`: the clock of the arrivals. Throws UsageError, which no further
  // picture mends.
  void RunRound(const std::function<double()>& now);
  // One line: how many pictures, and their times from the folder into the map.
  std::string Summary() const;

 private:
  void TellOfRound(const std::set<std::string>& left_out, double now);

  const LiveFolders folders_;
  const AutomaticReconstructorOptions options_;
  std::set<std::string> pictures_;       // names of all copies
  std::map<std::string, double> since_;  // those that are not in the map: when they came
  std::vector<NewPicture> new_;          // since the last round
  std::vector<double> seconds_;          // from the folder into the map
  int num_rounds_ = 0;
};

}  // namespace colmap_seapoint
