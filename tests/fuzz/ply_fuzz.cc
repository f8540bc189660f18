// Any file as a cloud or a mesh: read, moved, and read in parts.
#include "colmap_seapoint/io/cloud/cloud_ranges.h"
#include "colmap_seapoint/io/cloud/ply_reader.h"
#include "colmap_seapoint/io/cloud/transform_cloud.h"
#include "tests/fuzz/fuzz_files.h"

using namespace colmap_seapoint;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::filesystem::path path = WriteFuzzFile("cloud.ply", data, size);
  uint64_t num_points = 0;
  const auto read = [&](const std::filesystem::path& cloud) {
    CloudReader reader(cloud);
    CloudVertex vertex;
    for (num_points = 0; reader.Next(&vertex); ++num_points) {
      FUZZ_REQUIRE(vertex.xyz.allFinite());
    }
    FUZZ_REQUIRE(num_points == reader.NumPoints());
  };
  const bool is_readable = Accepts([&] { read(path); });
  const std::filesystem::path moved = FuzzFolder() / "moved.ply";
  uint64_t num_moved = 0;
  if (Accepts([&] { num_moved = TransformCloud(path, moved, Similarity3d()); })) {
    // Words that are no numbers are kept, as long as they are no positions or normals.
    const bool is_moved_readable = Accepts([&] { read(moved); });
    FUZZ_REQUIRE(is_moved_readable == is_readable);
    FUZZ_REQUIRE(!is_readable || num_points == num_moved);
  }
  Accepts([&] {
    const CloudRanges ranges(path);
    FUZZ_REQUIRE(ranges.Read(0, ranges.NumPoints()).size() == ranges.NumPoints());
  });
  return 0;
}
