#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/page/base64.h"
#include "colmap_seapoint/page/page_assets.h"
#include "colmap_seapoint/page/pair_rows.h"
#include "colmap_seapoint/report/pairs_csv.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

std::string Encoded(const std::string& text) {
  return Base64(reinterpret_cast<const uint8_t*>(text.data()), text.size());
}

// The vectors of RFC 4648, and a byte with every bit.
TEST(Base64, AsTheStandardSays) {
  EXPECT_EQ(Encoded(""), "");
  EXPECT_EQ(Encoded("f"), "Zg==");
  EXPECT_EQ(Encoded("fo"), "Zm8=");
  EXPECT_EQ(Encoded("foo"), "Zm9v");
  EXPECT_EQ(Encoded("foobar"), "Zm9vYmFy");
  EXPECT_EQ(Encoded("\xff\xef\xbe"), "/+++");
  const uint8_t bytes[] = {1, 2, 3};
  EXPECT_EQ(DataUri("image/png", bytes, 3), "data:image/png;base64,AQID");
}

// three.js is built in as npm has it: nothing was changed by hand, or by the embedding.
TEST(PageAssets, ThreeIsBuiltInByteByByte) {
  std::ifstream in(fs::path(SEAPOINT_WEB_DIR) / "three" / "three.module.min.js", std::ios::binary);
  const std::string file{std::istreambuf_iterator<char>(in), {}};
  ASSERT_GT(file.size(), 600000u);
  EXPECT_EQ(file, kThreeScript);
  // The version that the lock file names.
  std::ifstream lock(fs::path(SEAPOINT_WEB_DIR) / "three" / "package-lock.json");
  const std::string text{std::istreambuf_iterator<char>(lock), {}};
  EXPECT_NE(text.find("\"three\": \"0.170.0\""), std::string::npos);
  EXPECT_NE(file.find("\"170\""), std::string::npos);
}

TEST(ReadPairRows, WhatWritePairsCsvWrote) {
  SparseModel model;
  for (const char* name : {"a, b.jpg", "c.jpg"}) {
    PosedImage image;
    image.name = name;
    model.images.push_back(image);
  }
  SequenceReport report;
  PairReport pair;
  pair.image_idx1 = 0;
  pair.image_idx2 = 1;
  pair.overlap = 0.25;
  pair.num_points = 1234;
  report.pairs.push_back(pair);
  pair.num_points = 0;
  pair.skipped = "too few seeds, 3";
  report.pairs.push_back(pair);
  const fs::path path = fs::path(testing::TempDir()) / "page_pairs.csv";
  WritePairsCsv(path, model, report);
  const std::vector<PairRow> rows = ReadPairRows(path);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].image1, "a, b.jpg");
  EXPECT_EQ(rows[0].image2, "c.jpg");
  EXPECT_EQ(rows[0].overlap, 0.25);
  EXPECT_EQ(rows[0].num_points, 1234);
  EXPECT_EQ(rows[0].skipped, "");
  EXPECT_EQ(rows[1].skipped, "too few seeds, 3");
  WriteTextFile(path, "image1,image2\na,b\n");
  EXPECT_THROW(ReadPairRows(path), Error);
  WriteTextFile(path, "image1,image2,overlap,num_points,skipped\na,b\n");
  EXPECT_THROW(ReadPairRows(path), Error);
  fs::remove(path);
  EXPECT_TRUE(ReadPairRows(path).empty());
}

}  // namespace
}  // namespace colmap_seapoint
