// A fuzz target without libFuzzer. Usage:
//   TARGET N                      N pseudo-random inputs, the same ones every time
//   TARGET FILE_OR_FOLDER... [N]  these files, then N inputs made from them, the same ones too
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

namespace {

using Bytes = std::vector<uint8_t>;

// Of all lengths; noise, few values, long runs of one value.
Bytes PseudoRandomInput(unsigned seed) {
  std::mt19937 generator(seed);
  Bytes input(generator() % (seed % 4 == 0 ? 64 : 8192));
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

// What parsers are known to stumble over: at the limits of types, no numbers, no text.
const std::vector<std::string>& Words() {
  static const std::vector<std::string> words = {"0",
                                                 "-1",
                                                 "nan",
                                                 "-inf",
                                                 "1e308",
                                                 "1e-320",
                                                 "2147483648",
                                                 "4294967296",
                                                 "18446744073709551615",
                                                 "99999999999999999999",
                                                 "\"",
                                                 "{",
                                                 ",",
                                                 "\n",
                                                 "#",
                                                 "list",
                                                 "..",
                                                 "/",
                                                 std::string(1, '\0'),
                                                 std::string(8, '\0'),
                                                 std::string(4, '\xff'),
                                                 std::string(8, '\xff'),
                                                 std::string("\0\0\0\x80", 4),
                                                 std::string("\0\0\0\0\0\0\xf0\x7f", 8),
                                                 std::string("\0\0\0\0\0\0\0\x80", 8),
                                                 std::string("\xff\xff\xff\x7f", 4)};
  return words;
}

void ChangeOnce(std::mt19937* generator, Bytes* input) {
  const auto random = [&](size_t below) {
    return static_cast<std::ptrdiff_t>((*generator)() % std::max<size_t>(below, 1));
  };
  // Headers more often than what follows.
  const auto at = input->begin() +
                  random(random(2) == 0 ? std::min<size_t>(input->size(), 256) : input->size());
  const auto left = static_cast<size_t>(input->end() - at);
  const std::string& word = Words()[static_cast<size_t>(random(Words().size()))];
  switch (random(7)) {
    case 0:
      if (left > 0) *at = static_cast<uint8_t>(random(256));
      break;
    case 1:
      if (left > 0) *at ^= static_cast<uint8_t>(1 << random(8));
      break;
    case 2:
      std::copy_n(word.begin(), std::min(word.size(), left), at);
      break;
    case 3:
      input->insert(at, word.begin(), word.end());
      break;
    case 4:
      input->erase(at, at + random(std::min<size_t>(left, 16) + 1));
      break;
    case 5:
      if (random(4) == 0) input->erase(at, input->end());
      break;
    default: {
      const Bytes piece(at, at + random(std::min<size_t>(left, 64) + 1));
      input->insert(input->begin() + random(input->size()), piece.begin(), piece.end());
    }
  }
}

Bytes ChangedInput(const std::vector<Bytes>& corpus, unsigned seed) {
  std::mt19937 generator(seed);
  Bytes input = corpus[generator() % corpus.size()];
  const unsigned num_changes = 1 + generator() % 6;
  for (unsigned i = 0; i < num_changes; ++i) ChangeOnce(&generator, &input);
  return input;
}

std::vector<std::filesystem::path> FilesBelow(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) return {path};
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

void Test(const Bytes& input) { LLVMFuzzerTestOneInput(input.data(), input.size()); }

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.empty()) {
    std::fprintf(stderr, "usage: %s NUMBER_OF_INPUTS | FILE_OR_FOLDER... [NUMBER_OF_INPUTS]\n",
                 argv[0]);
    return 2;
  }
  const auto num_inputs = static_cast<unsigned>(std::max(0, std::atoi(arguments.back().c_str())));
  if (num_inputs > 0) arguments.pop_back();
  std::vector<Bytes> corpus;
  for (const std::string& argument : arguments) {
    for (const std::filesystem::path& path : FilesBelow(argument)) {
      std::ifstream file(path, std::ios::binary);
      if (!file) {
        std::fprintf(stderr, "cannot read %s\n", path.c_str());
        return 1;
      }
      corpus.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
      Test(corpus.back());
    }
  }
  for (unsigned i = 0; i < num_inputs; ++i) {
    Test(corpus.empty() ? PseudoRandomInput(i) : ChangedInput(corpus, i));
  }
  std::fprintf(stderr, "%zu files, %u inputs\n", corpus.size(), num_inputs);
  return 0;
}
