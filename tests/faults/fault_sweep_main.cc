// The whole sweep, or every STRIDE-th call: fault_sweep COMMAND [STRIDE [SEED]]
// Exit code 1 when anything does not hold.
#include <cstdlib>
#include <exception>
#include <iostream>

#include "tests/faults/fault_sweep.h"

int main(int argc, char** argv) {
  using namespace colmap_seapoint;
  const int stride = argc > 2 ? std::atoi(argv[2]) : 1;
  if (argc < 2 || argc > 4 || stride < 1) {
    std::cerr << "usage: " << argv[0] << " COMMAND [STRIDE [SEED]]; commands:";
    for (const std::string& name : SweptCommands()) std::cerr << " " << name;
    std::cerr << "\n";
    return 2;
  }
  try {
    const unsigned seed = argc > 3 ? static_cast<unsigned>(std::atoi(argv[3])) : 0;
    const FaultSweepFigures figures = SweepFaults(argv[1], stride, seed, &std::cout);
    std::cout << argv[1] << ": " << figures.num_calls << " calls, " << figures.num_faults
              << " faults (" << figures.num_done << " did not matter, " << figures.num_failed
              << " failed, " << figures.num_incomplete << " incomplete), " << figures.num_kills
              << " kills, " << figures.complaints.size() << " complaints" << std::endl;
    return figures.complaints.empty() ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 2;
  }
}
