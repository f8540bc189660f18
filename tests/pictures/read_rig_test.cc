#include "colmap_seapoint/pictures/read_rig.h"

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

class ReadRigTest : public testing::Test {
 protected:
  ReadRigTest() {
    model_.cameras[1] = MakeCamera(CameraModel::kPinhole, 8, 8, 6);
    model_.cameras[1].camera_id = 1;
  }

  void AddPicture(const std::string& name, bool in_model = true) {
    std::filesystem::create_directories((dir_ / name).parent_path());
    WriteImage(dir_ / name, GrayImage(8, 6, 1, 50));
    if (!in_model) return;
    PosedImage image;
    image.image_id = static_cast<uint32_t>(model_.images.size() + 1);
    image.camera_id = 1;
    image.name = name;
    model_.images.push_back(image);
  }

  StereoRig Read(const std::string& rig) {
    return ReadRig(rig, dir_.Path().string(), (dir_ / "model").string(), model_);
  }

  TempDir dir_;
  SparseModel model_;
};

TEST(CheckRigTest, LegalValues) {
  for (const char* rig : {"", "none", "left,right", "a/left/,a/right/"}) {
    EXPECT_EQ(CheckRig(rig), "") << rig;
  }
  for (const char* rig : {"left", "left,", ",right", "same,same", "same/,same", "a,b,c",
                          "../left,right", "/left,right"}) {
    EXPECT_NE(CheckRig(rig).find("it must be LEFT,RIGHT"), std::string::npos) << rig;
  }
}

TEST_F(ReadRigTest, PicturesOfTheSameName) {
  AddPicture("right/1.png");
  AddPicture("left/1.png");
  AddPicture("left/2.png");
  AddPicture("right/3.png");
  AddPicture("right/2.png", false);
  const StereoRig rig = Read("left/,right");
  EXPECT_EQ(rig.NumPairs(), 1);
  EXPECT_EQ(rig.right_of, (std::vector<int>{-1, 0, -1, -1}));
  EXPECT_EQ(rig.is_right, (std::vector<uint8_t>{1, 0, 0, 1}));
}

TEST_F(ReadRigTest, PicturesInTheSameOrder) {
  AddPicture("left/L10.png");
  AddPicture("left/L9.png");
  AddPicture("right/L21.png");
  AddPicture("right/L20.png");
  EXPECT_EQ(Read("left,right").right_of, (std::vector<int>{2, 3, -1, -1}));
}

TEST_F(ReadRigTest, NoneMeansNone) {
  AddPicture("left/1.png");
  AddPicture("right/1.png");
  EXPECT_EQ(Read("none").NumPairs(), 0);
  EXPECT_EQ(Read("").NumPairs(), 0);  // the model has no frames
}

TEST_F(ReadRigTest, FoldersThatAreNotThereOrShareNothing) {
  AddPicture("left/a.png");
  EXPECT_ERROR(Read("left,right"), "there is no such folder of pictures");
  EXPECT_ERROR(CheckRigFolders("left,right", dir_.Path().string()), "no such folder");
  AddPicture("right/b.png");
  EXPECT_ERROR(Read("left,right"), "no picture of left (1 pictures) has a simultaneous one");
  CheckRigFolders("none", dir_.Path().string());
  CheckRigFolders("", "/nowhere");
}

TEST_F(ReadRigTest, AModelWithoutBothPicturesIsASequence) {
  AddPicture("left/1.png");
  AddPicture("right/1.png", false);
  testing::internal::CaptureStderr();
  const StereoRig rig = Read("left,right");
  EXPECT_NE(testing::internal::GetCapturedStderr().find("taken as a sequence"), std::string::npos);
  EXPECT_TRUE(rig.right_of.empty());
}

TEST_F(ReadRigTest, DamagedFramesAreAsGoodAsNone) {
  AddPicture("1.png");
  WriteSparseModelBinary(dir_ / "model", model_);
  WriteBytes(dir_ / "model" / "frames.bin", "xx");
  testing::internal::CaptureStderr();
  EXPECT_EQ(Read("").NumPairs(), 0);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("no stereo rig is taken from it"),
            std::string::npos);
}

}  // namespace
}  // namespace colmap_seapoint
