// What COLMAP prints, as all of its versions would say it, and why it ended.
#pragma once

#include <filesystem>
#include <string>

#include "colmap_seapoint/io/files/subprocess.h"

namespace colmap_seapoint {

// The message in a line: without colours, without the mark of time and place that COLMAP 3.9 and
// later put before it ("E20261129 07:30:56.862390  3222 sfm.cc:310] "), without blanks at its ends.
// "" for lines that say nothing to a user, those of a stack trace.
std::string MessageOf(const std::string& line);

// Whether the message is the one with which a mapper ends that found no model; it then exits with
// 1. Three wordings are known.
bool SaysThatThereIsNoModel(const std::string& message);

// Whether the message says that an option or its value was refused.
bool SaysThatAnOptionIsRefused(const std::string& message);

// Whether the message says that there was no memory.
bool SaysThatMemoryRanOut(const std::string& message);

struct FailedRun {
  SubprocessResult end;
  bool says_that_memory_ran_out = false;
  std::filesystem::path program, output_path, log_path;
  std::string finding;  // "the mapper failed (...)"
};

// Throws Error where the run would not have failed with more memory or disk, or if nobody had
// stopped it: that is no trial that found nothing, and no other one may take its place, since the
// next run would end otherwise.
void ThrowIfFromOutside(const FailedRun& run);

}  // namespace colmap_seapoint
