#include "colmap_seapoint/io/files/input_stream.h"

#include <gtest/gtest.h>

#include "tests/expect_error.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

std::string Numbers(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += std::to_string(i) + "\n";
  return text;
}

TEST(InputStream, ReadsAllOfAFile) {
  const TempDir dir;
  for (const int count : {0, 1, 9000, 100000}) {  // less and more than the buffer
    WriteBytes(dir / "a", Numbers(count));
    InputStream stream(dir / "a");
    std::string line;
    int number = 0;
    while (std::getline(stream, line)) EXPECT_EQ(line, std::to_string(number++));
    EXPECT_EQ(number, count);
    EXPECT_TRUE(stream.eof());
    EXPECT_FALSE(stream.bad());
  }
}

TEST(InputStream, TellsAndSeeks) {
  const TempDir dir;
  const std::string text = Numbers(50000);
  WriteBytes(dir / "a", text);
  InputStream stream(dir / "a");
  EXPECT_EQ(stream.tellg(), std::streampos(0));
  std::string part(100000, '\0');
  stream.read(part.data(), 100000);
  EXPECT_EQ(part, text.substr(0, 100000));
  EXPECT_EQ(stream.tellg(), std::streampos(100000));
  stream.seekg(7);
  stream.read(part.data(), 5);
  EXPECT_EQ(part.substr(0, 5), text.substr(7, 5));
  EXPECT_EQ(stream.tellg(), std::streampos(12));
}

TEST(InputStream, SaysWhatTheSystemSaid) {
  const TempDir dir;
  EXPECT_ERROR(InputStream(dir / "absent"), "absent: cannot be read (No such file or directory)");
  EXPECT_ERROR(InputStream(dir.Path()), "cannot be read (Is a directory)");
  EXPECT_EQ(OpenIfThere(dir / "absent"), nullptr);
  EXPECT_EQ(OpenIfThere(dir / "absent" / "too"), nullptr);
  // The system gives no byte at address 0: a file that opens and cannot be read.
  const auto open = OpenIfThere("/proc/self/mem");
  ASSERT_NE(open, nullptr);
  std::string line;
  EXPECT_ERROR(std::getline(*open, line), "/proc/self/mem: cannot be read (Input/output error)");
  EXPECT_ERROR(open->rdbuf()->sgetc(), "Input/output error");
}

}  // namespace
}  // namespace colmap_seapoint
