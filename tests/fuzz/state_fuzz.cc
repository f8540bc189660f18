// Any files as what a workspace remembers: the record of a stage, the units, the names of our
// files.
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/files/model_units.h"
#include "colmap_seapoint/io/files/run_report_json.h"
#include "colmap_seapoint/workspace/stage_runner.h"
#include "tests/fuzz/fuzz_files.h"

using namespace colmap_seapoint;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  SetLogLevel(LogLevel::kError);
  const std::filesystem::path folder = WriteFuzzFiles(
      "workspace", {"state/stage.json", "units.json", ".colmap_seapoint"}, data, size);
  WriteFuzzFile("workspace/output", "12345");
  Accepts([&] {
    const WorkspaceState state(folder);
    ResultIfDone<RunReport>(state, {"stage", "1", "inputs", ""});
    state.Read("stage");
  });
  Accepts([&] {
    const auto units = ReadModelUnits(folder);
    FUZZ_REQUIRE(!units || units->offset.allFinite());
  });
  return 0;
}
