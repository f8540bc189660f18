#include "colmap_seapoint/estimate/preflight.h"

#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/estimate/needs.h"
#include "colmap_seapoint/estimate/work_history.h"
#include "colmap_seapoint/system/free_disk.h"
#include "colmap_seapoint/system/memory_budget.h"

namespace colmap_seapoint {
OfWork<WorkCost> CostsHere(const JobSize& size) {
  OfWork<double> machine;
  machine.values.fill(1);
  if (const auto history = HistoryPath()) machine = ReadMachineRatios(*history);
  return ExpectedCosts(size, machine);
}

void PlanJob(const JobSize& size, const std::filesystem::path& workspace,
             const OfWork<bool>& done_before, JobProgress* progress) {
  const Needs needs = ExpectedNeeds(size);
  const Supply supply = {FreeDiskBytes(workspace), 0, MaxMemory()};
  LogInfo(NeedsText(size, needs, supply));
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
