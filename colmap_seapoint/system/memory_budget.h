// One budget of memory for all threads of the process: what `--max_memory` says. It governs what
// grows with the pictures; clouds and models are streamed or small beside them.
#pragma once

#include <cstdint>

namespace colmap_seapoint {

// Three quarters of AvailableMemoryBytes() until SetMaxMemory() says otherwise.
void SetMaxMemory(uint64_t bytes);
uint64_t MaxMemory();

// A share of the budget, held while it lives. Construction waits until it is free, in no order; a
// share that is larger than the budget waits until it is alone. A thread that holds one already
// does not wait for another (else two could wait for one another): the first has to cover all.
// How long somebody waits changes no result.
class MemoryShare {
 public:
  explicit MemoryShare(uint64_t bytes);
  ~MemoryShare();
  MemoryShare(const MemoryShare&) = delete;
  MemoryShare& operator=(const MemoryShare&) = delete;

 private:
  uint64_t bytes_;  // 0: within that of its thread
};

}  // namespace colmap_seapoint
