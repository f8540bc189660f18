// --PartialDensification.write_debug: the paper's figures 10, 11, 13, 15 and 17 of every pair.
#pragma once

#include <filesystem>
#include <string>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/report/debug_canvas.h"
#include "densify/pair_debug.h"

namespace colmap_seapoint {

class DebugFigures {
 public:
  // `model` outlives it.
  DebugFigures(const std::filesystem::path& folder, const SparseModel& model)
      : folder_(folder), model_(model) {}

  // Writes folder/pair_NNNN_figMM_*.png, NNNN being the number of the call, from 1. The figures
  // that show what came before are left out where nothing did, or it is not known from matches
  // (completion pass). Throws Error when a file cannot be written.
  void Write(const PairDebug& pair);

 private:
  const std::string& NameOf(int image_idx) const;
  void WriteFigure(const std::string& name, const Canvas& canvas) const;
  void WriteInfluenceAreas(const PairDebug& pair) const;  // Figure 10
  void WriteMasks(const PairDebug& pair) const;           // Figure 11
  void WriteDisparities(const PairDebug& pair);           // Figure 13
  void WriteOcclusions(const PairDebug& pair) const;      // Figure 15
  void WriteRevived(const PairDebug& pair) const;         // Figure 17

  const std::filesystem::path folder_;
  const SparseModel& model_;
  int num_pairs_ = 0;
  Canvas previous_disparity_;  // of the pair before, for Figure 13
};

}  // namespace colmap_seapoint
