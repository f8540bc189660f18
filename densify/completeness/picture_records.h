// The record of every picture, cell by cell: what of it became points, what did not, and why.
#pragma once

#include <vector>

#include "densify/completeness/sight/sightings.h"

namespace colmap_seapoint {

// On the cells of PictureFacts, row by row.
struct PictureRecord {
  int width = 0, height = 0;
  bool is_bad = false;   // as PictureFacts
  double sharpness = 0;  // as PictureFacts
  std::vector<CellState> states;
  std::vector<GapCause> causes;  // kNone where covered, and where nothing is known (open water)

  double Share(CellState state) const;
};

// A cell is covered when the cloud lies in three of its four depth cells. In parallel by picture.
std::vector<PictureRecord> StartRecords(const SightContext& context, int num_threads);

// Carries the ground's causes into the pictures that see it. In parallel by picture.
void FillRecords(const SightContext& context, const Ground& ground, int num_threads,
                 std::vector<PictureRecord>* records);

}  // namespace colmap_seapoint
