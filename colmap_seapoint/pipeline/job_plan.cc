#include "colmap_seapoint/pipeline/job_plan.h"

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/estimate/needs.h"
#include "colmap_seapoint/estimate/work_history.h"
#include "colmap_seapoint/system/memory_budget.h"
#include "colmap_seapoint/system/memory_limit.h"

namespace colmap_seapoint {
namespace {

JobSize SizeOf(const AutomaticReconstructorOptions& options,
               const std::vector<ReadablePicture>& pictures, bool matches_all_pairs) {
  JobSize size;
  size.num_pictures = static_cast<int64_t>(pictures.size());
  for (const ReadablePicture& picture : pictures) {
    size.megapixels += 1e-6 * picture.info.width * picture.info.height;
  }
  size.finds_look_alikes = !matches_all_pairs && options.pairs.loop_detection;
  size.num_pairs = matches_all_pairs
                       ? size.num_pictures * (size.num_pictures - 1) / 2
                       : ExpectedSequentialPairs(size.num_pictures, options.pairs.overlap,
                                                 size.finds_look_alikes);
  size.step = options.densification.step;
  size.writes_maps = options.densification.write_maps;
  size.num_threads = EffectiveNumThreads(options.run.num_threads);
  return size;
}

// Whether a stage is up to date is known when its turn comes; here that its record is there, beside
// a database that is begun with the same pictures and options, is enough.
OfWork<bool> DoneBefore(const Stage& database, const WorkspaceState& state) {
  OfWork<bool> done;
  const auto begun = state.Read(database.name);
  if (!begun || begun->value("fingerprint", "") != StageFingerprint(database)) return done;
  if (!state.Read("mapper")) return done;
  for (const Work work :
       {Work::kPictures, Work::kLookAlikes, Work::kPairs, Work::kRegistration, Work::kRefinement}) {
    done[work] = true;
  }
  done[Work::kDensification] = done[Work::kMaps] = state.Read("dense_0").has_value();
  return done;
}

void CheckDisk(const Needs& needs, const Supply& supply, const Workspace& workspace,
               bool is_error) {
  const DiskVerdict verdict = JudgeDisk(needs, supply);
  if (verdict == DiskVerdict::kEnough) return;
  const std::string finding = "the disk has " + BytesText(supply.disk_bytes) +
                              " free, and this job takes up to " + BytesText(needs.disk_bytes);
  const char* remedy =
      "make room, choose another --workspace_path, or take fewer points by a larger "
      "--PartialDensification.step";
  if (verdict == DiskVerdict::kTooSmall && is_error) {
    throw Error(workspace.root.string(), finding,
                std::string(remedy) + "; --check_disk 0 goes on all the same");
  }
  LogWarning(workspace.root.string() + ": " + finding + "; if it fills up, " + remedy +
             ": what is done is kept");
}

}  // namespace

JobEstimate PlanJob(const AutomaticReconstructorOptions& options, const Workspace& workspace,
                    const std::vector<ReadablePicture>& pictures, bool matches_all_pairs,
                    const Stage& database, const WorkspaceState& state) {
  const JobSize size = SizeOf(options, pictures, matches_all_pairs);
  const Needs needs = ExpectedNeeds(size);
  const Supply supply = {FreeDiskBytes(workspace.root), FolderBytes(workspace.root), MaxMemory()};
  LogInfo(NeedsText(size, needs, supply));
  CheckDisk(needs, supply, workspace, options.check_disk);
  if (needs.memory_bytes > supply.memory_bytes) {
    LogWarning("memory may be short: close other programs, or give fewer pictures");
  }
  const auto history = HistoryPath();
  OfWork<double> machine;
  machine.values.fill(1);
  if (history) machine = ReadMachineRatios(*history);
  const OfWork<WorkCost> costs = ExpectedCosts(size, machine);
  const OfWork<bool> done_before = DoneBefore(database, state);
  JobEstimate estimate(costs, done_before);
  LogInfo(TimesText(costs, done_before, estimate.SecondsLeft(0)));
  return estimate;
}

void RememberJob(JobProgress* progress) {
  const auto history = HistoryPath();
  if (!history) return;
  RunRatios ratios = progress->Ratios();  // to what this machine's history had said
  const OfWork<double> machine = ReadMachineRatios(*history);
  for (size_t i = 0; i < kNumWorks; ++i) ratios.values[i] *= machine.values[i];
  AddRun(*history, ratios);
}

}  // namespace colmap_seapoint
