#include "colmap_seapoint/pipeline/reconstruct_options.h"

#include <gtest/gtest.h>

#include "tests/expect_error.h"
#include "tests/pipeline/strip_survey.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;
using Options = AutomaticReconstructorOptions;

class ReconstructOptions : public StripSurvey {
 protected:
  Options Good() const {
    fs::create_directories(Images());
    return ReconstructorOptions();
  }
};

TEST_F(ReconstructOptions, BindsTheGroupsOfAllStages) {
  Options options;
  OptionTable table;
  options.Bind(&table);
  for (const char* name :
       {"image_path", "workspace_path", "colmap_path", "quality", "matcher",
        "adjust_principal_point", "rig", "scale_bars_path", "positions_path",
        "ImageReader.camera_model", "SeaPointExtraction.min_num_features",
        "SequentialMatching.overlap", "SeaPointMatching.max_distance", "PartialDensification.mode",
        "random_seed", "num_threads", "log_level"}) {
    EXPECT_NE(table.Find(name), nullptr) << name;
  }
  EXPECT_TRUE(table.Find("image_path")->required);
  EXPECT_TRUE(table.Find("workspace_path")->required);
  EXPECT_EQ(table.Find("quality")->choices,
            (std::vector<std::string>{"field", "survey", "archive"}));
  EXPECT_EQ(table.Find("quality")->default_value, "survey");
  EXPECT_EQ(table.Set("SequentialMatching.overlap", "9"), "");
  EXPECT_EQ(options.pairs.overlap, 9);
}

TEST_F(ReconstructOptions, ArchivePresetsTwiceTheSeaPointsWithSift) {
  for (const char* quality : {"field", "survey"}) {
    Options options;
    options.quality = quality;
    options.Preset();
    EXPECT_EQ(options.extraction.min_num_features, Options().extraction.min_num_features);
    EXPECT_EQ(options.extraction.descriptor, "rbrief");
  }
  Options options;
  options.quality = "archive";
  options.Preset();
  EXPECT_EQ(options.extraction.min_num_features, 2 * Options().extraction.min_num_features);
  EXPECT_EQ(options.extraction.max_num_features, 2 * Options().extraction.max_num_features);
  EXPECT_EQ(options.extraction.descriptor, "sift");
}

TEST_F(ReconstructOptions, TheMappersOptionsAreForeign) {
  Options options;
  const ForeignOptions foreign = options.Foreign();
  EXPECT_EQ(foreign.group, "Mapper");
  EXPECT_EQ(foreign.values, &options.mapper);
  EXPECT_FALSE(foreign.help.empty());
}

TEST_F(ReconstructOptions, WhetherTheUserSaysWhatTheMapperRefines) {
  const auto gives = [](const std::string& mapper_option) {
    Options options;
    options.mapper[mapper_option] = "1";
    return GivesRefinement(options);
  };
  EXPECT_FALSE(GivesRefinement(Options()));
  EXPECT_FALSE(gives("Mapper.min_model_size"));
  EXPECT_FALSE(gives("Mapper.ba_global_max_refinements"));
  EXPECT_FALSE(gives("Mapper.ba_ref"));
  EXPECT_FALSE(gives("Mapper.tri_min_angle"));
  EXPECT_TRUE(gives("Mapper.ba_refine_focal_length"));
  EXPECT_TRUE(gives("Mapper.ba_refine_principal_point"));
  // Behind other options of the mapper too.
  Options options;
  options.mapper = {{"Mapper.abs_pose_max_error", "3"},
                    {"Mapper.ba_refine_extra_params", "0"},
                    {"Mapper.min_model_size", "3"}};
  EXPECT_TRUE(GivesRefinement(options));
}

TEST_F(ReconstructOptions, APresetBringsItsCameraModel) {
  Options options;
  options.reader.camera_preset = "gopro_wide_dome";
  options.Preset();
  EXPECT_EQ(options.reader.camera_model, "OPENCV_FISHEYE");
}

TEST_F(ReconstructOptions, GoodOnesPass) {
  EXPECT_NO_THROW(Good().Check());
  EXPECT_FALSE(fs::exists(folder_ / "ws"));  // nothing is made before the work
}

TEST_F(ReconstructOptions, ContradictionsAreUsage) {
  Options options = Good();
  options.reader.camera_params = "1,2,3";
  EXPECT_USAGE_ERROR(options.Check(), "camera_params");
  options = Good();
  options.extraction.max_num_features = options.extraction.min_num_features - 1;
  EXPECT_USAGE_ERROR(options.Check(), "max_num_features");
  options = Good();
  options.densification.window_size = 8;
  EXPECT_USAGE_ERROR(options.Check(), "window_size");
  options = Good();
  options.rig = "left,left";
  EXPECT_USAGE_ERROR(options.Check(), "it must be LEFT,RIGHT");
  options = Good();
  options.scale.targets_path = "targets.csv";
  EXPECT_USAGE_ERROR(options.Check(), "needs scale_bars_path");
}

TEST_F(ReconstructOptions, PathsThatAreNotThereAreErrors) {
  Options options = Good();
  options.image_path = (folder_ / "absent").string();
  EXPECT_ERROR(options.Check(), "there is no such folder");
  options = Good();
  options.rig = "left,right";
  EXPECT_ERROR(options.Check(), "left");
  options = Good();
  options.scale.positions_path = (folder_ / "absent.csv").string();
  EXPECT_ERROR(options.Check(), "absent.csv");
  options.scale.positions_path = Write("positions.csv", "image,x,y,z\na.png,1,2\n");
  EXPECT_ERROR(options.Check(), "positions.csv:2");
}

}  // namespace
}  // namespace colmap_seapoint
