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
  // A place is covered, too, that holds what its second nearest good picture can give at this many
  // pixels a point; 0: the wanted spacing is asked for everywhere.
  double pixels_a_point = 0;
  const AskedArea* asked = nullptr;  // nullptr: no area is asked for
};

// Fills cause, is_imaged, is_expected, num_views and parallax_deg. The same for any number of
// threads. Where no picture sees a cell nothing is said yet (outline.h). About a microsecond an
// uncovered cell and picture that may see it.
void JudgeGround(const SightContext& context, const JudgeOptions& options, int num_threads,
                 Ground* ground);

}  // namespace colmap_seapoint
