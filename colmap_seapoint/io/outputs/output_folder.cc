#include "colmap_seapoint/io/outputs/output_folder.h"

#include <algorithm>
#include <boost/algorithm/string/predicate.hpp>
#include <cstdlib>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/input_stream.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr char kNamesFile[] = ".colmap_seapoint";
constexpr char kFirstLine[] =
    "# colmap_seapoint made these. It replaces and removes nothing else here.";
constexpr char kRoot[] = "";

// A name may hold any byte, a line not that of its end.
std::string Line(const std::string& name) {
  std::string line;
  for (const char c : name) {
    if (c == '\n') line += "%0A";
    if (c == '%') line += "%25";
    if (c != '\n' && c != '%') line += c;
  }
  return line;
}

std::string Name(const std::string& line) {
  std::string name;
  for (size_t i = 0; i < line.size(); ++i) {
    const std::string code = line[i] == '%' ? line.substr(i, 3) : "";
    name += code == "%0A" ? '\n' : line[i];
    if (code == "%0A" || code == "%25") i += 2;
  }
  return name;
}

// Nothing that leads out of the folder, whoever wrote it there.
bool IsBelow(const fs::path& name) {
  return !name.empty() && name.is_relative() &&
         std::find(name.begin(), name.end(), "..") == name.end();
}

std::set<std::string> ReadNames(const fs::path& folder) {
  const fs::path path = folder / kNamesFile;
  const auto file = OpenIfThere(path);
  if (!file) return {};
  std::string line;
  std::set<std::string> names;
  if (!std::getline(*file, line) || line != kFirstLine) {
    throw Error(path.string(), "is no list of ours, or damaged",
                "move it away; without it, what is in the folder is left alone");
  }
  while (std::getline(*file, line)) {
    if (const std::string name = Name(line); IsBelow(name)) names.insert(name);
  }
  return names;
}

void WriteNames(const fs::path& folder, const std::set<std::string>& names) {
  std::string text = std::string(kFirstLine) + "\n";
  for (const std::string& name : names) text += Line(name) + "\n";
  WriteTextFile(folder / kNamesFile, text);
}

// A link counts, wherever it leads.
bool Exists(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(fs::symlink_status(path, ignored));
}

// Whether `name` is `other` or lies below it. All lie below the root.
bool IsAtOrBelow(const std::string& name, const std::string& other) {
  return other == kRoot || name == other || boost::starts_with(name, other + "/");
}

// What stands where a file or folder of ours is to be; "" when nothing does.
std::string Occupant(const fs::path& path, bool is_ours) {
  std::error_code ignored;
  const fs::file_status status = fs::symlink_status(path, ignored);
  if (!fs::exists(status)) return "";
  if (fs::is_directory(path, ignored)) {  // or a link to one: big disks are linked to
    return is_ours || fs::is_empty(path, ignored) ? "" : "was not made by colmap_seapoint";
  }
  if (status.type() == fs::file_type::symlink) return "is a link, and is never written through";
  return is_ours ? "" : "was not made by colmap_seapoint";
}

void RemoveFile(const fs::path& path, const std::string& remedy) {
  std::error_code error;
  if (fs::is_directory(fs::symlink_status(path, error))) return;
  fs::remove(path, error);
  if (error) throw Error(path.string(), "cannot be removed (" + error.message() + ")", remedy);
}

// `path` and the folders above it, below `root`, as long as they are empty.
void RemoveEmptyFolders(fs::path path, const fs::path& root) {
  std::error_code error;
  while (path != root && fs::is_directory(fs::symlink_status(path, error))) {
    if (!fs::remove(path, error) || error) return;
    path = path.parent_path();
  }
}

}  // namespace

OutputFolder::OutputFolder(const fs::path& folder, const std::string& option, IfBusy if_busy)
    : path_(fs::absolute(folder).lexically_normal()),
      remedy_("choose another " + option),
      is_new_(!Exists(path_)) {
  CheckWritableDir(path_);
  lock_.emplace(path_ / (std::string(kNamesFile) + ".lock"), path_, remedy_, if_busy);
  names_ = ReadNames(path_);
  ForgetGone();
}

OutputFolder::~OutputFolder() {
  try {
    ForgetGone();
  } catch (const Error&) {  // the next run forgets them
  }
  std::error_code ignored;
  if (names_.empty()) fs::remove(path_ / kNamesFile, ignored);
  lock_.reset();
  if (is_new_) fs::remove(path_, ignored);  // if nothing is in it
}

bool OutputFolder::IsOurs(const std::string& name) const {
  const auto first = names_.lower_bound(name);
  if (first != names_.end() && *first == name) return true;
  const auto below = names_.lower_bound(name + "/");
  return below != names_.end() && boost::starts_with(*below, name + "/");
}

// A name outlives its file no longer than the run: whoever takes it next may be somebody else.
void OutputFolder::ForgetGone() {
  std::set<std::string> kept;
  for (const std::string& name : names_) {
    if (Exists(path_ / name)) kept.insert(name);
  }
  if (kept.size() == names_.size()) return;
  names_ = kept;
  WriteNames(path_, names_);
}

void OutputFolder::Adopt(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (Exists(path_ / name)) has_news_ |= names_.insert(name).second;
  }
}

void OutputFolder::CheckFree(const std::vector<std::string>& names) const {
  for (const std::string& name : names) {
    SEAPOINT_CHECK(IsBelow(name));
    const std::string occupant = Occupant(path_ / name, IsOurs(name));
    if (occupant.empty()) continue;
    throw Error((path_ / name).string(), occupant, remedy_ + ", or move it away");
  }
}

void OutputFolder::Claim(const std::vector<std::string>& names) {
  CheckFree(names);
  for (const std::string& name : names) has_news_ |= names_.insert(name).second;
  if (has_news_) WriteNames(path_, names_);
  has_news_ = false;
}

void OutputFolder::Remove(const std::string& name) {
  std::vector<std::string> removed;
  for (const std::string& ours : names_) {
    if (IsAtOrBelow(ours, name)) removed.push_back(ours);
  }
  // Backwards: what lies in a folder goes before it.
  std::for_each(removed.rbegin(), removed.rend(), [&](const std::string& ours) {
    RemoveFile(path_ / ours, remedy_);
    RemoveEmptyFolders(path_ / ours, path_);
    RemoveEmptyFolders((path_ / ours).parent_path(), path_);
  });
  for (const std::string& ours : removed) {
    if (!Exists(path_ / ours)) names_.erase(ours);  // a folder may hold what others put there
  }
  if (!removed.empty()) WriteNames(path_, names_);
}

std::vector<fs::path> FilesOfOurs(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code ignored;
  for (const std::string& name : ReadNames(folder)) {
    if (fs::is_regular_file(folder / name, ignored)) files.push_back(folder / name);
  }
  return files;
}

void RemoveOurs(OutputFolder* folder) { folder->Remove(kRoot); }

}  // namespace colmap_seapoint
