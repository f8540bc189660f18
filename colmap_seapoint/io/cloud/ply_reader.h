// The vertices of a PLY file one by one, in the precision that the file holds.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>

namespace colmap_seapoint {

struct CloudVertex {
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  std::array<uint8_t, 3> rgb = {0, 0, 0};
  float confidence = 1;
};

// Streams the vertices of a PLY, ASCII or binary of either byte order, with x y z of any type;
// normals and colours where present (else zero), confidence where present (else 1). Properties
// stand in any order; other properties, lists and elements are skipped. Memory: a buffer of 1 MB.
// About 50 ns a point (binary), a few of a cloud of ours. Throws Error naming file, finding and
// remedy: missing, not a PLY, an unknown format or type, no element 'vertex', no x y z, truncated,
// a word that is no number, a position that is not finite, or farther than 1e15 from the origin.
class CloudReader {
 public:
  // Reads the header and skips what stands before the vertices.
  explicit CloudReader(const std::filesystem::path& path);
  ~CloudReader();
  CloudReader(const CloudReader&) = delete;
  CloudReader& operator=(const CloudReader&) = delete;

  uint64_t NumPoints() const;  // as the header announces; the file is long enough for them
  bool HasNormals() const;
  bool HasColors() const;
  bool HasConfidence() const;
  // Whether a float holds every x y z exactly.
  bool FitsFloat() const;
  // False behind the last vertex.
  bool Next(CloudVertex* vertex);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace colmap_seapoint
