#include "colmap_seapoint/pipeline/page/job_page.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/page/html_page.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

class JobPage : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(workspace_.report); }
  void TearDown() override { fs::remove_all(workspace_.root); }

  ModelSummary Model(const std::string& name, const std::string& section,
                     const std::string& answer) const {
    ModelSummary model;
    model.name = name;
    model.completeness = answer;
    if (!section.empty()) {
      PageContent content;
      content.sections = {section};
      content.names = {""};
      const fs::path folder = workspace_.report / "completeness" / name;
      fs::create_directories(folder);
      WriteTextFile(folder / "index.html", HtmlPage(content));
    }
    return model;
  }
  std::string Write(const std::vector<ModelSummary>& models) const {
    RunReport report;
    report.command = "automatic_reconstructor";
    report.images_in = 5;
    report.images_used = 4;
    report.left_out = {{"dark.jpg", "shows nothing </script>"}};
    report.inputs = {{"a.jpg", 1, "hash-of-a"}};
    WriteJobPage(workspace_, models, report);
    std::ifstream in(workspace_.report / "index.html", std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  const Workspace workspace_ = Workspace(testing::TempDir(), testing::TempDir() + "/job_page_ws");
};

TEST_F(JobPage, HoldsTheModelsInTheirOrder) {
  const std::string page = Write({Model("0", "{\"k\":1}", "90 % covered"), Model("1", "", ""),
                                  Model("2", "{\"k\":3}", "50 % covered")});
  EXPECT_EQ(SectionsOfPage(page), (std::vector<std::string>{"{\"k\":1}", "{\"k\":3}"}));
  EXPECT_NE(page.find("id=\"names\">[\"0\",\"2\"]<"), std::string::npos);
  EXPECT_NE(page.find(">Model 0: 90 % covered. Model 2: 50 % covered.<"), std::string::npos);
  EXPECT_NE(page.find("job_page_ws"), std::string::npos);
  EXPECT_NE(page.find("shows nothing \\u003c/script>"), std::string::npos);
  EXPECT_EQ(page.find("hash-of-a"), std::string::npos);
}

TEST_F(JobPage, TellsOfTheRunWhereNothingWasAssessed) {
  const std::string page = Write({Model("0", "", "")});
  EXPECT_TRUE(SectionsOfPage(page).empty());
  EXPECT_NE(page.find("4 of 5 pictures were used; what is covered was not looked at."),
            std::string::npos);
}

}  // namespace
}  // namespace colmap_seapoint
