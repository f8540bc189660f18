#include "colmap_seapoint/io/files/child_output.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "colmap_seapoint/base/hold/work_pause.h"
#include "tests/expect_error.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

// A pipe whose other end another thread writes to, and closes.
class Printer {
 public:
  explicit Printer(const std::function<void(int)>& print) {
    EXPECT_EQ(pipe(ends_), 0);
    thread_ = std::thread([this, print] {
      print(ends_[1]);
      close(ends_[1]);
    });
  }
  ~Printer() {
    thread_.join();
    close(ends_[0]);
  }
  int Pipe() const { return ends_[0]; }

 private:
  int ends_[2];
  std::thread thread_;
};

void Say(int pipe, const std::string& text) {
  EXPECT_EQ(write(pipe, text.data(), text.size()), static_cast<ssize_t>(text.size()));
}

void Sleep(int milliseconds) {
  std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
}

TEST(ChildOutput, LinesHoweverTheyArriveInPieces) {
  const TempDir dir;
  std::vector<std::string> lines;
  ChildOutputOptions options;
  options.log_path = dir / "log";
  options.on_line = [&](const std::string& line) { lines.push_back(line); };
  const Printer printer([](int pipe) {
    for (const char* part : {"on", "e\ntwo\n\nth", "ree\nfour"}) {
      Say(pipe, part);
      Sleep(5);
    }
  });
  ChildOutput(options).CopyFrom(printer.Pipe());
  EXPECT_EQ(lines, (std::vector<std::string>{"one", "two", "", "three", "four"}));
  EXPECT_EQ(ReadBytes(dir / "log"), "one\ntwo\n\nthree\nfour");
}

TEST(ChildOutput, OfAnEndlessLineTheBeginning) {
  std::vector<std::string> lines;
  ChildOutputOptions options;
  options.on_line = [&](const std::string& line) { lines.push_back(line); };
  const Printer printer([](int pipe) {
    for (int i = 0; i < 1000; ++i) Say(pipe, std::string(1000, 'x'));
    Say(pipe, "\nnext\n");
  });
  ChildOutput(options).CopyFrom(printer.Pipe());
  EXPECT_EQ(lines,
            (std::vector<std::string>{std::string(ChildOutput::kMaxLineBytes, 'x'), "next"}));
}

TEST(ChildOutput, SilenceIsTold) {
  ChildOutputOptions options;
  options.program = "/usr/bin/colmap";
  options.silence_seconds = 0.1;
  const Printer printer([](int pipe) {
    Say(pipe, "a\n");
    Sleep(350);  // told after 0.1 and 0.2 s
    Say(pipe, "b\n");
    Sleep(150);  // and after 0.1 s
  });
  testing::internal::CaptureStderr();
  ChildOutput(options).CopyFrom(printer.Pipe());
  const std::string log = testing::internal::GetCapturedStderr();
  EXPECT_EQ(std::count(log.begin(), log.end(), '\n'), 3) << log;
  EXPECT_EQ(log.find("colmap has printed nothing for 0.1 s; it is still at work\n"), 0u) << log;
}

TEST(ChildOutput, TheTimeIsOverForWhoTalksAndForWhoDoesNot) {
  ChildOutputOptions options;
  options.program = "/usr/bin/colmap";
  options.timeout_seconds = 0.1;
  for (const bool talks : {true, false}) {
    const auto start = std::chrono::steady_clock::now();
    const Printer printer([talks](int pipe) {
      for (int i = 0; i < 40; ++i) {
        if (talks) Say(pipe, "x");
        Sleep(10);
      }
    });
    EXPECT_ERROR(ChildOutput(options).CopyFrom(printer.Pipe()), "has not ended within 0.1 s");
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(350));
  }
}

// A pause of all work stops the child, and is neither its time nor its silence.
TEST(ChildOutput, APauseIsNotTheChildsTime) {
  ChildOutputOptions options;
  options.program = "/usr/bin/colmap";
  options.timeout_seconds = 2;
  options.silence_seconds = 2;
  std::vector<bool> stops;
  options.stop = [&](bool is_stopped) { stops.push_back(is_stopped); };
  SetWorkPaused(PauseReason::kBattery, true);
  const Printer printer([](int pipe) {
    Sleep(2500);
    SetWorkPaused(PauseReason::kBattery, false);
    Say(pipe, "a\n");
  });
  testing::internal::CaptureStderr();
  ChildOutput(options).CopyFrom(printer.Pipe());
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(stops, (std::vector<bool>{true, false}));
}

TEST(ChildOutput, ALogThatCannotBeWritten) {
  ChildOutputOptions options;
  options.log_path = "/dev/full";
  const Printer printer([](int pipe) { Say(pipe, "a\n"); });
  EXPECT_ERROR(ChildOutput(options).CopyFrom(printer.Pipe()), "No space left on device");
}

}  // namespace
}  // namespace colmap_seapoint
