#include "colmap_seapoint/pictures/image_reader.h"

#include <algorithm>
#include <optional>
#include <set>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/base/run_options.h"
#include "colmap_seapoint/cameras/camera_identity.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/pictures/first_lens.h"

namespace colmap_seapoint {
namespace {

// More are lines that nobody reads.
constexpr size_t kMaxCameraLines = 10;

std::string SizeText(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

std::string FolderOf(const std::string& name) {
  const size_t slash = name.rfind('/');
  return slash == std::string::npos ? "" : name.substr(0, slash);
}

// Pictures with the same key share a camera.
std::string CameraGroup(const ReadablePicture& picture, const ImageReaderOptions& options) {
  if (options.single_camera) return "";
  if (options.single_camera_per_folder == 0) return picture.name;
  const std::string folder = FolderOf(picture.name);
  return (options.single_camera_per_folder == 1 ? folder
                                                : FolderFamily(folder, picture.info.camera)) +
         "\n" + SizeText(picture.info.width, picture.info.height) + "\n" +
         CameraKey(picture.info.camera);
}

std::string FolderText(const std::string& folder) { return folder.empty() ? "." : folder; }

// What the pictures of one camera tell of it.
struct CameraUse {
  const ReadablePicture* first = nullptr;
  size_t num_pictures = 0;
  std::set<std::string> folders;
};

// "camera 1 (GoPro HERO12 Black, 5312x2988): 30 pictures in 100GOPRO, 101GOPRO; focal length ..."
std::string CameraLine(const Camera& camera, const CameraUse& use,
                       const ImageReaderOptions& options) {
  const ExifCamera& exif = use.first->info.camera;
  std::string line = "camera " + std::to_string(camera.camera_id) + " (";
  if (!exif.model.empty()) line += exif.maker + (exif.maker.empty() ? "" : " ") + exif.model + ", ";
  line += SizeText(camera.width, camera.height) + "): " + std::to_string(use.num_pictures) +
          (use.num_pictures == 1 ? " picture" : " pictures");
  if (use.folders.size() > 1) {
    const char* separator = " in ";
    for (const std::string& folder : use.folders) {
      line += separator + FolderText(folder);
      separator = ", ";
    }
  }
  const FirstLens lens = FirstLensOf(use.first->info, options);
  if (lens.camera.model == camera.model && lens.camera.params == camera.params) {
    return line + "; " + lens.origin;
  }
  return line + "; lens as the database has it";
}

// One registration: what the database holds, and which group got which camera.
class Registrar {
 public:
  Registrar(const ImageReaderOptions& options, ColmapDatabase* database)
      : options_(options), database_(database), cameras_(ReadCameras(*database)) {
    for (const DatabaseImage& image : ReadImages(*database)) images_[image.name] = image;
  }

  // A line each for the first cameras that pictures were registered with, by their ids.
  std::vector<std::string> CameraLines() const {
    std::vector<std::string> lines;
    for (const auto& [id, use] : uses_) {
      if (lines.size() == kMaxCameraLines) {
        lines.push_back("and " + std::to_string(uses_.size() - kMaxCameraLines) + " more cameras");
        break;
      }
      lines.push_back(CameraLine(cameras_.at(id), use, options_));
    }
    return lines;
  }
  bool HasNewCamera() const { return has_new_camera_; }

  // Groups of pictures that are known keep their camera, whatever order new ones come in.
  void LearnGroups(const std::vector<ReadablePicture>& pictures) {
    for (const ReadablePicture& picture : pictures) {
      const auto image = images_.find(picture.name);
      if (image != images_.end()) {
        group_cameras_.emplace(CameraGroup(picture, options_), image->second.camera_id);
      }
    }
  }

  // nullopt, with the reason, when the picture does not fit its camera.
  std::optional<uint32_t> Register(const ReadablePicture& picture, std::string* reason) {
    const auto known = images_.find(picture.name);
    const uint32_t camera_id =
        known != images_.end() ? known->second.camera_id : CameraFor(picture);
    const auto camera = cameras_.find(camera_id);
    if (camera == cameras_.end()) {
      *reason = "its camera " + std::to_string(camera_id) + " is not in the database";
      return std::nullopt;
    }
    const auto& [width, height] = std::pair(camera->second.width, camera->second.height);
    if (width != picture.info.width || height != picture.info.height) {
      *reason = "is " + SizeText(picture.info.width, picture.info.height) + " but its camera " +
                std::to_string(camera_id) + " is " + SizeText(width, height);
      return std::nullopt;
    }
    CameraUse& use = uses_[camera_id];
    if (use.num_pictures++ == 0) use.first = &picture;
    use.folders.insert(FolderOf(picture.name));
    if (known != images_.end()) return known->second.image_id;
    return AddImage(database_, picture.name, camera_id);
  }

 private:
  uint32_t CameraFor(const ReadablePicture& picture) {
    const std::string group = CameraGroup(picture, options_);
    const auto known = group_cameras_.find(group);
    if (known != group_cameras_.end()) return known->second;
    Camera camera = FirstLensOf(picture.info, options_).camera;
    const uint32_t camera_id = AddCamera(database_, camera);
    camera.camera_id = camera_id;
    cameras_[camera_id] = camera;
    has_new_camera_ = true;
    group_cameras_[group] = camera_id;
    return camera_id;
  }

  const ImageReaderOptions& options_;
  ColmapDatabase* database_;
  std::map<uint32_t, Camera> cameras_;
  std::map<std::string, DatabaseImage> images_;
  std::map<std::string, uint32_t> group_cameras_;
  std::map<uint32_t, CameraUse> uses_;
  bool has_new_camera_ = false;
};

void WarnOfTurnedPictures(const std::vector<ReadablePicture>& pictures) {
  int count = 0;
  const ReadablePicture* first = nullptr;
  for (const ReadablePicture& picture : pictures) {
    if (picture.info.exif_orientation == 1) continue;
    if (count++ == 0) first = &picture;
  }
  if (count == 0) return;
  LogWarning(std::to_string(count) + " pictures are stored turned by their EXIF orientation (" +
             first->name + " is the first): the pixels are used as they are stored");
}

// "csv, txt"; of files without one, their names.
std::string ExtensionsOf(const std::vector<std::string>& names) {
  std::set<std::string> extensions;
  for (const std::string& name : names) {
    const std::filesystem::path path(name);
    const std::string extension = path.extension().string();
    extensions.insert(extension.empty() ? path.filename().string() : extension.substr(1));
  }
  std::string text;
  for (const std::string& extension : extensions) {
    text += (text.empty() ? "" : ", ") + extension;
  }
  return text;
}

}  // namespace

void LeaveOutOtherFiles(const FolderListing& listing, RunReport* report) {
  for (const std::string& name : listing.camera_pictures) {
    LeaveOut(name,
             "COLMAP reads no HEIC and RAW: let automatic_reconstructor decode it, or convert it "
             "to JPEG",
             report);
  }
  for (const std::string& name : listing.videos) {
    LeaveOut(name,
             "it is a video: give it to automatic_reconstructor as an --image_path of its own",
             report);
  }
  for (const std::string& name : listing.known_links) {
    LogInfo(name +
            " is a link to a folder that is read anyway, or to one that holds it: it is not "
            "followed");
  }
  for (const std::string& name : listing.dead_links) {
    LeaveOut(name, "is a link that leads nowhere: is the disk there that it names?", report);
  }
  if (!listing.twins.empty()) {
    LogInfo(std::to_string(listing.twins.size()) + " files (" + ExtensionsOf(listing.twins) +
            ") show the same as a picture of their name, which is used");
  }
  if (!listing.others.empty()) {
    LogInfo(std::to_string(listing.others.size()) + " other files (" +
            ExtensionsOf(listing.others) + ") are no pictures");
  }
}

std::vector<std::string> ListPictures(const std::filesystem::path& image_path,
                                      const std::string& image_list_path, RunReport* report) {
  // Listing first also tells of a missing folder when a list is given.
  if (!std::filesystem::is_directory(image_path)) {
    throw Error(image_path.string(), "there is no such folder", "check --image_path");
  }
  std::vector<std::string> listed =
      image_list_path.empty() ? ListImages(image_path) : ReadImageList(image_list_path);
  if (image_list_path.empty()) LeaveOutOtherFiles(ListFolder(image_path), report);
  std::sort(listed.begin(), listed.end());
  listed.erase(std::unique(listed.begin(), listed.end()), listed.end());
  report->images_in = static_cast<int64_t>(listed.size());
  std::vector<std::string> names;
  for (const std::string& name : listed) {
    if (IsSafeImageName(name)) {
      names.push_back(name);
    } else {
      LeaveOut(name,
               "its name holds what no file of COLMAP's can (a backslash, a control character), or "
               "leads "
               "out of the folder; rename it",
               report);
    }
  }
  return names;
}

std::vector<ReadablePicture> ReadHeaders(const std::filesystem::path& image_path,
                                         const std::vector<std::string>& names, int num_threads,
                                         RunReport* report) {
  std::vector<ReadablePicture> read(names.size());
  std::vector<std::string> reasons(names.size());
  ParallelFor(num_threads, static_cast<int64_t>(names.size()), [&](int64_t index) {
    const auto i = static_cast<size_t>(index);
    try {
      read[i] = {names[i], ReadImageInfo(image_path / names[i])};
    } catch (const Error& error) {
      reasons[i] = error.Finding();
    }
  });
  std::vector<ReadablePicture> pictures;
  for (size_t i = 0; i < names.size(); ++i) {
    if (reasons[i].empty()) {
      pictures.push_back(std::move(read[i]));
    } else {
      LeaveOut(names[i], reasons[i], report);
    }
  }
  WarnOfTurnedPictures(pictures);
  return pictures;
}

std::vector<RegisteredPicture> RegisterPictures(const std::vector<ReadablePicture>& pictures,
                                                const ImageReaderOptions& options,
                                                ColmapDatabase* database, RunReport* report) {
  std::vector<RegisteredPicture> registered;
  Registrar registrar(options, database);
  registrar.LearnGroups(pictures);
  DatabaseTransaction transaction(database);
  for (const ReadablePicture& picture : pictures) {
    std::string reason;
    const auto image_id = registrar.Register(picture, &reason);
    if (image_id) {
      registered.push_back({*image_id, picture.name});
    } else {
      LeaveOut(picture.name, reason, report);
    }
  }
  transaction.Commit();
  report->cameras = registrar.CameraLines();
  if (registrar.HasNewCamera()) {
    for (const std::string& line : report->cameras) LogInfo(line);
  }
  return registered;
}

}  // namespace colmap_seapoint
