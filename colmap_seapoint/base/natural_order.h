// The order in which a person counts: "img2" before "img10".
#pragma once

#include <string>

namespace colmap_seapoint {

// Runs of digits compare by value, everything else bytewise. Names that differ in leading zeros
// only ("7", "07") fall back to the bytewise order, so this is a strict total order.
bool NaturalLess(const std::string& a, const std::string& b);

}  // namespace colmap_seapoint
