#include "colmap_seapoint/watch/watch_survey.h"

#include <string>
#include <vector>

#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/pipeline/reconstruct.h"
#include "colmap_seapoint/system/finish_request.h"
#include "colmap_seapoint/watch/arrival_queue.h"
#include "colmap_seapoint/watch/live_survey.h"

namespace colmap_seapoint {
namespace {

using Options = AutomaticReconstructorOptions;

bool IsIdle(const Options& options, const ArrivalQueue& queue) {
  return options.watch_idle > 0 && queue.Now() - queue.LastArrival() >= options.watch_idle;
}

// Until no more will come.
void WatchFolder(const Options& options) {
  LogInfo("Watching " + options.image_path + ": pictures are taken in as they come; " +
          (options.watch_idle > 0
               ? "after " + DurationText(options.watch_idle) + " without one, or Ctrl-C, "
               : std::string("after Ctrl-C ")) +
          "the whole of it is made");
  const FinishRequest finish;
  ArrivalQueue queue(options.image_path, LiveFolders(options.workspace_path).incoming);
  LiveSurvey survey(options);
  while (true) {
    for (const NewPicture& picture : queue.Take()) survey.Add(picture);
    const bool is_over = finish.IsMade() || IsIdle(options, queue);
    if (is_over) break;
    if (survey.HasNews()) survey.RunRound([&] { return queue.Now(); });
  }
  LogInfo(survey.Summary());
}

}  // namespace

CommandResult ReconstructOrWatch(const Options& options) {
  if (!options.watch) return RunAutomaticReconstructor(options);
  options.Check();
  WatchFolder(options);
  return RunAutomaticReconstructor(options);
}

}  // namespace colmap_seapoint
