// A model's pictures and SeaPoints, all in memory: neither decoding nor finding SeaPoints is part
// of what is measured afterwards.
#pragma once

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/pictures/model_pictures.h"
#include "densify/densify_sequence.h"

namespace colmap_seapoint {

class MemoryPictures : public PictureSource {
 public:
  // The model outlives it. Decodes every picture (their planes are held), reads its SeaPoints
  // from the database or, where that has none (or is not given), finds them. Throws Error for
  // unreadable pictures.
  MemoryPictures(const SparseModel& model, const std::filesystem::path& image_path,
                 const std::string& database_path, int num_threads);

  Picture ReadPicture(int image_idx) override;
  std::optional<Features> ReadSeaPoints(int image_idx) override;
  Features FindSeaPoints(const Picture& picture) override;
  // The database's; none after DropSeaPoints, which changes the indices.
  std::optional<FeatureMatches> ReadMatches(int image_idx1, int image_idx2) override;
  FeatureMatches Match(const Features& features1, const Features& features2) override;

  // Forgets the SeaPoints of a picture within `radius` pixels of the places.
  void DropSeaPoints(int image_idx, const std::vector<Eigen::Vector2d>& places, double radius);

  double Megapixels() const;
  // CPU seconds for finding and describing all SeaPoints; kNotMeasured when they came from the
  // database.
  double SeaPointCpuSeconds() const { return seapoint_cpu_; }
  // CPU seconds spent in Match() since construction.
  double MatchCpuSeconds() const { return 1e-9 * static_cast<double>(match_nanoseconds_); }

 private:
  std::optional<ColmapDatabase> database_;
  ModelPictures source_;
  bool dropped_ = false;
  std::vector<Picture> pictures_;
  std::vector<Features> features_;
  double seapoint_cpu_ = 0;
  std::atomic<int64_t> match_nanoseconds_{0};
};

}  // namespace colmap_seapoint
