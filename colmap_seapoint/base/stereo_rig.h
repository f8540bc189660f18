// Finds the pictures that a stereo rig took at the same moment (paper 4: "simultaneous" views make
// the pair).
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

// Both vectors are indexed by image_idx (position in SparseModel::images); both are empty when
// there is no rig.
struct StereoRig {
  std::vector<int> right_of;      // the simultaneous right picture; -1: none
  std::vector<uint8_t> is_right;  // taken by a right camera: no part of the track

  int NumPairs() const;
};

// `frames`: image_ids of pictures that were taken at the same moment, a picture in one at most. Two
// cameras of a frame are a stereo pair when their pictures share at least 15 triangulated points on
// average (a camera that looks elsewhere is none); where several pairs could be formed, the one
// that shares most, then among the others. Left is the one whose partner stands on its right (below
// it, where the rig is upright).
StereoRig RigFromFrames(const SparseModel& model, const std::vector<std::vector<uint32_t>>& frames);

// Left name -> right name, relative to their folders: the same name in both, or, where no name is
// in both and names differ only by digits, the same place in natural order (then both lists are
// equally long). Empty: nothing is simultaneous.
std::map<std::string, std::string> SimultaneousNames(std::vector<std::string> left_names,
                                                     std::vector<std::string> right_names);

// The rig that the names tell of: `simultaneous` as SimultaneousNames returns it; pictures in
// `left_folder` and `right_folder` (no
// '/' at the end). All pictures in right_folder are right ones, with a left one or without.
StereoRig RigFromNames(const SparseModel& model, const std::string& left_folder,
                       const std::string& right_folder,
                       const std::map<std::string, std::string>& simultaneous);

}  // namespace colmap_seapoint
