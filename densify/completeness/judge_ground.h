// Every cell of the ground that the cloud does not cover gets its cause.
#pragma once

#include <vector>

#include "densify/completeness/sight/sightings.h"
#include "densify/completeness/surface/asked_area.h"

namespace colmap_seapoint {

// Makes the cells of the top layer that a picture may show (and their neighbourhood), and those
// around what other layers hold.
void SpreadCells(const std::vector<SurveyView>& views, Ground* ground);

// Of covered cells, views and parallax are looked at on every fourth cell both ways.
inline constexpr int kSampleCells = 4;
// The one that tells of a cell, along either axis.
inline int SampledCellOf(int at) { return at & ~(kSampleCells - 1); }
inline bool IsSampledCell(int x, int y) { return x % kSampleCells == 0 && y % kSampleCells == 0; }

struct JudgeOptions {
  // Where the two pictures that measure a place best are farther from it than usual, what they can
  // give at this many pixels a point is enough; 0: the wanted spacing is asked for everywhere.
  double pixels_a_point = 0;
  const AskedArea* asked = nullptr;  // nullptr: no area is asked for
};

// Fills cause, is_expected and what the pictures tell; of cells that were covered before, of every
// sixteenth. Where no picture sees a cell nothing is said yet (outline.h). The same for any number
// of threads. About a microsecond an uncovered cell and picture that may see it.
void JudgeGround(const SightContext& context, const JudgeOptions& options, int num_threads,
                 Ground* ground);

}  // namespace colmap_seapoint
