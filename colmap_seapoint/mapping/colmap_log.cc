#include "colmap_seapoint/mapping/colmap_log.h"

#include <cctype>
#include <cstdint>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/system/free_disk.h"

namespace colmap_seapoint {
namespace {

constexpr char kEscape = '\033';
constexpr size_t kDateDigits = 8;
constexpr char kProbe[] = "probe";
constexpr uint64_t kFullDiskBytes = 1 << 20;  // of what may still be filled

bool BeginsWith(const std::string& text, const char* beginning) {
  return text.rfind(beginning, 0) == 0;
}

bool Contains(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

// Without "\033[0;31m" and the like.
std::string WithoutColors(const std::string& line) {
  std::string text;
  for (size_t i = 0; i < line.size(); ++i) {
    if (line[i] != kEscape) {
      text += line[i];
      continue;
    }
    while (i + 1 < line.size() && std::isalpha(static_cast<unsigned char>(line[i])) == 0) ++i;
  }
  return text;
}

// "I20261129 " and so on: a letter for how bad it is, and the date.
bool HasLogMark(const std::string& text) {
  if (text.size() < kDateDigits + 2 || !Contains("IWEF", text.substr(0, 1).c_str())) return false;
  for (size_t i = 1; i <= kDateDigits; ++i) {
    if (std::isdigit(static_cast<unsigned char>(text[i])) == 0) return false;
  }
  return text[kDateDigits + 1] == ' ';
}

std::string Trimmed(const std::string& text) {
  const size_t begin = text.find_first_not_of(" \t\r");
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

struct OutsideCause {
  std::string cause, remedy;  // "": the fault is its own
};

// Why no file comes to the disk in the folder, which a program may take for a want of memory: a
// disk that was pulled refuses some calls with these words, and takes others as if it were there.
std::string DiskFault(const std::filesystem::path& folder) {
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) return "";
  try {
    WriteTextFile(folder / kProbe, "");
    std::filesystem::remove(folder / kProbe, error);
  } catch (const Error& fault) {
    return fault.Finding();
  }
  return "";
}

OutsideCause FindOutsideCause(const FailedRun& run) {
  const std::string fault = DiskFault(run.output_path);
  if (!fault.empty()) {
    return {fault + ": " + run.output_path.string(), "check the disk and its cable"};
  }
  if (run.says_that_memory_ran_out) return {"there was no memory for it", "close other programs"};
  if (run.end.WasEndedByOthers()) {
    return {"the system ended it for want of memory, or somebody did", "close other programs"};
  }
  const auto free_bytes = FreeDiskBytes(run.output_path);
  if (!free_bytes || *free_bytes >= kFullDiskBytes) return {};
  return {"the disk of " + run.output_path.string() + " is full", "make room there"};
}

}  // namespace

std::string MessageOf(const std::string& line) {
  std::string text = WithoutColors(line);
  if (HasLogMark(text)) {
    const size_t end = text.find("] ");
    text = end == std::string::npos ? "" : text.substr(end + 2);
  }
  text = Trimmed(text);
  const bool is_trace = BeginsWith(text, "@ ") || BeginsWith(text, "PC: @") ||
                        BeginsWith(text, "*** Aborted at ") || BeginsWith(text, "*** SIG") ||
                        BeginsWith(text, "*** Check failure stack trace");
  return is_trace ? "" : text;
}

bool SaysThatThereIsNoModel(const std::string& message) {
  return Contains(message, "ailed to create sparse model") ||    // 3.8, and global_mapper
         Contains(message, "ailed to create any sparse model");  // 4.x
}

bool SaysThatAnOptionIsRefused(const std::string& message) {
  return Contains(message, "parse options") || Contains(message, "Invalid options");
}

bool SaysThatMemoryRanOut(const std::string& message) {
  return Contains(message, "bad_alloc") || Contains(message, "annot allocate memory") ||
         Contains(message, "ut of memory");
}

void ThrowIfFromOutside(const FailedRun& run) {
  const OutsideCause outside = FindOutsideCause(run);
  if (outside.cause.empty()) return;
  throw Error(run.program.string(), run.finding + ": " + outside.cause,
              outside.remedy + " and run the same command again, which goes on from there; its " +
                  "output is in " + run.log_path.string());
}

}  // namespace colmap_seapoint
