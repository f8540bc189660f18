// Less memory than a run needs: it is done as with more, or it fails with a line that says so. A
// picture for which there was no room at that moment is not a bad one.
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/faults/faults_fixture.h"

namespace colmap_seapoint {
namespace {

class LittleMemory : public Faults {
 protected:
  // Both must come about, and nothing else; `output` is compared with that of a run without limit.
  void ExpectDoneOrFailed(const Arguments& arguments, const std::string& output) {
    ASSERT_EQ(Run(arguments).exit_code, 0);
    const std::string whole = ReadBytes(folder_ / output);
    int num_failed = 0, num_done = 0;
    for (long megabytes = 150; megabytes <= 600 && num_done < 4; megabytes += megabytes / 25) {
      std::filesystem::remove_all(folder_ / output);
      CliOptions options;
      options.max_address_bytes = megabytes << 20;
      // The libraries that we need can end the program before it begins.
      if (RunProgram(SEAPOINT_PROGRAM, {"version"}, options).exit_code != 0) continue;
      const CliResult result = Run(arguments, options, {"--num_threads", "64"});
      if (result.exit_code == 0) {
        ++num_done;
        EXPECT_TRUE(ReadBytes(folder_ / output) == whole) << megabytes << " MB";
      } else {
        ++num_failed;
        EXPECT_EQ(result.exit_code, 1) << megabytes << " MB: " << result.Text();
        EXPECT_EQ(result.LastErrorLine().find("error: memory: not enough for this run"), 0u)
            << megabytes << " MB: " << result.Text();
      }
    }
    EXPECT_GT(num_failed, 0);
    EXPECT_GT(num_done, 0);
  }
};

TEST_F(LittleMemory, OfTheDensifier) { ExpectDoneOrFailed(Densify(), "dense/fused.ply"); }

TEST_F(LittleMemory, OfTheExtractor) {
  ColorImage large(4000, 3000, 3);
  for (size_t i = 0; i < large.data.size(); ++i) large.data[i] = static_cast<uint8_t>(i * i >> 9);
  for (const char* name : {"large.jpg", "large.tif"}) WriteImage(folder_ / "images" / name, large);
  Arguments extract = Extract();
  extract.insert(extract.end(), {"--max_memory", "1G"});
  ExpectDoneOrFailed(extract, "d.db");
}

}  // namespace
}  // namespace colmap_seapoint
