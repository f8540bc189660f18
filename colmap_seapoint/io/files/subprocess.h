// Runs another program (COLMAP) without a shell, so that it never outlives us.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace colmap_seapoint {

// The program's file: `name` itself when it holds a '/', else the first executable file of that
// name on PATH. Throws Error (what was looked for and where) when there is none; `remedy` says what
// the user is to do.
std::filesystem::path FindProgram(const std::string& name, const std::string& remedy);

struct SubprocessResult {
  int exit_code = -1;     // of a program that exited
  int signal_number = 0;  // not 0: ended by this signal
  bool Succeeded() const { return signal_number == 0 && exit_code == 0; }
  // By a signal that no program sends itself by mistake: by the system, for want of memory, or by a
  // person. A script that started the program says so by its exit code, 128 and the signal.
  bool WasEndedByOthers() const;
  std::string Text() const;  // "exit code 1", "killed by signal 11 (Segmentation fault)"
};

// Runs `program` with `arguments` until it ends; stdin is empty, the environment is ours with
// QT_QPA_PLATFORM=offscreen. stdout and stderr together go to `log_path` (a new file in place of
// what has that name; empty = nowhere) and line by line, without the newline, to `on_line`; both
// are bounded, however much the program prints (child_output.h). When it prints nothing for
// minutes, a log line says so.
//
// The program and whatever it starts form a process group of their own, which a guard process
// kills as soon as we die, even by kill -9. Call it from a thread that lives until we end.
// Throws Error when the log cannot be written, the program cannot be started, or it has not ended
// after timeout_seconds (0: no limit); the program is ended first, as by an exception of on_line.
SubprocessResult RunSubprocess(const std::filesystem::path& program,
                               const std::vector<std::string>& arguments,
                               const std::filesystem::path& log_path,
                               const std::function<void(const std::string&)>& on_line,
                               double timeout_seconds = 0);

}  // namespace colmap_seapoint
