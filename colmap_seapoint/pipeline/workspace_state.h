// What automatic_reconstructor remembers between runs: WORKSPACE/state/<stage>.json, one small
// atomic file a stage. The database alone is not enough: COLMAP opens it without synchronisation.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "colmap_seapoint/io/files/run_report.h"

namespace colmap_seapoint {

class WorkspaceState {
 public:
  // Creates the folder and holds its lock until the end of this object (and of any program that
  // a killed run had started). Throws Error when another run works there.
  explicit WorkspaceState(const std::filesystem::path& workspace);
  ~WorkspaceState();
  WorkspaceState(const WorkspaceState&) = delete;
  WorkspaceState& operator=(const WorkspaceState&) = delete;

  // The report of a stage that was finished, whatever its fingerprint; nullopt before that.
  std::optional<RunReport> Read(const std::string& stage) const;
  // ... with this fingerprint only.
  std::optional<RunReport> ReadIfDone(const std::string& stage,
                                      const std::string& fingerprint) const;

  // To be called before the outputs of a stage are touched.
  void Forget(const std::string& stage);
  // To be called when the outputs of a stage stand; they are brought to the disk first.
  void Finish(const std::string& stage, const std::string& fingerprint, RunReport report);

 private:
  std::filesystem::path PathOf(const std::string& stage) const;

  std::filesystem::path folder_;
  int lock_ = -1;
};

}  // namespace colmap_seapoint
