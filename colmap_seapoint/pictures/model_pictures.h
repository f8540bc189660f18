// The pictures and SeaPoints of a model, for densification.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/io/image/picture_masks.h"
#include "densify/densify_sequence.h"
#include "feature/extract_features.h"
#include "feature/match_features.h"

namespace colmap_seapoint {

// `model` and `database` (nullptr: there is none) outlive it. SeaPoints come from the database, by
// image name, where it is given and has ours; those found in a reduced (or larger) picture are
// scaled to the model's camera (paper 4, hybrid resolution), those of a picture of other
// proportions not used. Pictures come with their masks; one whose mask cannot be used is as good as
// unreadable. Matches are the verified ones of the database (the raw ones of a pair that
// nothing has verified) where it has both pictures' SeaPoints and the pair.
class ModelPictures : public PictureSource {
 public:
  ModelPictures(const SparseModel& model, const std::filesystem::path& image_path,
                const PictureMasks& masks, ColmapDatabase* database,
                const SeaPointExtractionOptions& extraction,
                const SeaPointMatchingOptions& matching);

  // "" when the picture's header is readable and of its camera's size, and its mask's fits; else
  // the reason. Cheap.
  std::string Check(int image_idx) const;
  // How many of the model's pictures have SeaPoints in the database.
  int NumInDatabase() const { return static_cast<int>(in_database_.size()); }

  // Size and hash of a picture, for the run's report: of the bytes that ReadPicture decoded; only a
  // picture that it never read is read for this. Called from several threads at once.
  RunReport::Input Describe(int image_idx) const;

  Picture ReadPicture(int image_idx) override;
  std::optional<Features> ReadSeaPoints(int image_idx) override;
  Features FindSeaPoints(const Picture& picture) override;
  // Damaged matches are as good as none; a warning says so.
  std::optional<FeatureMatches> ReadMatches(int image_idx1, int image_idx2) override;
  FeatureMatches Match(const Features& features1, const Features& features2) override;

 private:
  struct StoredSeaPoints {
    uint32_t image_id;
    float x_scale, y_scale;  // from the picture they were found in to the model's
  };

  const PosedImage& ImageAt(int image_idx) const;
  std::filesystem::path PathOf(int image_idx) const;
  // Whether the database has SeaPoints of ours that ReadSeaPoints can return.
  bool HasStoredSeaPoints(int image_idx);

  const SparseModel& model_;
  std::filesystem::path image_path_;
  PictureMasks masks_;
  ColmapDatabase* database_;
  SeaPointExtractionOptions extraction_;
  SeaPointMatchingOptions matching_;
  std::unordered_map<std::string, StoredSeaPoints> in_database_;  // the model's images, by name
  std::vector<std::optional<bool>> has_stored_;                   // by image_idx, once known
  mutable std::mutex described_mutex_;
  std::vector<std::optional<RunReport::Input>> described_;  // by image_idx, once read
};

}  // namespace colmap_seapoint
