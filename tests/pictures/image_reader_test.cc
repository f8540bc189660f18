#include "colmap_seapoint/pictures/image_reader.h"

#include <exiv2/exiv2.hpp>

#include "tests/io/database_calls.h"
#include "tests/io/test_database.h"

namespace colmap_seapoint {
namespace {

using Names = std::vector<std::string>;

class ImageReaderTest : public testing::Test {
 protected:
  void AddPicture(const std::string& name, int width = 64, int height = 48) {
    std::filesystem::create_directories((dir_ / name).parent_path());
    WriteImage(dir_ / name, GrayImage(width, height, 1, 100));
  }

  using Tags = std::map<std::string, std::string>;
  // A JPEG of a camera whose focal length is known in two ways.
  void AddPictureOf(const std::string& model, const std::string& name, const Tags& others = {},
                    int width = 64, int height = 48) {
    AddPicture(name, width, height);
    Tags tags = {{"Exif.Image.Make", "Sea"},
                 {"Exif.Image.Model", model},
                 {"Exif.Photo.FocalLength", "8/1"},
                 {"Exif.Photo.FocalLengthIn35mmFilm", "28"}};
    for (const auto& [key, value] : others) tags[key] = value;
    const auto image = Exiv2::ImageFactory::open((dir_ / name).string());
    image->readMetadata();
    for (const auto& [key, value] : tags) image->exifData()[key] = value;
    image->writeMetadata();
  }

  // All that one run of feature_extractor does before it looks for SeaPoints.
  std::map<std::string, DatabaseImage> Register() {
    ColmapDatabase database(dir_ / "database.db", ColmapDatabase::Mode::kCreateIfMissing);
    report_ = RunReport();
    const Names names = ListPictures(dir_.Path(), "", &report_);
    RegisterPictures(ReadHeaders(dir_.Path(), names, 2, &report_), options_, &database, &report_);
    cameras_ = ReadCameras(database);
    std::map<std::string, DatabaseImage> images;
    for (const DatabaseImage& image : ReadImages(database)) images[image.name] = image;
    return images;
  }

  TempDir dir_;
  ImageReaderOptions options_;
  RunReport report_;
  std::map<uint32_t, Camera> cameras_;
};

TEST_F(ImageReaderTest, ListsAllPicturesBytewise) {
  for (const char* name : {"b.png", "a10.png", "a2.png", "sub/c.png"}) AddPicture(name);
  WriteBytes(dir_ / "notes.txt", "no picture");
  EXPECT_EQ(ListPictures(dir_.Path(), "", &report_),
            (Names{"a10.png", "a2.png", "b.png", "sub/c.png"}));
  EXPECT_EQ(report_.images_in, 4);
  EXPECT_TRUE(report_.left_out.empty());
}

TEST_F(ImageReaderTest, LinksThatAreNotFollowedAreNamed) {
  AddPicture("sub/a.png");
  std::filesystem::create_directory_symlink(dir_ / "sub", dir_ / "zagain");
  std::filesystem::create_directory_symlink(dir_.Path(), dir_ / "sub/up");
  std::filesystem::create_symlink(dir_ / "unplugged", dir_ / "disk");
  testing::internal::CaptureStderr();
  EXPECT_EQ(ListPictures(dir_.Path(), "", &report_), (Names{"sub/a.png"}));
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("sub/up is a link to a folder that is read anyway"), std::string::npos);
  EXPECT_NE(said.find("zagain is a link to a folder that is read anyway"), std::string::npos);
  ASSERT_EQ(report_.left_out.size(), 1u);
  EXPECT_EQ(report_.left_out[0].name, "disk");
}

TEST_F(ImageReaderTest, ListsTheGivenPicturesOnce) {
  for (const char* name : {"a.png", "b.png", "c.png"}) AddPicture(name);
  WriteBytes(dir_ / "list.txt", "c.png\n# a comment\n\na.png\nc.png\n");
  EXPECT_EQ(ListPictures(dir_.Path(), (dir_ / "list.txt").string(), &report_),
            (Names{"a.png", "c.png"}));
  EXPECT_EQ(report_.images_in, 2);
}

TEST_F(ImageReaderTest, ANewlineInANameLeavesThePictureOut) {
  for (const char* name : {"a.png", "b\nc.png", "d\\e.png"}) AddPicture(name);
  EXPECT_EQ(ListPictures(dir_.Path(), "", &report_), Names{"a.png"});
  EXPECT_EQ(report_.images_in, 3);
  ASSERT_EQ(report_.left_out.size(), 2u);
  EXPECT_EQ(report_.left_out[0].name, "b\nc.png");
  EXPECT_NE(report_.left_out[0].reason.find("control character"), std::string::npos);
}

TEST_F(ImageReaderTest, FaultsOfFolderAndList) {
  EXPECT_ERROR(ListPictures(dir_ / "none", "", &report_), "--image_path");
  EXPECT_ERROR(ListPictures(dir_.Path(), "", &report_), dir_.Path().string());
  WriteBytes(dir_ / "list.txt", "../a.png\n");
  EXPECT_ERROR(ListPictures(dir_.Path(), (dir_ / "list.txt").string(), &report_), "list.txt");
}

TEST_F(ImageReaderTest, UnreadableHeadersAreLeftOut) {
  AddPicture("a.png");
  WriteBytes(dir_ / "zero.png", "");
  WriteBytes(dir_ / "text.jpg", "no picture");
  const auto pictures = ReadHeaders(dir_.Path(), {"a.png", "text.jpg", "zero.png"}, 3, &report_);
  ASSERT_EQ(pictures.size(), 1u);
  EXPECT_EQ(pictures[0].name, "a.png");
  EXPECT_EQ(pictures[0].info.width, 64);
  EXPECT_EQ(pictures[0].info.height, 48);
  ASSERT_EQ(report_.left_out.size(), 2u);
  EXPECT_EQ(report_.left_out[0].name, "text.jpg");
  EXPECT_EQ(report_.left_out[1].name, "zero.png");
  EXPECT_NE(report_.left_out[0].reason, "");
}

TEST_F(ImageReaderTest, PicturesOfOneFolderAndSizeShareACamera) {
  AddPicture("a.png");
  AddPicture("b.png");
  AddPicture("large.png", 128, 96);
  AddPicture("sub/c.png");
  const auto images = Register();
  EXPECT_EQ(cameras_.size(), 3u);
  EXPECT_EQ(images.at("a.png").camera_id, images.at("b.png").camera_id);
  EXPECT_NE(images.at("a.png").camera_id, images.at("large.png").camera_id);
  EXPECT_NE(images.at("a.png").camera_id, images.at("sub/c.png").camera_id);
  EXPECT_EQ(cameras_.at(images.at("large.png").camera_id).width, 128);
}

TEST_F(ImageReaderTest, OneCameraAPicture) {
  options_.single_camera_per_folder = 0;
  AddPicture("a.png");
  AddPicture("b.png");
  Register();
  EXPECT_EQ(cameras_.size(), 2u);
}

TEST_F(ImageReaderTest, OneCameraForAllLeavesOtherSizesOut) {
  options_.single_camera = true;
  AddPicture("a.png");
  AddPicture("large.png", 128, 96);
  AddPicture("sub/c.png");
  const auto images = Register();
  EXPECT_EQ(cameras_.size(), 1u);
  EXPECT_EQ(images.size(), 2u);
  ASSERT_EQ(report_.left_out.size(), 1u);
  EXPECT_EQ(report_.left_out[0].name, "large.png");
  EXPECT_EQ(report_.left_out[0].reason, "is 128x96 but its camera 1 is 64x48");
}

TEST_F(ImageReaderTest, NewCamerasGuessTheirFocalLengthOrTakeWhatIsGiven) {
  options_.default_focal_length_factor = 1.5;
  options_.camera_model = "SIMPLE_RADIAL";
  AddPicture("a.png");
  Register();
  EXPECT_EQ(cameras_.at(1).model, CameraModel::kSimpleRadial);
  EXPECT_EQ(cameras_.at(1).params, (std::vector<double>{96, 32, 24, 0}));
  EXPECT_FALSE(cameras_.at(1).has_prior_focal_length);
  options_.camera_params = "70, 31,23,0.1";
  AddPicture("sub/b.png");
  Register();
  EXPECT_EQ(cameras_.at(1).params[0], 96);  // known cameras stay
  EXPECT_EQ(cameras_.at(2).params, (std::vector<double>{70, 31, 23, 0.1}));
  EXPECT_TRUE(cameras_.at(2).has_prior_focal_length);
}

TEST_F(ImageReaderTest, ACameraIsKnownAgainInTheNextFolder) {
  AddPictureOf("Eye", "DCIM/100GOPRO/a.jpg");
  AddPictureOf("Eye", "DCIM/101GOPRO/a.jpg");
  AddPictureOf("Eye", "DCIM/101GOPRO/zoomed.jpg", {{"Exif.Photo.FocalLength", "9/1"}});
  AddPictureOf("Eye", "DCIM/102GOPRO/large.jpg", {}, 128, 96);
  AddPictureOf("Ear", "DCIM/102GOPRO/other.jpg");
  AddPictureOf("Eye", "spare/a.jpg");
  AddPicture("DCIM/100GOPRO/b.png");
  AddPicture("DCIM/101GOPRO/b.png");
  const auto images = Register();
  EXPECT_EQ(cameras_.size(), 7u);
  EXPECT_EQ(images.at("DCIM/100GOPRO/a.jpg").camera_id, images.at("DCIM/101GOPRO/a.jpg").camera_id);
  ASSERT_EQ(report_.cameras.size(), 7u);
  EXPECT_EQ(report_.cameras[0],
            "camera 1 (Sea Eye, 64x48): 2 pictures in DCIM/100GOPRO, DCIM/101GOPRO; focal length "
            "51 px from EXIF (35 mm equivalent)");
}

TEST_F(ImageReaderTest, ASerialNumberTellsACameraInEveryFolder) {
  AddPictureOf("Eye", "day1/a.jpg", {{"Exif.Photo.BodySerialNumber", "A1234"}});
  AddPictureOf("Eye", "day2/a.jpg", {{"Exif.Photo.BodySerialNumber", "A1234"}});
  AddPictureOf("Eye", "day2/b.jpg", {{"Exif.Photo.BodySerialNumber", "A1235"}});
  const auto images = Register();
  EXPECT_EQ(cameras_.size(), 2u);
  EXPECT_EQ(images.at("day1/a.jpg").camera_id, images.at("day2/a.jpg").camera_id);
}

TEST_F(ImageReaderTest, TheUsersWordOnFoldersCounts) {
  AddPictureOf("Eye", "100GOPRO/a.jpg");
  AddPictureOf("Eye", "101GOPRO/a.jpg");
  options_.single_camera_per_folder = 1;
  Register();
  EXPECT_EQ(cameras_.size(), 2u);
}

TEST_F(ImageReaderTest, WhereTheLensIsFrom) {
  const auto line = [&](const std::string& name) {
    Register();
    EXPECT_EQ(report_.cameras.size(), 1u);
    std::filesystem::remove(dir_ / "database.db");
    std::filesystem::remove(dir_ / name);
    return report_.cameras.front().substr(report_.cameras.front().find(';') + 2);
  };
  AddPicture("a.png");
  EXPECT_EQ(line("a.png"), "focal length 77 px guessed (1.2 x the longer side)");
  options_.camera_preset = "flatport";
  AddPicture("a.png");
  EXPECT_EQ(line("a.png"), "focal length 77 px guessed (1.2 x the longer side)");
  AddPictureOf("Eye", "a.jpg");
  EXPECT_EQ(line("a.jpg"),
            "focal length 68 px from EXIF (35 mm equivalent), seen through a flat port x 1.33");
  EXPECT_NEAR(cameras_.at(1).params[0], 1.333 * 28 / 35 * 64, 1e-9);
  EXPECT_TRUE(cameras_.at(1).has_prior_focal_length);
  // A preset that knows its lens better than EXIF does, and one that does not.
  options_.camera_preset = "gopro_linear_dome";
  AddPictureOf("Eye", "a.jpg");
  EXPECT_EQ(line("a.jpg"),
            "focal length 34 px of the preset gopro_linear_dome, seen through a dome");
  options_.camera_preset = "tg6_flatport";
  AddPictureOf("Eye", "a.jpg");
  EXPECT_NE(line("a.jpg").find("from EXIF"), std::string::npos);
  options_.camera_preset = "";
  options_.camera_params = "70,70,31,23,0,0,0,0";
  AddPictureOf("Eye", "a.jpg");
  EXPECT_EQ(line("a.jpg"),
            "focal length 70 px, as all of the lens from --ImageReader.camera_params");
}

TEST_F(ImageReaderTest, ACameraOfAnEarlierRunIsSaidAsItIs) {
  AddPicture("a.png");
  Register();
  options_.default_focal_length_factor = 2;
  Register();
  ASSERT_EQ(report_.cameras.size(), 1u);
  EXPECT_EQ(report_.cameras[0], "camera 1 (64x48): 1 picture; lens as the database has it");
}

TEST_F(ImageReaderTest, ManyCamerasAreNotAllNamed) {
  options_.single_camera_per_folder = 0;
  for (int i = 0; i < 13; ++i) AddPicture("img" + std::to_string(i) + ".png");
  Register();
  ASSERT_EQ(report_.cameras.size(), 11u);
  EXPECT_EQ(report_.cameras.back(), "and 3 more cameras");
}

TEST_F(ImageReaderTest, AddingPicturesChangesNoId) {
  AddPicture("m.png");
  AddPicture("n.png");
  const auto before = Register();
  AddPicture("a.png");
  const auto after = Register();
  EXPECT_EQ(after.size(), 3u);
  for (const auto& [name, image] : before) {
    EXPECT_EQ(after.at(name).image_id, image.image_id);
    EXPECT_EQ(after.at(name).camera_id, image.camera_id);
  }
  EXPECT_EQ(after.at("a.png").camera_id, before.at("m.png").camera_id);
}

TEST_F(ImageReaderTest, APictureThatWasReplacedByAnotherSizeIsLeftOut) {
  AddPicture("a.png");
  AddPicture("b.png");
  Register();
  AddPicture("b.png", 100, 48);
  Register();
  ASSERT_EQ(report_.left_out.size(), 1u);
  EXPECT_EQ(report_.left_out[0].reason, "is 100x48 but its camera 1 is 64x48");
}

TEST(ImageReaderOptionsTest, Check) {
  ImageReaderOptions options;
  EXPECT_EQ(options.Check(), "");
  options.camera_params = "900,900,500,375,0,0,0,0";
  EXPECT_EQ(options.Check(), "");
  for (const char* params : {"900", "900,900,500,375,0,0,0,x", "1,2,3,4,5,6,7,8,9", "1,,3"}) {
    options.camera_params = params;
    EXPECT_NE(options.Check().find("must be 8 numbers separated by commas for OPENCV"),
              std::string::npos)
        << params;
  }
  options.camera_params = "900,900,500,375,0,0,0,0";
  options.camera_preset = "flatport";
  EXPECT_NE(options.Check().find("cannot be given together"), std::string::npos);
  options.camera_params = "";
  EXPECT_EQ(options.Check(), "");
  options.camera_preset = "flatpart";
  EXPECT_NE(options.Check().find("the nearest are flatport"), std::string::npos);
  options.camera_preset = "";
  options.camera_model = "PINHOLE4";
  EXPECT_NE(options.Check().find("--ImageReader.camera_model PINHOLE4: must be one of "),
            std::string::npos);
}

}  // namespace
}  // namespace colmap_seapoint
