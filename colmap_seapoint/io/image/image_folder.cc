#include "colmap_seapoint/io/image/image_folder.h"

#include <algorithm>
#include <map>
#include <set>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/image/image_file.h"

namespace colmap_seapoint {
namespace {

std::string InSmallLetters(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

// The same for all files of one shot.
std::string ShotOf(const std::string& name) {
  return InSmallLetters(std::filesystem::path(name).replace_extension().generic_string());
}

void AddFile(const std::filesystem::path& path, const std::string& name, FolderListing* listing) {
  const FileKind kind = KindOf(path);
  if (kind == FileKind::kAside) return;
  const bool is_copied = kind == FileKind::kCameraPicture || kind == FileKind::kVideo;
  if (kind == FileKind::kOther || (is_copied && !IsSafeImageName(name))) {
    listing->others.push_back(name);
    return;
  }
  auto& names = kind == FileKind::kPicture         ? listing->pictures
                : kind == FileKind::kCameraPicture ? listing->camera_pictures
                                                   : listing->videos;
  names.push_back(name);
}

bool IsWithin(const std::filesystem::path& path, const std::filesystem::path& folder) {
  const auto relative = path.lexically_relative(folder);
  return !relative.empty() && *relative.begin() != "..";
}

// Walks a folder and those below it, links to folders included: each is walked once, so that links
// that go in circles, or to what is read anyway, do no harm.
class FolderWalk {
 public:
  explicit FolderWalk(const std::filesystem::path& root) : root_(root) {
    walked_.push_back(std::filesystem::canonical(root));
    Walk(root);
  }

  const FolderListing& Listing() const { return listing_; }

 private:
  // In the order of the names, so that of two links to one folder it is always the same that
  // counts.
  void Walk(const std::filesystem::path& folder) {
    std::vector<std::filesystem::directory_entry> entries(
        std::filesystem::directory_iterator(folder), {});
    std::sort(entries.begin(), entries.end());
    for (const auto& entry : entries) {
      const std::filesystem::path& path = entry.path();
      std::error_code ignored;
      if (path.filename().string().front() == '.') continue;
      const std::string name = path.lexically_relative(root_).generic_string();
      if (entry.is_directory(ignored)) {
        if (!entry.is_symlink(ignored) || IsNew(path)) {
          Walk(path);
        } else {
          listing_.known_links.push_back(name);
        }
      } else if (entry.is_regular_file(ignored)) {
        AddFile(path, name, &listing_);
      } else if (entry.is_symlink(ignored) && !entry.exists(ignored)) {
        listing_.dead_links.push_back(name);
      }
    }
  }

  // False for a link to what is walked, or to what holds it.
  bool IsNew(const std::filesystem::path& link) {
    std::error_code error;
    const auto target = std::filesystem::canonical(link, error);
    if (error) return false;
    for (const auto& folder : walked_) {
      if (IsWithin(target, folder) || IsWithin(folder, target)) return false;
    }
    walked_.push_back(target);
    return true;
  }

  std::filesystem::path root_;
  std::vector<std::filesystem::path> walked_;
  FolderListing listing_;
};

// A shot is taken once: as the picture that needs no decoded copy, else as the first of its names.
void SetTwinsAside(FolderListing* listing) {
  std::set<std::string> shots;
  for (const std::string& name : listing->pictures) shots.insert(ShotOf(name));
  const auto is_twin = [&](const std::string& name) { return shots.count(ShotOf(name)) > 0; };
  const auto set_aside = [&](std::vector<std::string>* names, bool takes_first) {
    std::vector<std::string> kept;
    for (const std::string& name : *names) {
      (is_twin(name) ? listing->twins : kept).push_back(name);
      if (takes_first) shots.insert(ShotOf(name));
    }
    *names = kept;
  };
  set_aside(&listing->camera_pictures, true);
  // A phone's moving picture. Other cameras' clips share no name with their pictures.
  std::vector<std::string> films, videos;
  for (const std::string& name : listing->videos) {
    (InSmallLetters(std::filesystem::path(name).extension()) == ".mov" ? films : videos)
        .push_back(name);
  }
  set_aside(&films, false);
  videos.insert(videos.end(), films.begin(), films.end());
  listing->videos = videos;
}

}  // namespace

FileKind KindOf(const std::filesystem::path& path) {
  static const std::map<FileKind, std::set<std::string>> kExtensions = {
      {FileKind::kPicture,
       {".jpg", ".jpeg", ".png", ".tif", ".tiff", ".bmp", ".webp", ".ppm", ".pgm", ".jp2"}},
      {FileKind::kCameraPicture,
       {".heic", ".heif", ".hif", ".dng", ".gpr", ".nef", ".nrw", ".cr2", ".cr3", ".arw", ".orf",
        ".rw2", ".raf", ".pef", ".srw", ".raw"}},
      {FileKind::kVideo,
       {".mp4", ".mov", ".m4v", ".mkv", ".avi", ".mts", ".m2ts", ".ts", ".mpg", ".mpeg", ".wmv",
        ".webm", ".3gp", ".mxf", ".insv", ".360"}},
      {FileKind::kAside,
       {".thm", ".lrv", ".lrf", ".glv", ".db", ".ini", ".xmp", ".aae", ".srt", ".csv"}}};
  const std::string extension = InSmallLetters(path.extension().string());
  for (const auto& [kind, extensions] : kExtensions) {
    if (extensions.count(extension) > 0) return kind;
  }
  return FileKind::kOther;
}

FolderListing ListFolder(const std::filesystem::path& folder) {
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) {
    throw Error(folder.string(), "there is no such folder", "check --image_path");
  }
  FolderListing listing;
  try {
    listing = FolderWalk(folder).Listing();
  } catch (const std::filesystem::filesystem_error& failure) {
    throw Error(failure.path1().empty() ? folder.string() : failure.path1().string(),
                "cannot be read (" + failure.code().message() + ")",
                "check the folder's permissions");
  }
  for (auto* names : {&listing.pictures, &listing.camera_pictures, &listing.videos}) {
    std::sort(names->begin(), names->end());
  }
  SetTwinsAside(&listing);
  for (auto* names : {&listing.videos, &listing.twins, &listing.others}) {
    std::sort(names->begin(), names->end());
  }
  return listing;
}

}  // namespace colmap_seapoint
