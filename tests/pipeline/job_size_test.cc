#include "colmap_seapoint/pipeline/job_size.h"

#include <nlohmann/json.hpp>

#include "colmap_seapoint/pipeline/reconstruct.h"
#include "tests/expect_error.h"
#include "tests/pipeline/strip_survey.h"

namespace colmap_seapoint {
namespace {

class EstimateOnly : public StripSurvey {
 protected:
  nlohmann::json Estimate() const {
    AutomaticReconstructorOptions options = ReconstructorOptions();
    options.estimate_only = true;
    return nlohmann::json::parse(RunAutomaticReconstructor(options).text);
  }
};

TEST_F(EstimateOnly, SaysWhatItTakesAndWritesNothing) {
  WritePictures(4);
  const nlohmann::json few = Estimate();
  EXPECT_EQ(few["pictures"], 4);
  const double megapixels = 4e-6 * kStripWidth * kStripHeight;
  EXPECT_NEAR(few["megapixels"].get<double>(), megapixels, 1e-9);
  EXPECT_GT(few["seconds"], 0);
  EXPECT_GT(few["disk_bytes"], 0);
  EXPECT_GT(few["memory_bytes"], 0);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "ws"));

  WritePictures(8);
  EXPECT_GT(Estimate()["seconds"], 1.5 * few["seconds"].get<double>());
}

TEST_F(EstimateOnly, ReportsWhatCannotBeRead) {
  Write("nothing.txt", "");
  std::filesystem::create_directories(Images());
  EXPECT_ERROR(Estimate(), "holds no picture");
}

}  // namespace
}  // namespace colmap_seapoint
