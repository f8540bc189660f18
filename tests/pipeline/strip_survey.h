// A strip of small pictures in a folder of its own, and the stages before the one under test.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/pipeline/densify.h"
#include "colmap_seapoint/pipeline/extract.h"
#include "colmap_seapoint/pipeline/match.h"
#include "colmap_seapoint/pipeline/reconstruct_options.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {

// FOLDER/images/img1.png ... and FOLDER/survey.db. Options ask for few SeaPoints and coarse clouds:
// a stage takes some hundredths of a second.
class StripSurvey : public testing::Test {
 protected:
  std::filesystem::path Images() const { return folder_ / "images"; }
  std::filesystem::path DatabasePath() const { return folder_ / "survey.db"; }

  FeatureExtractorOptions ExtractorOptions() const;
  ExhaustiveMatcherOptions MatcherOptions() const;
  PartialDensifierOptions DensifierOptions(const std::string& model,
                                           const std::string& output) const;
  // Of the whole chain, with the stand-in for COLMAP, into FOLDER/ws.
  AutomaticReconstructorOptions ReconstructorOptions() const;

  ColmapDatabase OpenDatabase() const;
  // Writes img1.png ... img<count>.png.
  void WritePictures(int count) const;
  // The same, with their SeaPoints in survey.db.
  void ExtractPicturesOf(int count) const;
  // The same, with all pairs matched.
  void MatchPicturesOf(int count) const;

  // Writes a text file; its path.
  std::string Write(const std::string& name, const std::string& text) const;

  TemporaryFolder folder_;
};

// What `call` says on stderr.
std::string LogOf(const std::function<void()>& call);

// Image name -> id.
std::map<std::string, uint32_t> ImageIds(const ColmapDatabase& database);

// Names, in the order of the report.
std::vector<std::string> NamesOf(const std::vector<RunReport::LeftOut>& left_out);

// What the stand-in for COLMAP does (tests/cli/fake_colmap.cc), until the end of this object.
class FakeColmapMode {
 public:
  explicit FakeColmapMode(const std::string& mode);
  ~FakeColmapMode();
  FakeColmapMode(const FakeColmapMode&) = delete;
  FakeColmapMode& operator=(const FakeColmapMode&) = delete;
};

}  // namespace colmap_seapoint
