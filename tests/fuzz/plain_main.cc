// A fuzz target without libFuzzer: runs it on the given files, or on N pseudo-random inputs (the
// same ones every time). Usage: TARGET N | TARGET FILE...
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

namespace {

// Of all lengths; noise, few values, long runs of one value.
std::vector<uint8_t> PseudoRandomInput(unsigned seed) {
  std::mt19937 generator(seed);
  std::vector<uint8_t> input(generator() % (seed % 4 == 0 ? 64 : 8192));
  const unsigned kind = seed % 3;
  uint8_t run = 0;
  for (size_t i = 0; i < input.size(); ++i) {
    const unsigned noise = generator();
    if (noise >> 24 < 16) run = static_cast<uint8_t>(noise);
    const uint8_t values[] = {static_cast<uint8_t>(noise), static_cast<uint8_t>(noise % 2 * 255),
                              run};
    input[i] = i < 16 ? static_cast<uint8_t>(noise) : values[kind];
  }
  return input;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: %s NUMBER_OF_INPUTS | FILE...\n", argv[0]);
    return 2;
  }
  const int num_inputs = std::atoi(argv[1]);
  if (argc == 2 && num_inputs > 0) {
    for (int i = 0; i < num_inputs; ++i) {
      const std::vector<uint8_t> input = PseudoRandomInput(static_cast<unsigned>(i));
      LLVMFuzzerTestOneInput(input.data(), input.size());
    }
    std::fprintf(stderr, "%d inputs\n", num_inputs);
    return 0;
  }
  for (int i = 1; i < argc; ++i) {
    std::ifstream file(argv[i], std::ios::binary);
    if (!file) {
      std::fprintf(stderr, "cannot read %s\n", argv[i]);
      return 1;
    }
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    LLVMFuzzerTestOneInput(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
  }
  return 0;
}
