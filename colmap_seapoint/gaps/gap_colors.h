// The colours of the causes, on maps and pages.
#pragma once

#include <array>
#include <cstdint>

#include "densify/completeness/surface/gap_cause.h"

namespace colmap_seapoint {

// Red, green, blue: Okabe and Ito's colours, which the colour-blind tell apart.
std::array<uint8_t, 3> CauseColor(GapCause cause);

// "hidden but from one side"
const char* CauseText(GapCause cause);

}  // namespace colmap_seapoint
