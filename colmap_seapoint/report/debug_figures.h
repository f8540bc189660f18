// The paper's figures 10, 11, 13, 15 and 17 of every pair (--PartialDensification.write_debug).
#pragma once

#include <filesystem>
#include <string>

#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/base/sparse_model.h"
#include "densify/pair_debug.h"

namespace colmap_seapoint {

class DebugFigures {
 public:
  // `model` outlives it.
  DebugFigures(const std::filesystem::path& folder, const SparseModel& model)
      : folder_(folder), model_(model) {}

  // Writes folder/pair_NNNN_figMM_*.png, NNNN being the number of the call, from 1. The figures
  // that show the pair before are left out for the first pair, and in the completion pass, which
  // knows what came before by other means than matches. Throws Error when a file cannot be written.
  void Write(const PairDebug& pair);

 private:
  const std::string& NameOf(int image_idx) const;
  void WriteFigure(const std::string& name, const Image<uint8_t>& figure) const;
  void WriteInfluenceAreas(const PairDebug& pair) const;  // Figure 10
  void WriteMasks(const PairDebug& pair) const;           // Figure 11
  void WriteDisparities(const PairDebug& pair);           // Figure 13
  void WriteOcclusions(const PairDebug& pair) const;      // Figure 15
  void WriteRevived(const PairDebug& pair) const;         // Figure 17

  const std::filesystem::path folder_;
  const SparseModel& model_;
  int num_pairs_ = 0;
  Image<uint8_t> previous_disparity_;  // of the pair before, for Figure 13; empty: there is none
};

}  // namespace colmap_seapoint
