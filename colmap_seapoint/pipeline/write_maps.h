// PartialDensification.write_maps: the finished cloud as a dense workspace of COLMAP.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/io/cloud/cloud_ranges.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/io/image/picture_masks.h"
#include "densify/densify_sequence.h"
#include "densify/maps/view_maps.h"

namespace colmap_seapoint {

// Throws Error where undistorted pictures would be written over the originals, or the undistorted
// model over the model.
void CheckMapFolders(const std::filesystem::path& image_path,
                     const std::filesystem::path& input_path,
                     const std::filesystem::path& output_path);

// The cloud itself is the memory: of every pair only its place in fused.ply is kept, and where its
// points are in the world, 40 bytes for every 8192 of them. Each picture's maps are drawn from what
// of that is in its view, several pictures at once. Same files for any number of threads; each of
// them appears whole.
class MapWriter {
 public:
  // `model` as densified, in the order of its image ids, outlives this. Maps show nothing where a
  // picture's mask is 0: COLMAP's fusion would take the colour of what is hidden there.
  MapWriter(const SparseModel& model, const std::filesystem::path& image_path,
            const PictureMasks& masks, const std::filesystem::path& output_path,
            const PartialDensificationOptions& options, int num_threads);

  // sparse/. `model` as read with ModelContent::kTriangulated, as the pictures see it.
  void WriteModel(const SparseModel& model) const;
  // A pair's points that stand in fused.ply from `first_point` on, without those that
  // CloudWriter skips. In the cloud's order.
  void AddPair(const PartialCloud& part, uint64_t first_point);
  // images/ and stereo/, of all pictures but `left_out`; the list of pictures comes last. Pictures
  // that cannot be read are left out too. Once fused.ply stands.
  void WriteMaps(const std::vector<LeftOutPicture>& left_out, RunReport* report) const;

 private:
  struct Sphere {
    Eigen::Vector3f center;
    float radius = 0;
  };
  struct Block {
    uint64_t first = 0;
    uint32_t count = 0;
    Sphere sphere;
  };
  struct Pair {
    int image_idx1 = -1, image_idx2 = -1;
    Sphere sphere;
    std::vector<Block> blocks;
  };

  static Sphere SphereOf(const std::vector<Eigen::Vector3f>& points);
  ViewMaps DrawMaps(size_t image_idx, const CloudRanges& cloud) const;
  std::string WriteView(size_t image_idx, const CloudRanges& cloud) const;
  void WritePicture(size_t image_idx, const ColorImage& picture) const;
  int NumViewsAtOnce() const;

  const SparseModel& model_;
  std::filesystem::path image_path_, output_path_;
  PictureMasks masks_;
  PartialDensificationOptions options_;
  int num_threads_;
  std::map<uint32_t, Camera> undistorted_;  // by camera_id
  std::vector<Pair> pairs_;
};

}  // namespace colmap_seapoint
