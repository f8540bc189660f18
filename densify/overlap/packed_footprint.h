// Where a partial cloud lies, cell by cell, and how that is kept for the rest of a survey: a few
// bytes a cell, so that ten thousand pictures fit in memory (ours; paper 4, synthesis and
// forgetting).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace colmap_seapoint {

// A patch of reconstructed surface, one picture cell large.
struct SurfacePatch {
  Eigen::Vector3f center;  // world
  float size;              // side, world units
};

// All patches of one partial cloud and the sphere around them.
struct CloudFootprint {
  std::vector<SurfacePatch> patches;
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
  float radius = 0;

  void UpdateSphere();
};

// The same in about a sixth of the memory. Places are rounded to 1/32 of the smallest patch's side,
// sizes likewise, and each patch is what it differs from the straight line through the two before
// it: on a smooth surface, row by row, 4 bits a number.
class PackedFootprint {
 public:
  // Implicit: whatever takes a packed footprint takes one that is not. O(patches).
  PackedFootprint(const CloudFootprint& footprint);  // NOLINT(google-explicit-constructor)

  const Eigen::Vector3f& Center() const { return center_; }  // of the sphere around all patches
  float Radius() const { return radius_; }
  size_t NumPatches() const { return num_patches_; }
  size_t NumBytes() const { return nibbles_.size(); }

  // In the order in which they were packed.
  template <typename Visit>
  void ForEach(const Visit& visit) const {
    Line line;
    size_t at = 0;
    for (size_t i = 0; i < num_patches_; ++i) {
      Number value;
      for (int k = 0; k < 4; ++k) value[k] = line.Predict(k) + ReadNumber(&at);
      line.Append(value);
      visit(SurfacePatch{center_ + unit_ * value.head<3>().cast<float>(),
                         unit_ * static_cast<float>(value[3])});
    }
  }

 private:
  using Number = Eigen::Matrix<int64_t, 4, 1>;  // x, y, z from the centre, size; in units

  // What the two patches before let expect of the next one.
  struct Line {
    Number last = Number::Zero(), before = Number::Zero();

    int64_t Predict(int k) const { return k == 3 ? last[k] : 2 * last[k] - before[k]; }
    void Append(const Number& value) {
      before = last;
      last = value;
    }
  };

  void WriteNumber(int64_t number, size_t* at);
  int64_t ReadNumber(size_t* at) const {
    uint64_t code = 0;
    for (int shift = 0;; shift += 3) {
      const uint8_t nibble = (nibbles_[*at / 2] >> (4 * (*at % 2))) & 15;
      ++*at;
      code |= static_cast<uint64_t>(nibble & 7) << shift;
      if (nibble < 8) break;
    }
    return static_cast<int64_t>(code >> 1) ^ -static_cast<int64_t>(code & 1);
  }

  Eigen::Vector3f center_;
  float radius_;
  float unit_ = 1;  // world units
  size_t num_patches_;
  std::vector<uint8_t> nibbles_;  // two a byte, the lower first; 8 and above: more follow
};

}  // namespace colmap_seapoint
