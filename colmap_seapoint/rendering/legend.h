// What tells the size of what a picture of a cloud shows (ours).
#pragma once

#include <string>

#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {

// The length of 1, 2 or 5 times a power of ten that is nearest below `most`; 0 where there is none.
double RoundLength(double most);

// "0.5 m", "200 units": 3 digits, without trailing zeros.
std::string LengthText(double length, const std::string& unit);

// White, with a black border, into the lower left corner: a bar of a round length, about a fifth of
// the picture's width. Not where pixels_a_unit is no number above 0, nor in a tiny picture.
void DrawScaleBar(double pixels_a_unit, const std::string& unit, ColorImage* picture);

// A strip of that width: the colours from low to high (compare/plan_view.h), and both values.
ColorImage RampLegend(int width, double low, double high, const std::string& unit);

}  // namespace colmap_seapoint
