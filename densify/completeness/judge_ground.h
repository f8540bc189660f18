// Every cell of the ground that the cloud does not cover gets its cause.
#pragma once

#include <vector>

#include "densify/completeness/sight/sightings.h"
#include "densify/completeness/surface/asked_area.h"

namespace colmap_seapoint {

// Makes the cells of the top layer that a picture may show (and their neighbourhood), and those
// around what other layers hold.
void SpreadCells(const std::vector<SurveyView>& views, Ground* ground);

struct JudgeOptions {
  // Where the two pictures that measure a place best are farther from it than usual, what they can
  // give at this many pixels a point is enough; 0: the wanted spacing is asked for everywhere.
  double pixels_a_point = 0;
  // Units a pixel: what no two pictures see from two sides, and none sees finer than this, is
  // background.
  double background_gsd = 0;
  const AskedArea* asked = nullptr;  // nullptr: no area is asked for
};

// Fills cause, is_expected, num_views and parallax_deg. Background has a cause, but is
// not expected: a camera that looks ahead shows much that nobody meant to measure (outline.h says
// where it is, all the same). Where no picture sees a cell nothing is said yet. The same for any
// number of threads. About a microsecond an uncovered cell and picture that may see it.
void JudgeGround(const SightContext& context, const JudgeOptions& options, int num_threads,
                 Ground* ground);

}  // namespace colmap_seapoint
