#include "colmap_seapoint/io/cloud/seen_cloud.h"

#include <array>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/cloud/ply_reader.h"
#include "colmap_seapoint/io/files/input_stream.h"

namespace colmap_seapoint {

void ReadSeenCloud(const std::filesystem::path& path,
                   const std::function<void(const CloudPoint&, uint32_t, uint32_t)>& visit) {
  const std::filesystem::path vis_path = path.string() + ".vis";
  const auto refuse = [&](const char* finding) {
    throw Error(vis_path.string(), finding, "make the cloud again");
  };
  CloudReader cloud(path);
  InputStream vis(vis_path);
  uint64_t count = 0;
  vis.read(reinterpret_cast<char*>(&count), sizeof(count));
  if (!vis || count != cloud.NumPoints()) refuse("belongs to another cloud");
  CloudVertex vertex;
  while (cloud.Next(&vertex)) {
    std::array<uint32_t, 3> seen = {};  // how many, and which
    vis.read(reinterpret_cast<char*>(seen.data()), sizeof(seen));
    if (!vis || seen[0] != 2) refuse("does not tell the two pictures of every point");
    visit({vertex.xyz.cast<float>(), vertex.normal, vertex.rgb, vertex.confidence}, seen[1],
          seen[2]);
  }
}

}  // namespace colmap_seapoint
