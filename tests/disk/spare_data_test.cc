#include "colmap_seapoint/disk/spare_data.h"

#include <gtest/gtest.h>

#include "colmap_seapoint/io/outputs/output_folder.h"
#include "tests/cli/cli_runner.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

class SpareDataTest : public testing::Test {
 protected:
  SpareDataTest() : workspace_((folder_ / "images").string(), (folder_ / "ws").string()) {
    Put("database.db");
    Put("sparse/0/images.bin");
    Put("dense/0/fused.ply");
    Put("map/0/dem.tif");
    Put("images/a.jpg");
    Put("state/mapper.json");
    results_ = ReadTree(workspace_.root);
  }

  void Put(const std::string& name) const {
    const fs::path path = workspace_.root / name;
    fs::create_directories(path.parent_path());
    WriteBytes(path, name);
  }
  // As the chain does.
  void PutOurs(const std::string& folder, const std::string& name) const {
    OutputFolder ours(workspace_.root / folder, "--workspace_path");
    ours.Claim({name});
    Put(folder + "/" + name);
  }
  void PutSpare() const {
    Put("database.db.tmp");
    Put("sparse.tmp/trial_1/0/images.bin");
    Put("sparse.tmp.db");
    PutOurs("watch", "database.db");
    PutOurs("watch", "sparse/0/images.bin");
    PutOurs("watch/dense/0", "fused.ply");
    Put("state/map_0_before/dem.tif");
    Put("state/map_0_abc.memory");
    Put("state/map_0.json");
    Put("state/picture_facts_0");
  }
  std::vector<std::string> Order(JobPart part) const {
    std::vector<std::string> order;
    for (const SpareData& spare : SpareDataOf(workspace_, part)) order.push_back(spare.what);
    return order;
  }
  bool Has(const std::string& name) const { return fs::exists(workspace_.root / name); }

  TemporaryFolder folder_;
  Workspace workspace_;
  std::map<std::string, std::string> results_;
};

TEST_F(SpareDataTest, NoneOfAWorkspaceAsARunLeavesIt) {
  for (const JobPart part :
       {JobPart::kDatabase, JobPart::kModels, JobPart::kClouds, JobPart::kMaps, JobPart::kReport}) {
    EXPECT_TRUE(Order(part).empty());
  }
}

TEST_F(SpareDataTest, TheOrderIsFromTheLeastLoss) {
  PutSpare();
  const auto order = Order(JobPart::kClouds);
  ASSERT_EQ(order.size(), 4u);
  EXPECT_NE(order[0].find("half made"), std::string::npos);
  EXPECT_NE(order[1].find("coarse survey"), std::string::npos);
  EXPECT_NE(order[2].find("measured in the pictures"), std::string::npos);
  EXPECT_NE(order[3].find("continued"), std::string::npos);
  EXPECT_EQ(Order(JobPart::kMaps).size(), 3u);
  EXPECT_EQ(Order(JobPart::kReport).size(), 3u);
}

TEST_F(SpareDataTest, WhatAPartWorksInStays) {
  PutSpare();
  for (const SpareData& spare : SpareDataOf(workspace_, JobPart::kModels)) spare.remove();
  EXPECT_TRUE(Has("sparse.tmp/trial_1/0/images.bin"));
  EXPECT_TRUE(Has("sparse.tmp.db"));
  EXPECT_FALSE(Has("database.db.tmp"));
  PutSpare();
  for (const SpareData& spare : SpareDataOf(workspace_, JobPart::kMaps)) spare.remove();
  EXPECT_TRUE(Has("state/map_0_before/dem.tif"));
  EXPECT_TRUE(Has("state/map_0_abc.memory"));
  EXPECT_FALSE(Has("sparse.tmp"));
  PutSpare();
  for (const SpareData& spare : SpareDataOf(workspace_, JobPart::kDatabase)) spare.remove();
  EXPECT_TRUE(Has("database.db.tmp"));
}

TEST_F(SpareDataTest, ResultsAndWhatIsNotOursStay) {
  PutSpare();
  Put("watch/notes.txt");
  Put("watch/sparse/0/notes.txt");
  Put("watch/dense/0/notes.txt");
  Put("watch/map/0/dem.tif");
  for (const SpareData& spare : SpareDataOf(workspace_, JobPart::kClouds)) spare.remove();
  auto left = ReadTree(workspace_.root);
  for (const auto& [name, bytes] : results_) EXPECT_EQ(left[name], bytes) << name;
  for (const char* name : {"state/map_0.json", "watch/notes.txt", "watch/sparse/0/notes.txt",
                           "watch/dense/0/notes.txt", "watch/map/0/dem.tif"}) {
    EXPECT_EQ(left.count(name), 1u) << name;
  }
  EXPECT_EQ(left.size(), results_.size() + 5) << "something was left over";
}

}  // namespace
}  // namespace colmap_seapoint
