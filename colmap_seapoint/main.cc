// The only catch of the program.
#include <exception>
#include <limits>
#include <new>
#include <string>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/cli/program.h"

namespace {

using namespace colmap_seapoint;

// Buffers of megabytes come and go. By default each would be fresh memory, zeroed by the system
// page by page and given back: what is freed is kept for the next one. Not so the largest, planes
// of pictures and clouds: what little stays between them would leave holes that the next one does
// not fit into, and memory would grow with the number of pictures.
void KeepFreedMemory() {
#ifdef __GLIBC__
  constexpr int kNotKept = 10'000'000;  // bytes
  mallopt(M_MMAP_THRESHOLD, kNotKept);
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  mallopt(M_ARENA_MAX, 1);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  KeepFreedMemory();
  try {
    return RunProgram({argv + 1, argv + argc});
  } catch (const UsageError& error) {
    LogError(error.what());
    return kWrongUsage;
  } catch (const Error& error) {
    LogError(error.what());
  } catch (const std::bad_alloc&) {
    LogError("memory: not enough for this run; use fewer --num_threads or smaller pictures");
  } catch (const std::exception& error) {
    LogError(std::string("internal: ") + error.what() + "; please report this");
  }
  return kFailed;
}
