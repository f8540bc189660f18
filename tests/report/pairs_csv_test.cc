#include "colmap_seapoint/report/pairs_csv.h"

#include <gtest/gtest.h>

#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

SparseModel ModelOf(const std::vector<std::string>& names) {
  SparseModel model;
  for (const std::string& name : names) {
    PosedImage image;
    image.name = name;
    model.images.push_back(image);
  }
  return model;
}

std::string Written(const SparseModel& model, const SequenceReport& report) {
  TempDir dir;
  WritePairsCsv(dir / "pairs.csv", model, report);
  return ReadBytes(dir / "pairs.csv");
}

constexpr char kHeader[] =
    "image1,image2,pass,baseline,overlap,num_oa,num_na,num_rea,num_seeds,num_failed_seeds,"
    "num_points,rectification_seconds,propagation_seconds,total_seconds,skipped\n";

TEST(PairsCsvTest, OneRowAPairInTheirOrder) {
  SequenceReport report;
  PairReport pair;
  pair.image_idx1 = 1;
  pair.image_idx2 = 0;
  pair.pass = "sequence";
  pair.baseline = 0.25;
  pair.overlap = 0.5;
  pair.num_oa = 1;
  pair.num_na = 2;
  pair.num_rea = 3;
  pair.num_seeds = 4;
  pair.num_failed_seeds = 5;
  pair.num_points = 6000000000;
  pair.rectification_seconds = 0.125;
  pair.propagation_seconds = 1.5;
  pair.total_seconds = 2;
  report.pairs.push_back(pair);
  PairReport skipped;
  skipped.image_idx1 = 2;
  skipped.pass = "completion";
  skipped.skipped = "no picture follows";
  report.pairs.push_back(skipped);
  EXPECT_EQ(Written(ModelOf({"a.jpg", "b.jpg", "c.jpg"}), report),
            std::string(kHeader) +
                "b.jpg,a.jpg,sequence,0.25,0.5,1,2,3,4,5,6000000000,0.125,1.5,2,\n"
                "c.jpg,,completion,0,0,0,0,0,0,0,0,0,0,0,no picture follows\n");
}

TEST(PairsCsvTest, NamesAndReasonsThatNeedQuotes) {
  SequenceReport report;
  PairReport pair;
  pair.image_idx1 = 0;
  pair.skipped = "too few seeds, of \"20\"";
  report.pairs.push_back(pair);
  EXPECT_EQ(Written(ModelOf({"a, \"b\".jpg"}), report),
            std::string(kHeader) +
                "\"a, \"\"b\"\".jpg\",,,0,0,0,0,0,0,0,0,0,0,0,\"too few seeds, of \"\"20\"\"\"\n");
}

TEST(PairsCsvTest, NoPairs) { EXPECT_EQ(Written(ModelOf({"a.jpg"}), {}), kHeader); }

TEST(PairsCsvTest, AFolderThatIsNotThere) {
  TempDir dir;
  EXPECT_ERROR(WritePairsCsv(dir / "none" / "pairs.csv", ModelOf({}), {}), "pairs.csv");
}

}  // namespace
}  // namespace colmap_seapoint
