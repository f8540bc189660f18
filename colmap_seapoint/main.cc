// The only catch of the program.
#include <exception>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/cli/program.h"
#include "colmap_seapoint/system/failure_line.h"
#include "colmap_seapoint/system/process_setup.h"

int main(int argc, char** argv) {
  using namespace colmap_seapoint;
  try {
    SetUpProcess();
    const ExitCode code = RunProgram({argv + 1, argv + argc});
    FinishOutput();
    return code;
  } catch (const UsageError& error) {
    LogError(error.what());
    return kWrongUsage;
  } catch (const std::exception& error) {
    LogError(FailureLine(error));
    return kFailed;
  }
}
