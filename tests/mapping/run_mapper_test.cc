// The rounds of the mapper against a COLMAP whose every answer is written down beforehand.
#include "colmap_seapoint/mapping/run_mapper.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/mapping/adjust_lens.h"
#include "colmap_seapoint/mapping/mapper_process.h"
#include "tests/io/test_files.h"
#include "tests/mapping/exact_survey.h"
#include "tests/mapping/scripted_colmap.h"
#include "tests/mapping/survey_database.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr char kMapper[] = "mapper";
constexpr char kGlobal[] = "global_mapper";
constexpr char kTriangulator[] = "point_triangulator";
constexpr char kRefineFocal[] = "Mapper.ba_refine_focal_length";
constexpr char kRefine[] = "Mapper.ba_refine_extra_params";

class RunMapperTest : public testing::Test {
 protected:
  RunMapperTest() {
    fs::create_directories(dir_ / "logs");
    ColmapDatabase(dir_ / "database.db", ColmapDatabase::Mode::kCreateIfMissing).Finish();
    job_.database_path = dir_ / "database.db";
    job_.image_path = dir_ / "images";
    job_.output_path = dir_ / "sparse";
    job_.log_folder = dir_ / "logs";
    job_.first_round = {{"Mapper.num_threads", "1"}};
    job_.later_rounds = {{"Mapper.num_threads", "1"}, {"Mapper.min_model_size", "4"}};
    job_.lens = LensRule::kLeaveToMapper;
    // Without matches: nothing contradicts a pose.
    ColmapDatabase(job_.database_path, ColmapDatabase::Mode::kCreateIfMissing);
    WriteTinyPictures(survey_, job_.image_path);
    for (const PosedImage& image : survey_.images) job_.pictures.push_back(image.name);
  }

  // Pictures `first` to `last` (from 1) of the survey, all that they see moved by `shift` pixels.
  SparseModel Part(int first, int last, double shift = 0) const {
    SparseModel part = survey_;
    part.images.clear();
    std::set<uint32_t> ids;
    for (PosedImage image : survey_.images) {
      if (static_cast<int>(image.image_id) < first || static_cast<int>(image.image_id) > last) {
        continue;
      }
      for (Eigen::Vector2d& pixel : image.points2D) pixel.x() += shift;
      ids.insert(image.image_id);
      part.images.push_back(image);
    }
    for (auto& [id, point] : part.points3D) {
      std::vector<SparsePoint::TrackElement> track;
      for (const auto& element : point.track) {
        if (ids.count(element.image_id) > 0) track.push_back(element);
      }
      point.track = track;
    }
    return part;
  }

  // Its first points alone.
  static SparseModel OfFewPoints(SparseModel model, uint64_t num_points) {
    model.points3D.erase(model.points3D.upper_bound(num_points), model.points3D.end());
    for (PosedImage& image : model.images) {
      for (uint64_t& id : image.point3D_ids) {
        if (id != kNoPoint3D && id > num_points) id = kNoPoint3D;
      }
    }
    return model;
  }

  void Run() { RunMapper(colmap_.Program(), job_); }

  // Names of the pictures of a model of the result.
  std::set<std::string> NamesIn(const std::string& model) const {
    std::set<std::string> names;
    for (const PosedImage& image : ReadSparseModel(job_.output_path / model).images) {
      names.insert(image.name);
    }
    return names;
  }

  size_t NumModels() const { return ListModels(job_.output_path).size(); }

  TempDir dir_;
  ScriptedColmap colmap_{dir_ / "bin"};
  const SparseModel survey_ = ExactSurvey(ExactLens(), 5);
  MapperJob job_;
};

TEST_F(RunMapperTest, OneRoundThatFindsAll) {
  colmap_.Leaves(kMapper, 1, "0", survey_);
  Run();
  EXPECT_EQ(colmap_.NumCalls(kMapper), 1);
  EXPECT_EQ(NumModels(), 1u);
  EXPECT_EQ(NamesIn("0").size(), 10u);
  EXPECT_TRUE(fs::exists(dir_ / "logs" / "mapper_1.log"));
  // All pictures: no list. The folder is the trial's own.
  EXPECT_EQ(colmap_.Arguments(kMapper, 1),
            (std::vector<std::string>{"mapper", "--database_path", (dir_ / "database.db").string(),
                                      "--image_path", (dir_ / "images").string(), "--output_path",
                                      (dir_ / "sparse" / "trial_1").string(),
                                      "--Mapper.num_threads", "1"}));
  // Nothing else is left beside the model.
  for (const auto& entry : fs::directory_iterator(job_.output_path)) {
    EXPECT_EQ(entry.path().filename(), "0");
  }
}

TEST_F(RunMapperTest, LeftoversOfEarlierRunsAreRemoved) {
  WriteSparseModelBinary(dir_ / "sparse" / "7", survey_);
  WriteSparseModelBinary(dir_ / "sparse" / "trial_1" / "3", survey_);
  colmap_.Leaves(kMapper, 1, "0", survey_);
  Run();
  EXPECT_EQ(NumModels(), 1u);
  EXPECT_FALSE(fs::exists(job_.output_path / "7"));
}

TEST_F(RunMapperTest, AModelIsContinuedAndWhatItTakesIsTaken) {
  colmap_.SetHelp(MapperHelp(
      "3.8", {"Mapper.num_threads", "Mapper.fix_existing_images", kRefineFocal, kRefine}));
  WriteSparseModelBinary(dir_ / "before", Part(1, 6));
  WriteSurveyDatabase(survey_, dir_ / "survey.db");
  job_.database_path = dir_ / "survey.db";
  job_.continued_model = dir_ / "before";
  job_.lens = LensRule::kFind;
  colmap_.Leaves(kMapper, 1, "", Part(1, 9));  // the tenth is left over
  Run();
  EXPECT_EQ(colmap_.Value(kMapper, 1, "input_path"), (job_.output_path / "trial_part").string());
  EXPECT_EQ(colmap_.Value(kMapper, 1, "Mapper.fix_existing_images"), "1");
  EXPECT_EQ(colmap_.Value(kMapper, 1, kRefineFocal), "0");
  EXPECT_EQ(colmap_.NumCalls(kMapper), 1);  // one alone makes no further round
  EXPECT_EQ(NumModels(), 1u);
  EXPECT_EQ(NamesIn("0").size(), 9u);
  for (const auto& entry : fs::directory_iterator(job_.output_path / "0")) {
    EXPECT_TRUE(IsModelFile(entry.path().filename().string())) << entry.path();
  }
  // A mapper that fails at it is asked for all anew.
  colmap_.Ends(kMapper, 2, "cannot", 1);
  colmap_.Leaves(kMapper, 3, "0", survey_);
  Run();
  EXPECT_EQ(colmap_.Value(kMapper, 3, "input_path"), "");
  EXPECT_EQ(NamesIn("0").size(), 10u);
}

TEST_F(RunMapperTest, AModelThatNothingIsTiedToStaysAsItIs) {
  colmap_.SetHelp(MapperHelp(
      "3.8", {"Mapper.num_threads", "Mapper.fix_existing_images", kRefineFocal, kRefine}));
  WriteSparseModelBinary(dir_ / "before", Part(1, 6));
  SparseModel apart = survey_;
  for (auto& [id, point] : apart.points3D) {
    std::vector<SparsePoint::TrackElement> track;
    for (const auto& element : point.track) {
      if ((element.image_id <= 6) == (point.track[0].image_id <= 6)) track.push_back(element);
    }
    point.track = track;
  }
  WriteSurveyDatabase(apart, dir_ / "apart.db");
  job_.database_path = dir_ / "apart.db";
  job_.continued_model = dir_ / "before";
  job_.lens = LensRule::kLeaveToMapper;
  colmap_.Leaves(kMapper, 1, "0", Part(7, 10));
  Run();
  EXPECT_EQ(colmap_.Value(kMapper, 1, "input_path"), "");
  EXPECT_EQ(colmap_.ImageList(kMapper, 1), "img10.jpg\nimg7.jpg\nimg8.jpg\nimg9.jpg\n");
  EXPECT_EQ(NumModels(), 2u);
  for (const std::string file : {"images.bin", "points3D.bin"}) {
    EXPECT_TRUE(ReadBytes(job_.output_path / "0" / file) == ReadBytes(dir_ / "before" / file));
  }
  EXPECT_EQ(NamesIn("1").size(), 4u);
}

TEST_F(RunMapperTest, LaterRoundsLookForTheMissingAndNumberTheirModelsOn) {
  colmap_.Leaves(kMapper, 1, "0", Part(1, 4));
  colmap_.Leaves(kMapper, 2, "0", Part(5, 7));
  colmap_.Leaves(kMapper, 3, "0", Part(8, 10));
  Run();
  EXPECT_EQ(colmap_.NumCalls(kMapper), 3);
  EXPECT_EQ(colmap_.ImageList(kMapper, 1), "");
  EXPECT_EQ(colmap_.ImageList(kMapper, 2),
            "img10.jpg\nimg5.jpg\nimg6.jpg\nimg7.jpg\nimg8.jpg\nimg9.jpg\n");
  EXPECT_EQ(colmap_.ImageList(kMapper, 3), "img10.jpg\nimg8.jpg\nimg9.jpg\n");
  EXPECT_EQ(colmap_.Value(kMapper, 1, "Mapper.min_model_size"), "");
  EXPECT_EQ(colmap_.Value(kMapper, 2, "Mapper.min_model_size"), "4");
  EXPECT_EQ(NumModels(), 3u);
  EXPECT_EQ(NamesIn("0"), (std::set<std::string>{"img1.jpg", "img2.jpg", "img3.jpg", "img4.jpg"}));
  EXPECT_EQ(NamesIn("1"), (std::set<std::string>{"img5.jpg", "img6.jpg", "img7.jpg"}));
  EXPECT_EQ(NamesIn("2"), (std::set<std::string>{"img10.jpg", "img8.jpg", "img9.jpg"}));
}

TEST_F(RunMapperTest, ARoundThatFindsNothingIsTheLast) {
  colmap_.Leaves(kMapper, 1, "0", Part(1, 5));
  Run();
  EXPECT_EQ(colmap_.NumCalls(kMapper), 2);
  EXPECT_EQ(NumModels(), 1u);
}

TEST_F(RunMapperTest, TwoMissingPicturesAreNotWorthARound) {
  colmap_.Leaves(kMapper, 1, "0", Part(1, 8));
  Run();
  EXPECT_EQ(colmap_.NumCalls(kMapper), 1);
}

TEST_F(RunMapperTest, NoMoreThanFiveRounds) {
  for (int call = 1; call <= 7; ++call) colmap_.Leaves(kMapper, call, "0", Part(call, call));
  Run();
  EXPECT_EQ(colmap_.NumCalls(kMapper), 5);
  EXPECT_EQ(NumModels(), 5u);
}

TEST_F(RunMapperTest, AllModelsOfARoundCountButThoseOfAHandfulOfPoints) {
  colmap_.Leaves(kMapper, 1, "0", Part(1, 5));
  colmap_.Leaves(kMapper, 1, "1", OfFewPoints(Part(6, 8), 49));
  colmap_.Leaves(kMapper, 1, "10", Part(6, 10));
  Run();
  EXPECT_EQ(NumModels(), 2u);
  EXPECT_EQ(NamesIn("1").size(), 5u);
  EXPECT_EQ(colmap_.NumCalls(kMapper), 1);
}

TEST_F(RunMapperTest, FirstAttemptsThatALargerModelHoldsAreNoModels) {
  colmap_.Leaves(kMapper, 1, "0", Part(1, 3));
  colmap_.Leaves(kMapper, 1, "1", Part(6, 8));
  colmap_.Leaves(kMapper, 1, "2", Part(1, 7));  // all of the first, two of the second
  colmap_.Leaves(kMapper, 1, "3", Part(8, 10));
  Run();
  EXPECT_EQ(NumModels(), 2u);
  EXPECT_EQ(NamesIn("0").size(), 7u);
  EXPECT_EQ(NamesIn("1"), (std::set<std::string>{"img10.jpg", "img8.jpg", "img9.jpg"}));
}

TEST_F(RunMapperTest, AModelOfThreePicturesIsFoundInTheFirstRound) {
  colmap_.Leaves(kMapper, 1, "0", Part(1, 3));
  Run();
  EXPECT_EQ(colmap_.NumCalls(kMapper), 2);  // the other one for those that are missing
  EXPECT_EQ(NamesIn("0").size(), 3u);
}

TEST_F(RunMapperTest, NoModelAtAllIsAnErrorThatNamesTheLog) {
  colmap_.Ends(kMapper, 1, "ERROR: failed to create sparse model", 1);
  const std::string text = ErrorOf([&] { Run(); });
  EXPECT_NE(text.find("the mapper found no model"), std::string::npos) << text;
  EXPECT_NE(text.find((dir_ / "logs" / "mapper_1.log").string()), std::string::npos) << text;
  EXPECT_EQ(NumModels(), 0u);
}

TEST_F(RunMapperTest, AMapperThatFailsWithAModelIsNotTrusted) {
  colmap_.Leaves(kMapper, 1, "0", survey_);
  colmap_.Ends(kMapper, 1, "disk full", 2);
  const std::string text = ErrorOf([&] { Run(); });
  EXPECT_NE(text.find("the mapper failed (exit code 2, 'disk full')"), std::string::npos) << text;
  EXPECT_EQ(NumModels(), 0u);
}

TEST_F(RunMapperTest, AFailureInALaterRoundLeavesWhatWasFound) {
  colmap_.Leaves(kMapper, 1, "0", Part(1, 5));
  colmap_.Leaves(kMapper, 2, "0", Part(6, 10));
  colmap_.Ends(kMapper, 2, "disk full", 2);
  testing::internal::CaptureStderr();
  Run();
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("the mapper failed (exit code 2, 'disk full')"), std::string::npos) << said;
  EXPECT_EQ(NumModels(), 1u);
}

TEST_F(RunMapperTest, ARefusedValueIsAFaultOfTheCommandLine) {
  colmap_.Ends(kMapper, 1, "ERROR: Failed to parse options - the argument ('x') is invalid", 1);
  EXPECT_THROW(Run(), UsageError);
  colmap_.Ends(kMapper, 2, "Invalid options provided.", 1);
  EXPECT_THROW(Run(), UsageError);
}

// The last lines of COLMAP 4.2.1, in colours, where it refuses a value, finds no model, and aborts.
constexpr char kRefusalOf4[] =
    "\033[0;31mE20261129 07:30:58.297910  3310 base_option_manager.cc:265] Failed to parse options "
    "- "
    "the argument ('x') for option '--Mapper.min_model_size' is invalid.\n\033[m";
constexpr char kNoModelOf4[] =
    "I20261129 07:34:07.646431 22084 timer.cc:90] Elapsed time: 0.001 [minutes]\n"
    "\033[0;31mE20261129 07:34:07.646452 22084 sfm.cc:310] Failed to create any sparse "
    "model\n\033[m";
constexpr char kAbortOf4[] =
    "  what():  No registered database factory succeeded.\n"
    "*** Aborted at 1795937483 (unix time) try \"date -d @1795937483\" if you are using GNU date "
    "***\n"
    "PC: @                0x0 (unknown)\n"
    "    @     0x55ff087e9bd1 (unknown)";

TEST_F(RunMapperTest, EndingsOfColmap4AreUnderstood) {
  colmap_.Ends(kMapper, 1, kRefusalOf4, 1);
  EXPECT_THROW(Run(), UsageError);
  for (const int call : {2, 3}) colmap_.Ends(kMapper, call, kNoModelOf4, 1);  // both rounds
  const std::string none = ErrorOf([&] { Run(); });
  EXPECT_NE(
      none.find("the mapper found no model (exit code 1, 'Failed to create any sparse model')"),
      std::string::npos)
      << none;
  colmap_.Ends(kMapper, 4, kAbortOf4, 134);
  const std::string aborted = ErrorOf([&] { Run(); });
  EXPECT_NE(aborted.find("'what():  No registered database factory succeeded.'"), std::string::npos)
      << aborted;
}

// In 4.2 the list of pictures is an option of each mapper's own, and the common one is refused.
TEST_F(RunMapperTest, PicturesAreListedUnderTheNameThatThisVersionKnows) {
  std::string help = MapperHelp("COLMAP 4.2.1 (scripted)", {"Mapper.num_threads"});
  help.replace(help.find("--image_list_path"), 17, "--Mapper.image_list_path");
  colmap_.SetHelp(help);
  colmap_.Leaves(kMapper, 1, "0", Part(1, 6));
  colmap_.Leaves(kMapper, 2, "0", Part(7, 10));
  Run();
  EXPECT_EQ(NumModels(), 2u);
  EXPECT_EQ(colmap_.Value(kMapper, 2, "image_list_path"), "");
  EXPECT_NE(colmap_.Value(kMapper, 2, "Mapper.image_list_path"), "");
  EXPECT_EQ(colmap_.ImageList(kMapper, 2), "img10.jpg\nimg7.jpg\nimg8.jpg\nimg9.jpg\n");
}

TEST_F(RunMapperTest, TheDistortionIsHeldAndThenFreedWherePicturesAreLeftOver) {
  job_.lens = LensRule::kFind;
  colmap_.Leaves(kMapper, 1, "0", Part(1, 6));
  colmap_.Leaves(kMapper, 2, "0", survey_);
  Run();
  ASSERT_EQ(colmap_.NumCalls(kMapper), 2);
  EXPECT_EQ(colmap_.Value(kMapper, 1, kRefine), "0");
  EXPECT_EQ(colmap_.Value(kMapper, 2, kRefine), "");
  EXPECT_EQ(NumModels(), 1u);
  EXPECT_EQ(NamesIn("0").size(), 10u);
  EXPECT_TRUE(fs::exists(dir_ / "logs" / "mapper_1_free_distortion.log"));
  // The triangulator gets the trial's own options.
  EXPECT_EQ(colmap_.Value("point_triangulator", 1, kRefine), "0");
  EXPECT_EQ(colmap_.Value("point_triangulator", 2, kRefine), "");
}

TEST_F(RunMapperTest, OfTwoTrialsTheOneWithMorePicturesCounts) {
  job_.lens = LensRule::kFind;
  colmap_.Leaves(kMapper, 1, "0", Part(1, 9, 1.0));  // the worse error does not matter
  colmap_.Leaves(kMapper, 2, "0", Part(1, 8));
  Run();
  EXPECT_EQ(NamesIn("0").size(), 9u);
}

TEST_F(RunMapperTest, PicturesThatStandWrongAreBroughtBackAndCount) {
  fs::remove(job_.database_path);
  WriteSurveyDatabase(survey_, job_.database_path);
  job_.lens = LensRule::kFind;
  // All pictures, of which four stand where none of their matches put them, with a free distortion.
  SparseModel torn = Part(1, 10);
  for (size_t i = 6; i < 10; ++i) {
    for (uint64_t& id : torn.images[i].point3D_ids) id = kNoPoint3D;
    torn.images[i].cam_from_world.translation += Eigen::Vector3d(0.4, 0.4 * double(i), 1);
  }
  for (auto& [id, point] : torn.points3D) {
    point.track.erase(std::remove_if(point.track.begin(), point.track.end(),
                                     [](const auto& e) { return e.image_id > 6; }),
                      point.track.end());
  }
  colmap_.Leaves(kMapper, 1, "0", Part(1, 8));
  colmap_.Leaves(kMapper, 2, "0", torn);
  Run();
  EXPECT_EQ(NamesIn("0").size(), 10u);
}

TEST_F(RunMapperTest, ATriangulationThatFailsOnAJoinedModelIsAnError) {
  fs::remove(job_.database_path);
  WriteSurveyDatabase(survey_, job_.database_path);
  job_.lens = LensRule::kFind;
  colmap_.Leaves(kMapper, 1, "0", Part(1, 5));
  colmap_.Leaves(kMapper, 1, "1", Part(6, 10));
  colmap_.Ends("point_triangulator", 3, "No space left on device", 1);
  const std::string text = ErrorOf([&] { Run(); });
  EXPECT_NE(text.find("lens_joined_0_triangulation.log"), std::string::npos) << text;
}

TEST_F(RunMapperTest, OfTrialsWithAsManyPicturesTheSmallerErrorCounts) {
  job_.lens = LensRule::kFind;
  SparseModel noisy = Part(1, 9);
  for (PosedImage& image : noisy.images) {
    for (size_t i = 0; i < image.points2D.size(); ++i) {
      image.points2D[i].y() += i % 2 == 0 ? 1 : -1;
    }
  }
  colmap_.Leaves(kMapper, 1, "0", noisy);
  colmap_.Leaves(kMapper, 2, "0", Part(1, 9));
  Run();
  EXPECT_LT(ReadSparseModel(job_.output_path / "0").points3D.at(1).error, 0.01);
}

TEST_F(RunMapperTest, ALensThatIsNotSoundIsDoubtfulToo) {
  job_.lens = LensRule::kFind;
  Camera lens = ExactLens();
  lens.params[2] += 90;  // farther from the centre than an adjustment may find it
  colmap_.Leaves(kMapper, 1, "0", Disturbed(ExactSurvey(lens, 5)));
  colmap_.Leaves(kMapper, 2, "0", survey_);
  Run();
  ASSERT_EQ(colmap_.NumCalls(kMapper), 2);
  EXPECT_LT(LargestDifference(ReadSparseModel(job_.output_path / "0").cameras.at(1), ExactLens()),
            0.01);
}

// Where nothing is known of the lens, the guess may be too far off: another one is tried, and a
// lens that is sound counts among as many pictures, whatever the errors.
TEST_F(RunMapperTest, AWideLensIsTriedWhereNothingIsKnownOfIt) {
  job_.lens = LensRule::kFind;
  colmap_.SetHelp(MapperHelp("COLMAP 3.8", {"Mapper.num_threads", kRefine, kRefineFocal}));
  {
    ColmapDatabase database(job_.database_path, ColmapDatabase::Mode::kReadWrite);
    AddCamera(&database, ExactLens());
    database.Finish();
  }
  Camera lens = ExactLens();
  lens.params[2] += 90;
  colmap_.Leaves(kMapper, 1, "0", Disturbed(ExactSurvey(lens, 5)));
  colmap_.Leaves(kMapper, 2, "0", survey_);
  Run();
  ASSERT_EQ(colmap_.NumCalls(kMapper), 2);
  EXPECT_NE(colmap_.Value(kMapper, 1, kRefineFocal), "0");
  EXPECT_EQ(colmap_.Value(kMapper, 2, kRefineFocal), "0");
  EXPECT_EQ(fs::path(colmap_.Value(kMapper, 2, "database_path")).filename(), "wide_lens.db");
  EXPECT_LT(LargestDifference(ReadSparseModel(job_.output_path / "0").cameras.at(1), ExactLens()),
            0.01);
}

TEST_F(RunMapperTest, AFailureOfTheSecondTrialLeavesTheFirst) {
  job_.lens = LensRule::kFind;
  colmap_.Leaves(kMapper, 1, "0", Part(1, 9));
  colmap_.Leaves(kMapper, 2, "0", Part(1, 9));
  colmap_.Ends(kMapper, 2, "cannot", 1);
  testing::internal::CaptureStderr();
  Run();
  EXPECT_NE(testing::internal::GetCapturedStderr().find("cannot"), std::string::npos);
  EXPECT_EQ(NamesIn("0").size(), 9u);
}

// With the memory that there is the next time it may be the better one.
TEST_F(RunMapperTest, ASecondTrialWithoutMemoryEndsTheRun) {
  job_.lens = LensRule::kFind;
  colmap_.Leaves(kMapper, 1, "0", Part(1, 9));
  colmap_.Ends(kMapper, 2, "out of memory", 1);
  EXPECT_ERROR(Run(), "there was no memory for it");
}

TEST_F(RunMapperTest, WhereASmallModelLeavesPicturesOverColmapBeginsAFewTimesAnew) {
  colmap_.SetHelp(MapperHelp("COLMAP 3.8", {"Mapper.min_model_size", "Mapper.init_num_trials"}));
  job_.lens = LensRule::kFind;
  colmap_.Leaves(kMapper, 1, "0", Part(1, 4));
  colmap_.Leaves(kMapper, 2, "0", survey_);
  Run();
  ASSERT_EQ(colmap_.NumCalls(kMapper), 2);
  EXPECT_EQ(colmap_.Value(kMapper, 2, "Mapper.min_model_size"), "10");
  EXPECT_EQ(colmap_.Value(kMapper, 2, "Mapper.init_num_trials"), "2");
  EXPECT_EQ(NamesIn("0").size(), 10u);
}

// Another model than the next run would find: a full disk is no matter of taste.
TEST_F(RunMapperTest, ATriangulatorThatFailsEndsTheRun) {
  job_.lens = LensRule::kFind;
  colmap_.Leaves(kMapper, 1, "0", survey_);
  colmap_.Ends(kTriangulator, 1, "No space left on device", 1);
  const std::string text = ErrorOf([&] { Run(); });
  EXPECT_NE(text.find("the triangulation failed (exit code 1)"), std::string::npos) << text;
  EXPECT_NE(text.find((dir_ / "logs" / "lens_1_0_triangulation.log").string()), std::string::npos)
      << text;
  EXPECT_NE(text.find("run the same command again"), std::string::npos) << text;
  EXPECT_EQ(NumModels(), 0u);
}

TEST_F(RunMapperTest, ATriangulatorThatFindsNothingEndsNoRun) {
  job_.lens = LensRule::kFind;
  SparseModel nothing = OfFewPoints(survey_, 0);
  colmap_.Leaves(kMapper, 1, "0", survey_);
  colmap_.Leaves(kTriangulator, 1, "", nothing);
  testing::internal::CaptureStderr();
  Run();
  EXPECT_NE(testing::internal::GetCapturedStderr().find("points were lost"), std::string::npos);
  EXPECT_EQ(NamesIn("0").size(), 10u);
}

TEST_F(RunMapperTest, ATriangulatorThatFailsInALaterRoundLeavesWhatWasFound) {
  job_.lens = LensRule::kFind;
  colmap_.SetHelp(MapperHelp("COLMAP 3.8", {"Mapper.num_threads"}));  // it cannot hold distortion
  colmap_.Leaves(kMapper, 1, "0", Part(1, 5));
  colmap_.Leaves(kMapper, 2, "0", Part(6, 10));
  colmap_.Ends(kTriangulator, 2, "cannot", 3);
  testing::internal::CaptureStderr();
  Run();
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("the triangulation failed (exit code 3)"), std::string::npos) << said;
  EXPECT_EQ(NumModels(), 1u);
  EXPECT_EQ(NamesIn("0").size(), 5u);
}

TEST_F(RunMapperTest, AGivenLensIsHeldByAll) {
  job_.lens = LensRule::kHold;
  colmap_.SetHelp(MapperHelp("COLMAP 3.8", {"Mapper.num_threads", kRefine, kRefineFocal}));
  SparseModel start = Disturbed(survey_);
  start.cameras = survey_.cameras;
  colmap_.Leaves(kMapper, 1, "0", start);
  Run();
  EXPECT_EQ(colmap_.NumCalls(kMapper), 1);
  EXPECT_EQ(colmap_.Value(kMapper, 1, kRefine), "0");
  EXPECT_EQ(colmap_.Value(kMapper, 1, kRefineFocal), "0");
  EXPECT_EQ(colmap_.NumCalls(kTriangulator), 1);
  const SparseModel model = ReadSparseModel(job_.output_path / "0");
  EXPECT_EQ(model.cameras.at(1).params, survey_.cameras.at(1).params);
  EXPECT_LT(ReprojectionError(model), 1e-3);
}

// All trials hold it: none of them is there to free it.
TEST_F(RunMapperTest, AGivenLensIsNotFreedWherePicturesAreLeftOver) {
  job_.lens = LensRule::kHold;
  colmap_.SetHelp(MapperHelp(
      "COLMAP 3.8", {"Mapper.min_model_size", "Mapper.init_num_trials", kRefine, kRefineFocal}));
  colmap_.Leaves(kMapper, 1, "0", Part(1, 6));
  colmap_.Leaves(kMapper, 2, "0", Part(1, 8));
  Run();
  ASSERT_EQ(colmap_.NumCalls(kMapper), 2);
  for (const int call : {1, 2}) EXPECT_EQ(colmap_.Value(kMapper, call, kRefineFocal), "0");
  EXPECT_EQ(colmap_.Value(kMapper, 2, "Mapper.min_model_size"), "10");
}

class InitialPairRound : public RunMapperTest {
 protected:
  InitialPairRound() { job_.initial_pair_round = MapperOptions{{"Mapper.init_image_id1", "7"}}; }
};

TEST_F(InitialPairRound, ThatFindsAllIsEnough) {
  colmap_.Leaves(kMapper, 1, "0", survey_);
  Run();
  EXPECT_EQ(colmap_.NumCalls(kMapper), 1);
  EXPECT_EQ(colmap_.Value(kMapper, 1, "Mapper.init_image_id1"), "7");
  EXPECT_TRUE(fs::exists(dir_ / "logs" / "mapper_1_initial_pair.log"));
}

TEST_F(InitialPairRound, ThatLeavesPicturesOutIsComparedWithTheMappersOwnChoice) {
  colmap_.Leaves(kMapper, 1, "0", Part(1, 7));
  colmap_.Leaves(kMapper, 2, "0", Part(1, 9));
  Run();
  EXPECT_EQ(colmap_.NumCalls(kMapper), 2);
  EXPECT_EQ(colmap_.Value(kMapper, 2, "Mapper.init_image_id1"), "");
  EXPECT_EQ(NamesIn("0").size(), 9u);
}

TEST_F(InitialPairRound, ThatFailsCostsNothing) {
  colmap_.Ends(kMapper, 1, "Initialization failed", 1);
  colmap_.Leaves(kMapper, 2, "0", survey_);
  Run();
  EXPECT_EQ(NamesIn("0").size(), 10u);
  EXPECT_EQ(NumModels(), 1u);
}

class ThinnedRound : public RunMapperTest {
 protected:
  ThinnedRound() {
    WriteSurveyDatabase(survey_, job_.database_path);
    job_.thins_matches = true;
    job_.lens = LensRule::kFind;
  }
};

TEST_F(ThinnedRound, ThatFindsAllIsEnough) {
  colmap_.Leaves(kMapper, 1, "0", Disturbed(survey_));
  Run();
  ASSERT_EQ(colmap_.NumCalls(kMapper), 1);
  EXPECT_NE(colmap_.Value(kMapper, 1, "database_path"), job_.database_path.string());
  EXPECT_TRUE(fs::exists(dir_ / "logs" / "mapper_1_thinned.log"));
  // The points come from all matches.
  EXPECT_EQ(colmap_.Value("point_triangulator", 1, "database_path"), job_.database_path.string());
  EXPECT_EQ(NamesIn("0").size(), 10u);
  EXPECT_FALSE(fs::exists(job_.output_path / "trial_thinned"));
}

TEST_F(ThinnedRound, ThatLeavesPicturesOutIsComparedWithAllMatches) {
  colmap_.Leaves(kMapper, 1, "0", Part(1, 7));
  colmap_.Leaves(kMapper, 2, "0", survey_);
  Run();
  EXPECT_EQ(colmap_.Value(kMapper, 2, "database_path"), job_.database_path.string());
  EXPECT_EQ(NamesIn("0").size(), 10u);
}

TEST_F(ThinnedRound, ThatFindsNothingCostsNothing) {
  colmap_.Ends(kMapper, 1, "ERROR: failed to create sparse model", 1);
  colmap_.Leaves(kMapper, 2, "0", survey_);
  Run();
  EXPECT_EQ(NamesIn("0").size(), 10u);
}

// The next run, on a disk with room, would find other models.
TEST_F(ThinnedRound, ThatFailsEndsTheRun) {
  colmap_.Ends(kMapper, 1, "No space left on device", 1);
  colmap_.Leaves(kMapper, 2, "0", survey_);
  EXPECT_THROW(Run(), Error);
  EXPECT_EQ(colmap_.NumCalls(kMapper), 1);
}

class GlobalRound : public RunMapperTest {
 protected:
  GlobalRound() {
    colmap_.SetHelp(MapperHelp("COLMAP 4.0 (scripted)", {"Mapper.num_threads"}),
                    "  global_mapper\n  mapper\n", "  --GlobalMapper.num_threads arg (=-1)\n");
    job_.global_round = MapperOptions{{"GlobalMapper.num_threads", "1"}};
  }
};

TEST_F(GlobalRound, ThatFindsAllIsEnough) {
  colmap_.Leaves(kGlobal, 1, "0", survey_);
  Run();
  EXPECT_EQ(colmap_.NumCalls(kMapper), 0);
  EXPECT_EQ(colmap_.Value(kGlobal, 1, "GlobalMapper.num_threads"), "1");
  EXPECT_EQ(colmap_.Value(kGlobal, 1, "Mapper.num_threads"), "");
  EXPECT_TRUE(fs::exists(dir_ / "logs" / "mapper_1_global.log"));
}

TEST_F(GlobalRound, ThatLeavesPicturesOutIsComparedWithTheFirstRound) {
  colmap_.Leaves(kGlobal, 1, "0", Part(1, 8));
  colmap_.Leaves(kMapper, 1, "0", Part(1, 6));
  Run();
  EXPECT_EQ(colmap_.NumCalls(kMapper), 1);
  EXPECT_EQ(NamesIn("0").size(), 8u);
}

TEST_F(GlobalRound, ThatIsWorseGivesWay) {
  colmap_.Leaves(kGlobal, 1, "0", Part(1, 8));
  colmap_.Leaves(kMapper, 1, "0", survey_);
  Run();
  EXPECT_EQ(NamesIn("0").size(), 10u);
  EXPECT_EQ(NumModels(), 1u);
}

TEST_F(GlobalRound, ThatFailsCostsNothing) {
  colmap_.Ends(kGlobal, 1, "no", 1);
  colmap_.Leaves(kMapper, 1, "0", survey_);
  Run();
  EXPECT_EQ(NamesIn("0").size(), 10u);
}

// Another mapper would find another model, and the next run this one.
TEST_F(GlobalRound, ThatIsKilledEndsTheRun) {
  colmap_.IsKilled(kGlobal, 1);
  colmap_.Ends(kGlobal, 2, "terminate called after throwing an instance of 'std::bad_alloc'", 134);
  colmap_.Ends(kGlobal, 3, "", 137);
  colmap_.Leaves(kMapper, 1, "0", survey_);
  for (const char* cause :
       {"killed by signal 9 (Killed), ''): the system ended it for want of memory",
        "there was no memory for it", "the system ended it for want of memory"}) {
    const std::string text = ErrorOf([&] { Run(); });
    EXPECT_NE(text.find(cause), std::string::npos) << text;
    EXPECT_NE(text.find("close other programs and run the same command again"), std::string::npos)
        << text;
    EXPECT_NE(text.find("mapper_1_global.log"), std::string::npos) << text;
  }
  EXPECT_EQ(colmap_.NumCalls(kMapper), 0);
}

TEST_F(RunMapperTest, AKilledTriangulatorEndsTheRunInALaterRoundToo) {
  job_.lens = LensRule::kFind;
  colmap_.SetHelp(MapperHelp("COLMAP 3.8", {"Mapper.num_threads"}));  // it cannot hold distortion
  colmap_.Leaves(kMapper, 1, "0", Part(1, 5));
  colmap_.Leaves(kMapper, 2, "0", Part(6, 10));
  colmap_.IsKilled(kTriangulator, 2);
  const std::string text = ErrorOf([&] { Run(); });
  EXPECT_NE(text.find("the triangulation failed (killed by signal 9"), std::string::npos) << text;
}

TEST(ListModelsTest, InNaturalOrderAndModelsOnly) {
  TempDir dir;
  EXPECT_TRUE(ListModels(dir / "nothing").empty());
  EXPECT_TRUE(ListModels(dir.Path()).empty());
  const SparseModel model = ExactSurvey(ExactLens(), 2);
  for (const char* name : {"10", "2", "0"}) WriteSparseModelBinary(dir / name, model);
  fs::create_directories(dir / "1");
  WriteBytes(dir / "3", "a file");
  EXPECT_EQ(ListModels(dir.Path()), (std::vector<fs::path>{dir / "0", dir / "2", dir / "10"}));
}

}  // namespace
}  // namespace colmap_seapoint
