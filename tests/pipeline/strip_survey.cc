#include "tests/pipeline/strip_survey.h"

#include <cstdlib>

#include "colmap_seapoint/io/colmap/database_images.h"

namespace colmap_seapoint {
namespace {

constexpr char kModeVariable[] = "FAKE_COLMAP_MODE";

// Small enough for a test, large enough for the strip's pairs to be verified.
void AskForFew(SeaPointExtractionOptions* extraction) {
  extraction->min_num_features = 400;
  extraction->max_num_features = 500;
}

void AskForCoarse(PartialDensificationOptions* densification) {
  densification->step = 6;
  densification->completion = false;
}

}  // namespace

FeatureExtractorOptions StripSurvey::ExtractorOptions() const {
  FeatureExtractorOptions options;
  options.database_path = DatabasePath().string();
  options.image_path = Images().string();
  AskForFew(&options.extraction);
  return options;
}

ExhaustiveMatcherOptions StripSurvey::MatcherOptions() const {
  ExhaustiveMatcherOptions options;
  options.database_path = DatabasePath().string();
  return options;
}

PartialDensifierOptions StripSurvey::DensifierOptions(const std::string& model,
                                                      const std::string& output) const {
  PartialDensifierOptions options;
  options.image_path = Images().string();
  options.input_path = (folder_ / model).string();
  options.output_path = (folder_ / output).string();
  AskForFew(&options.extraction);
  AskForCoarse(&options.densification);
  return options;
}

AutomaticReconstructorOptions StripSurvey::ReconstructorOptions() const {
  AutomaticReconstructorOptions options;
  options.image_path = Images().string();
  options.workspace_path = (folder_ / "ws").string();
  options.colmap_path = FAKE_COLMAP;
  AskForFew(&options.extraction);
  AskForCoarse(&options.densification);
  return options;
}

ColmapDatabase StripSurvey::OpenDatabase() const {
  return ColmapDatabase(DatabasePath(), ColmapDatabase::Mode::kCreateIfMissing);
}

void StripSurvey::WritePictures(int count) const { WriteStrip(Images(), count); }

void StripSurvey::ExtractPicturesOf(int count) const {
  WritePictures(count);
  ASSERT_TRUE(RunFeatureExtractor(ExtractorOptions()).is_complete);
}

void StripSurvey::MatchPicturesOf(int count) const {
  ASSERT_NO_FATAL_FAILURE(ExtractPicturesOf(count));
  ASSERT_TRUE(RunExhaustiveMatcher(MatcherOptions()).is_complete);
}

std::string StripSurvey::Write(const std::string& name, const std::string& text) const {
  WriteBytes(folder_ / name, text);
  return (folder_ / name).string();
}

std::string LogOf(const std::function<void()>& call) {
  testing::internal::CaptureStderr();
  try {
    call();
  } catch (...) {
    testing::internal::GetCapturedStderr();
    throw;
  }
  return testing::internal::GetCapturedStderr();
}

std::map<std::string, uint32_t> ImageIds(const ColmapDatabase& database) {
  std::map<std::string, uint32_t> ids;
  for (const DatabaseImage& image : ReadImages(database)) ids[image.name] = image.image_id;
  return ids;
}

std::vector<std::string> NamesOf(const std::vector<RunReport::LeftOut>& left_out) {
  std::vector<std::string> names;
  for (const RunReport::LeftOut& item : left_out) names.push_back(item.name);
  return names;
}

FakeColmapMode::FakeColmapMode(const std::string& mode) { setenv(kModeVariable, mode.c_str(), 1); }
FakeColmapMode::~FakeColmapMode() { unsetenv(kModeVariable); }

}  // namespace colmap_seapoint
