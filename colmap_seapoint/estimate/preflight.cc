#include "colmap_seapoint/estimate/preflight.h"

#include <string>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/estimate/needs.h"
#include "colmap_seapoint/estimate/work_history.h"
#include "colmap_seapoint/system/memory_budget.h"
#include "colmap_seapoint/system/memory_limit.h"

namespace colmap_seapoint {
namespace {

void CheckDisk(const Needs& needs, const Supply& supply, const std::filesystem::path& workspace,
               bool is_error) {
  const DiskVerdict verdict = JudgeDisk(needs, supply);
  if (verdict == DiskVerdict::kEnough) return;
  const std::string finding = "the disk has " + BytesText(*supply.disk_bytes) +
                              " free, and this job takes up to " + BytesText(needs.disk_bytes);
  const char* remedy =
      "make room, choose another --workspace_path, or take fewer points by a larger "
      "--PartialDensification.step";
  if (verdict == DiskVerdict::kTooSmall && is_error) {
    throw Error(workspace.string(), finding,
                std::string(remedy) + "; --check_disk 0 goes on all the same");
  }
  LogWarning(workspace.string() + ": " + finding + "; if it fills up, " + remedy +
             ": what is done is kept");
}

}  // namespace

OfWork<WorkCost> CostsHere(const JobSize& size) {
  OfWork<double> machine;
  machine.values.fill(1);
  if (const auto history = HistoryPath()) machine = ReadMachineRatios(*history);
  return ExpectedCosts(size, machine);
}

void PlanJob(const JobSize& size, const std::filesystem::path& workspace, bool check_disk,
             const OfWork<bool>& done_before, JobProgress* progress) {
  const Needs needs = ExpectedNeeds(size);
  const Supply supply = {FreeDiskBytes(workspace), FolderBytes(workspace), MaxMemory()};
  LogInfo(NeedsText(size, needs, supply));
  CheckDisk(needs, supply, workspace, check_disk);
  if (needs.memory_bytes > supply.memory_bytes) {
    LogWarning("memory may be short: close other programs, or give fewer pictures");
  }
  const OfWork<WorkCost> costs = CostsHere(size);
  LogInfo(TimesText(costs, done_before, progress->Plan(costs, done_before)));
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
