// What lies in a folder of pictures, by the files' extensions.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace colmap_seapoint {

enum class FileKind {
  kPicture,        // jpg jpeg png tif tiff bmp webp ppm pgm jp2: COLMAP and we read these
  kCameraPicture,  // HEIC and RAW (camera_picture.h): read through a decoded copy
  kVideo,          // mp4 mov m4v mkv avi mts m2ts ts mpg mpeg wmv webm 3gp mxf insv 360
  kAside,          // what cameras and systems put there: thumbnails, previews, their notes
  kOther,
};

// By the extension alone, in any case.
FileKind KindOf(const std::filesystem::path& path);

// Names relative to the folder, '/' between folders, sorted bytewise. Hidden files and folders are
// in none of the lists.
struct FolderListing {
  std::vector<std::string> pictures, camera_pictures, videos;
  std::vector<std::string> twins;   // RAW, HEIC or MOV beside a picture of the same name: the same
                                    // shot, which that picture shows
  std::vector<std::string> others;  // kOther, and what cannot be copied under its name
  // Links to folders that are listed anyway, or hold one that is; and links that lead nowhere.
  std::vector<std::string> known_links, dead_links;
};

// Of the folder and all below it. Links to folders are followed, each folder once: none where they
// go in circles, or to what is listed anyway. Pictures with names that IsSafeImageName refuses are
// among the pictures. Throws Error when there is no such folder, or it cannot be read.
FolderListing ListFolder(const std::filesystem::path& folder);

}  // namespace colmap_seapoint
