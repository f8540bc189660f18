// Text by printf's rules.
#pragma once

#include <cstdio>
#include <string>

namespace colmap_seapoint {

// At most 255 bytes; what is longer is cut.
template <typename... Values>
std::string Format(const char* format, Values... values) {
  char text[256];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

}  // namespace colmap_seapoint
