#include "colmap_seapoint/io/files/content_hash.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

// The reference values of XXH3_64bits with seed 0, from the algorithm's own description.
TEST(ContentHash, IsXxh3) {
  EXPECT_EQ(HashText(""), "xxh3-2d06800538d394c2");
  EXPECT_EQ(HashText("a"), "xxh3-e6c632b61e964e1f");
  EXPECT_EQ(HashText("abc"), "xxh3-78af5f94892f3950");
}

// Databases that version 0.1 wrote hold FNV-1a; its reference values.
TEST(ContentHash, ThatOfVersion01IsKnown) {
  EXPECT_TRUE(IsHashOf("cbf29ce484222325", "", 0));
  EXPECT_TRUE(IsHashOf("85944171f73967e8", "foobar", 6));
  EXPECT_FALSE(IsHashOf("85944171f73967e8", "foobaR", 6));
  EXPECT_TRUE(IsHashOf(HashText("foobar"), "foobar", 6));
  EXPECT_FALSE(IsHashOf(HashText("foobar"), "foobaR", 6));
  EXPECT_FALSE(IsHashOf("", "foobar", 6));
}

TEST(ContentHash, DoesNotDependOnHowTheBytesAreCut) {
  std::string text(3000, ' ');
  for (size_t i = 0; i < text.size(); ++i) text[i] = static_cast<char>(i * 131 + i / 7);
  for (const size_t piece : {size_t{1}, size_t{63}, size_t{64}, size_t{1000}}) {
    ContentHash hash;
    for (size_t i = 0; i < text.size(); i += piece) {
      hash.Add(text.data() + i, std::min(piece, text.size() - i));
    }
    EXPECT_EQ(hash.Text(), HashText(text)) << piece;
  }
}

TEST(ContentHash, OfAFileIsThatOfItsBytes) {
  const TempDir dir;
  WriteBytes(dir / "empty", "");
  WriteBytes(dir / "foobar", "foobar");
  EXPECT_EQ(HashFile(dir / "empty"), HashText(""));
  EXPECT_EQ(HashFile(dir / "foobar"), HashText("foobar"));
  EXPECT_ERROR(HashFile(dir / "missing"), "cannot be read");
}

}  // namespace
}  // namespace colmap_seapoint
