// Lines as COLMAP 3.8, 3.10 and 4.2.1 of Debian's packages printed them.
#include "colmap_seapoint/mapping/colmap_log.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "colmap_seapoint/base/error.h"
#include "tests/expect_error.h"

namespace colmap_seapoint {
namespace {

TEST(MessageOfTest, TheSameOfEveryVersion) {
  EXPECT_EQ(MessageOf("COLMAP 3.8 (Commit Unknown on Unknown without CUDA)"),
            "COLMAP 3.8 (Commit Unknown on Unknown without CUDA)");
  EXPECT_EQ(MessageOf("I20261129 07:24:37.251585 12325 option_manager.cc:847] COLMAP 3.10-dev "
                      "(Commit Unknown on Unknown without CUDA)"),
            "COLMAP 3.10-dev (Commit Unknown on Unknown without CUDA)");
  EXPECT_EQ(
      MessageOf("I20261129 07:26:52.421883 17465 option_manager.cc:1319] COLMAP 4.2.1 (Commit "
                "Unknown on Unknown without GPU support, std hash maps)"),
      "COLMAP 4.2.1 (Commit Unknown on Unknown without GPU support, std hash maps)");
}

TEST(MessageOfTest, WithoutColorsAlsoOfTheLineBefore) {
  EXPECT_EQ(MessageOf("\033[0;31mE20261129 07:34:07.646452 22084 sfm.cc:310] Failed to create any "
                      "sparse model"),
            "Failed to create any sparse model");
  EXPECT_EQ(MessageOf("\033[m\033[0;33mW20261129 07:32:28.686106 12861 database.cc:53] Failed to "
                      "open database"),
            "Failed to open database");
  EXPECT_EQ(MessageOf("\033[m"), "");
  EXPECT_EQ(MessageOf("\033"), "");
  EXPECT_EQ(MessageOf("\033[0;31"), "");
}

TEST(MessageOfTest, NothingOfAStackTrace) {
  for (const char* line :
       {"*** Aborted at 1795937411 (unix time) try \"date -d @1795937411\" if you are using GNU "
        "date ***",
        "PC: @                0x0 (unknown)",
        "*** SIGABRT (@0x6f6b) received by PID 28523 (TID 0x7fc1c7bdaa00) from PID 28523; stack "
        "trace: ***",
        "    @     0x7fc1cbe34ac abort", "    @     0x7fc1cc0a15e9 std::terminate()"}) {
    EXPECT_EQ(MessageOf(line), "") << line;
  }
  EXPECT_EQ(MessageOf("  what():  [database.cc:1084] SQLite error: SQL logic error"),
            "what():  [database.cc:1084] SQLite error: SQL logic error");
}

TEST(MessageOfTest, WhatOnlyLooksLikeAMarkStays) {
  for (const char* line : {"Images 20261129 ] a", "I2026112 07:24 a.cc:1] b", "I20261129", "E",
                           "X20261129 07:24:37.251585 12325 a.cc:847] b"}) {
    EXPECT_EQ(MessageOf(line), line);
  }
  EXPECT_EQ(MessageOf("I20261129 07:24:37 cut off"), "");
  EXPECT_EQ(MessageOf(" \t\r"), "");
  EXPECT_EQ(MessageOf(""), "");
}

TEST(SaysThatThereIsNoModelTest, InEachVersionsWords) {
  EXPECT_TRUE(SaysThatThereIsNoModel("ERROR: failed to create sparse model"));  // 3.8
  EXPECT_TRUE(SaysThatThereIsNoModel("failed to create sparse model"));         // 3.10
  EXPECT_TRUE(SaysThatThereIsNoModel("Failed to create any sparse model"));     // 4.2.1 mapper
  EXPECT_TRUE(SaysThatThereIsNoModel("Failed to create sparse model"));         // its global_mapper
  EXPECT_FALSE(SaysThatThereIsNoModel("No images with matches found in the database"));
}

TEST(SaysThatMemoryRanOutTest, InTheWordsOfThoseThatAskForIt) {
  EXPECT_TRUE(SaysThatMemoryRanOut("what():  std::bad_alloc"));
  EXPECT_TRUE(SaysThatMemoryRanOut("mmap failed: Cannot allocate memory"));
  EXPECT_TRUE(SaysThatMemoryRanOut("database or disk: out of memory"));
  EXPECT_FALSE(SaysThatMemoryRanOut("Registering image #3 (4)"));
}

// What is thrown for a run of COLMAP's that ended so and left so much of the disk; "" for nothing.
std::string OutsideCause(const SubprocessResult& end, bool says_no_memory, const char* free_bytes) {
  const std::filesystem::path told = std::filesystem::temp_directory_path() / "colmap_log_test";
  std::ofstream(told) << free_bytes;
  setenv("SEAPOINT_FREE_DISK", told.c_str(), 1);
  std::string cause;
  try {
    ThrowIfFromOutside({end, says_no_memory, "/bin/colmap", "/ws/sparse", "/ws/log", "it failed"});
  } catch (const Error& error) {
    cause = error.what();
  }
  unsetenv("SEAPOINT_FREE_DISK");
  return cause;
}

TEST(ThrowIfFromOutsideTest, TellsAFullDiskFromAFaultOfItsOwn) {
  SubprocessResult end;
  end.signal_number = SIGABRT;
  EXPECT_EQ(OutsideCause(end, false, "2000000"), "");
  EXPECT_EQ(OutsideCause(end, false, "1000"),
            "/bin/colmap: it failed: the disk of /ws/sparse is full; make room there and run the "
            "same command again, which goes on from there; its output is in /ws/log");
  EXPECT_NE(OutsideCause(end, true, "2000000").find("no memory"), std::string::npos);
  end.signal_number = SIGKILL;
  EXPECT_NE(OutsideCause(end, false, "2000000").find("want of memory"), std::string::npos);
  end = {1, 0};
  EXPECT_EQ(OutsideCause(end, false, "2000000"), "");
}

// A folder on a disk that is gone refuses files with words of its own.
TEST(ThrowIfFromOutsideTest, ADiskThatTakesNothingIsNoWantOfMemory) {
  SubprocessResult end;
  end.signal_number = SIGABRT;
  const std::string cause = ErrorOf([&] {
    ThrowIfFromOutside({end, true, "/bin/colmap", "/proc/self", "/l", "it failed"});
  });
  EXPECT_EQ(cause.find("/bin/colmap: it failed: cannot be created ("), 0u) << cause;
  EXPECT_NE(cause.find("check the disk and its cable"), std::string::npos) << cause;
}

TEST(SaysThatAnOptionIsRefusedTest, InEachVersionsWords) {
  EXPECT_TRUE(SaysThatAnOptionIsRefused("ERROR: Failed to parse options - unrecognised option"));
  EXPECT_TRUE(
      SaysThatAnOptionIsRefused("Failed to parse options - the argument ('x') for option "
                                "'--Mapper.min_model_size' is invalid."));
  EXPECT_TRUE(SaysThatAnOptionIsRefused("Invalid options provided."));
  EXPECT_FALSE(SaysThatAnOptionIsRefused("Elapsed time: 0.009 [minutes]"));
}

}  // namespace
}  // namespace colmap_seapoint
