// A folder that we write into: one run at a time, and nothing in it is replaced or removed that we
// did not make.
//
// Which files are ours stands in the folder's ".colmap_seapoint", a path a line. A path is put
// there before its file is begun, so that a run that is killed at any moment leaves nothing of ours
// unnamed. What is not named there is the user's, or another program's.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "colmap_seapoint/io/outputs/run_lock.h"

namespace colmap_seapoint {

// Paths are relative to the folder, in generic form ("sparse/0/images.bin").
class OutputFolder {
 public:
  // Creates the folder, takes its lock, removes what killed runs left there (temporary_file.h), and
  // forgets the names of files that are gone. `option` is where the user names the folder. Throws
  // Error when it cannot be written, or another run is at work there.
  OutputFolder(const std::filesystem::path& folder, const std::string& option,
               IfBusy if_busy = IfBusy::kRefuse);
  // Without a file of ours in the folder nothing of this stays, and no folder that was created.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  const std::filesystem::path& Path() const { return path_; }
  const RunLock& Lock() const { return *lock_; }

  // Whether the file or folder, or a file below it, is ours.
  bool IsOurs(const std::string& name) const;

  // What the caller knows to be ours by other signs: earlier versions kept no names. Names of what
  // is not there are left out. It is written down with the next Claim().
  void Adopt(const std::vector<std::string>& names);
  // Makes the names ours, all or none. Throws Error for a name that is taken: by a file that is not
  // ours, by a link to a file, by a folder that is not ours and not empty.
  void Claim(const std::vector<std::string>& names);
  // The same test, without making them ours.
  void CheckFree(const std::vector<std::string>& names) const;
  // Removes the file, or our files below the folder, and folders that this leaves empty. Throws
  // Error when one of them cannot be removed.
  void Remove(const std::string& name);

 private:
  void ForgetGone();

  std::filesystem::path path_;
  std::string remedy_;
  bool is_new_ = false;
  std::optional<RunLock> lock_;
  std::set<std::string> names_;
  bool has_news_ = false;  // names that are not written down yet
};

// Our files that a run which is over left in the folder, by name. Folders are not among them.
std::vector<std::filesystem::path> FilesOfOurs(const std::filesystem::path& folder);

// Removes all our files from it.
void RemoveOurs(OutputFolder* folder);

}  // namespace colmap_seapoint
