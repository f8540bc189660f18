#include "colmap_seapoint/mapping/join_rounds.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "colmap_seapoint/base/similarity3.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/mapping/mapper_process.h"
#include "tests/io/test_files.h"
#include "tests/mapping/exact_survey.h"
#include "tests/mapping/survey_database.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

// The survey's pictures of these ids, with the points that two of them see.
SparseModel PartOf(SparseModel survey, uint32_t first_id, uint32_t last_id) {
  const auto is_outside = [&](uint32_t id) { return id < first_id || id > last_id; };
  auto& images = survey.images;
  images.erase(std::remove_if(images.begin(), images.end(),
                              [&](const PosedImage& image) { return is_outside(image.image_id); }),
               images.end());
  for (auto point = survey.points3D.begin(); point != survey.points3D.end();) {
    auto& track = point->second.track;
    track.erase(std::remove_if(track.begin(), track.end(),
                               [&](const auto& element) { return is_outside(element.image_id); }),
                track.end());
    point = track.size() < 2 ? survey.points3D.erase(point) : std::next(point);
  }
  for (PosedImage& image : images) {
    for (uint64_t& id : image.point3D_ids) {
      if (survey.points3D.count(id) == 0) id = kNoPoint3D;
    }
  }
  return survey;
}

TEST(JoinRoundsTest, StripsThatWereMappedApartBecomeModelZero) {
  const TempDir dir;
  const SparseModel survey = ExactSurvey(ExactLens(), 5);
  MapperJob job;
  job.database_path = dir / "database.db";
  job.output_path = dir / "sparse";
  job.log_folder = dir / "logs";
  fs::create_directories(job.log_folder);
  WriteSurveyDatabase(survey, job.database_path);
  SparseModel back = PartOf(survey, 6, 10);
  Similarity3d frame;
  frame.scale = 0.2;
  frame.translation = {5, 6, 7};
  TransformModel(frame, &back);
  WriteSparseModelBinary(job.output_path / "0", PartOf(survey, 1, 5));
  WriteSparseModelBinary(job.output_path / "1", back);
  std::vector<fs::path> polished;
  JoinModelsOfRounds(job, [&](const fs::path& folder) { polished.push_back(folder); });
  ASSERT_EQ(ListModels(job.output_path), std::vector<fs::path>{job.output_path / "0"});
  EXPECT_EQ(polished.size(), 1u);
  EXPECT_EQ(ReadSparseModel(job.output_path / "0").images.size(), 10u);
  EXPECT_TRUE(fs::exists(job.log_folder / "joining.txt"));
}

}  // namespace
}  // namespace colmap_seapoint
