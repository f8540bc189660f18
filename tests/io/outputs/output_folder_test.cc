#include "colmap_seapoint/io/outputs/output_folder.h"

#include <gtest/gtest.h>

#include <optional>

#include "tests/expect_error.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr char kOption[] = "--output_path";
constexpr char kList[] = ".colmap_seapoint";

class OutputFolderTest : public testing::Test {
 protected:
  OutputFolderTest() { open_.emplace(Out(), kOption); }

  fs::path Out() const { return dir_ / "out"; }
  void Close() { open_.reset(); }
  // A run of its own.
  OutputFolder* Reopen() {
    Close();
    return &open_.emplace(Out(), kOption);
  }

  TempDir dir_;
  std::optional<OutputFolder> open_;
};

TEST_F(OutputFolderTest, WhatWasClaimedIsOursInLaterRuns) {
  open_->Claim({"a.ply", "sub/b.bin"});
  WriteBytes(Out() / "a.ply", "x");
  WriteBytes(Out() / "sub/b.bin", "x");
  const OutputFolder* folder = Reopen();
  EXPECT_TRUE(folder->IsOurs("a.ply"));
  EXPECT_TRUE(folder->IsOurs("sub/b.bin"));
  EXPECT_TRUE(folder->IsOurs("sub"));
  EXPECT_FALSE(folder->IsOurs("su"));
  EXPECT_FALSE(folder->IsOurs("a.ply.vis"));
  EXPECT_FALSE(folder->IsOurs("sub/c"));
  Close();
  EXPECT_EQ(FilesOfOurs(Out()), (std::vector<fs::path>{Out() / "a.ply", Out() / "sub/b.bin"}));
}

TEST_F(OutputFolderTest, WhatIsThereAlreadyIsNotOurs) {
  WriteBytes(Out() / "a.ply", "mine");
  WriteBytes(Out() / "folder/file", "mine");
  fs::create_directory(Out() / "empty");
  EXPECT_ERROR(open_->Claim({"b.ply", "a.ply"}),
               (Out() / "a.ply").string() +
                   ": was not made by colmap_seapoint; choose another --output_path, or move it "
                   "away");
  EXPECT_FALSE(open_->IsOurs("b.ply"));  // all or none
  EXPECT_ERROR(open_->Claim({"folder"}), "folder: was not made by colmap_seapoint");
  open_->Claim({"empty", "folder/another"});
  EXPECT_TRUE(open_->IsOurs("empty"));
}

TEST_F(OutputFolderTest, LinksToFilesAreRefusedEvenWhereOursWere) {
  WriteBytes(dir_ / "precious", "mine");
  open_->Claim({"a.ply"});
  fs::create_symlink(dir_ / "precious", Out() / "a.ply");
  EXPECT_ERROR(open_->Claim({"a.ply"}), "is a link");
  fs::create_symlink(dir_ / "nowhere", Out() / "b.ply");
  EXPECT_ERROR(open_->Claim({"b.ply"}), "is a link");
  // A folder may lie on another disk.
  fs::create_directory(dir_ / "big disk");
  fs::create_directory_symlink(dir_ / "big disk", Out() / "dense");
  EXPECT_NO_THROW(open_->Claim({"dense"}));
}

// Somebody else may take the name next.
TEST_F(OutputFolderTest, ANameIsForgottenWithItsFile) {
  open_->Claim({"a.ply", "b.ply"});
  WriteBytes(Out() / "a.ply", "x");
  WriteBytes(Out() / "b.ply", "x");
  Reopen();
  fs::remove(Out() / "b.ply");
  Reopen();
  WriteBytes(Out() / "b.ply", "mine");
  EXPECT_TRUE(Reopen()->IsOurs("a.ply"));
  EXPECT_ERROR(open_->Claim({"b.ply"}), "was not made by");
}

TEST_F(OutputFolderTest, NothingStaysOfARunThatMadeNothing) {
  open_->Claim({"a.ply"});
  EXPECT_TRUE(fs::exists(Out() / kList));
  Close();
  EXPECT_FALSE(fs::exists(Out()));
  // The user's folder does.
  fs::create_directory(Out());
  Reopen()->Claim({"a.ply"});
  Close();
  EXPECT_TRUE(fs::is_empty(Out()));
}

TEST_F(OutputFolderTest, NamesMayHoldAnyByte) {
  const std::vector<std::string> names = {"a\nb", "100%", "%0A", "# x", "\xff\xfe", " blank "};
  open_->Claim(names);
  for (const std::string& name : names) WriteBytes(Out() / name, "x");
  const OutputFolder* folder = Reopen();
  for (const std::string& name : names) EXPECT_TRUE(folder->IsOurs(name)) << name;
  EXPECT_FALSE(folder->IsOurs("a"));
}

TEST_F(OutputFolderTest, AListIsNotBelievedWhatLiesOutside) {
  open_->Claim({"a"});
  WriteBytes(Out() / "a", "x");
  WriteBytes(dir_ / "precious", "mine");
  Close();
  WriteBytes(Out() / kList,
             ReadBytes(Out() / kList) + "../precious\n" + (dir_ / "precious").string() + "\n\n");
  RemoveOurs(Reopen());
  EXPECT_EQ(ReadBytes(dir_ / "precious"), "mine");
  EXPECT_FALSE(fs::exists(Out() / "a"));
}

TEST_F(OutputFolderTest, AListOfSomebodyElsesIsAnError) {
  Close();
  WriteBytes(Out() / kList, "somebody's notes\n");
  EXPECT_ERROR(Reopen(), "is no list of ours");
  EXPECT_EQ(ReadBytes(Out() / kList), "somebody's notes\n");
}

TEST_F(OutputFolderTest, RemovesOursAndLeavesTheRest) {
  open_->Claim({"sparse", "sparse/0/images.bin", "sparse/1/images.bin", "sparsely"});
  for (const char* name :
       {"sparse/0/images.bin", "sparse/1/images.bin", "sparse/0/notes.txt", "sparsely"}) {
    WriteBytes(Out() / name, "x");
  }
  open_->Remove("sparse");
  EXPECT_FALSE(fs::exists(Out() / "sparse/0/images.bin"));
  EXPECT_FALSE(fs::exists(Out() / "sparse/1"));
  EXPECT_TRUE(fs::exists(Out() / "sparse/0/notes.txt"));
  EXPECT_TRUE(fs::exists(Out() / "sparsely"));
  EXPECT_TRUE(open_->IsOurs("sparse"));  // the folder, in which others' files are
  EXPECT_NO_THROW(open_->Claim({"sparse"}));
  RemoveOurs(&*open_);
  EXPECT_FALSE(fs::exists(Out() / "sparsely"));
  EXPECT_TRUE(fs::exists(Out() / "sparse/0/notes.txt"));
}

TEST_F(OutputFolderTest, AdoptsWhatIsThere) {
  WriteBytes(Out() / "a", "x");
  open_->Adopt({"a", "b"});
  EXPECT_TRUE(open_->IsOurs("a"));
  EXPECT_FALSE(open_->IsOurs("b"));
  open_->Claim({"a"});
  EXPECT_TRUE(Reopen()->IsOurs("a"));
}

TEST_F(OutputFolderTest, OneRunAtATime) {
  EXPECT_ERROR(OutputFolder(Out(), kOption), "another run is at work there; wait for it to end");
  // The lock file of a killed run stops nobody.
  Close();
  WriteBytes(Out() / (std::string(kList) + ".lock"), "");
  EXPECT_NO_THROW(Reopen());
}

}  // namespace
}  // namespace colmap_seapoint
