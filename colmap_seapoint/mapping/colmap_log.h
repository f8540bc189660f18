// What COLMAP prints, as all of its versions would say it.
#pragma once

#include <string>

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

}  // namespace colmap_seapoint
