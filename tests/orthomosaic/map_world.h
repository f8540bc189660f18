// A small survey with exact truth: a seabed, a table over it, and six pictures from above.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/orthomosaic/orthomosaic.h"
#include "examples/benchmarks/map/memory_map.h"
#include "tests/io/test_files.h"
#include "tests/synthetic/world.h"

namespace colmap_seapoint {

// A whole map, for tests that look at all of it.
struct MapInMemory : MemoryMap {
  void Begin(const MapFrame& frame, const MapGrid& grid) override {
    ++num_begins;
    MemoryMap::Begin(frame, grid);
  }

  int num_begins = 0;
};

struct MapWorld {
  World world;
  SparseModel model;
  std::vector<Picture> pictures;
  std::filesystem::path cloud_path;
  double gsd = 0;  // of the ground

  MapPictureReader Reader() const {
    return [this](size_t i) { return pictures[i]; };
  }
  std::vector<Viewpoint> Viewpoints() const;
  OrthomosaicInputs Inputs(const std::filesystem::path& folder) const {
    return {model, cloud_path, std::nullopt, Reader(), folder};
  }
};

// Two rows of three pictures of 200 x 150 pixels, 2 (0.008 a pixel) above the ground z = 2; a table
// of 0.4 x 0.3 stands 0.3 above the middle of it. `gain` darkens a picture. The cloud lies in
// `folder`: every place that any camera sees, 0.0064 apart, but none where x > 0.9.
MapWorld MakeMapWorld(const std::filesystem::path& folder,
                      const std::function<double(size_t)>& gain);

}  // namespace colmap_seapoint
