// Which pictures there are, and which camera took each: COLMAP's ImageReader, with its options.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/io/image/image_folder.h"
#include "colmap_seapoint/pictures/image_reader_options.h"

namespace colmap_seapoint {

// Leaves out what shows something, but is no picture that COLMAP reads: HEIC and RAW, videos, each
// with what to do; tells in a line what else lies there.
void LeaveOutOtherFiles(const FolderListing& listing, RunReport* report);

// Names below `image_path`, sorted bytewise, each once: all pictures, or those of the list where
// one is given. Names that could lead out of the folder are left out, and LeaveOutOtherFiles().
// Throws Error when there is no such folder or list, or no name in it.
std::vector<std::string> ListPictures(const std::filesystem::path& image_path,
                                      const std::string& image_list_path, RunReport* report);

struct ReadablePicture {
  std::string name;
  ImageInfo info;
};

// Headers of all pictures; those whose header cannot be read are left out. One warning line when
// some are stored turned (EXIF orientation), since their pixels are used as they are.
std::vector<ReadablePicture> ReadHeaders(const std::filesystem::path& image_path,
                                         const std::vector<std::string>& names, int num_threads,
                                         RunReport* report);

struct RegisteredPicture {
  uint32_t image_id = 0;
  std::string name;
};

// Adds the missing cameras and images in the order of `pictures`, in one transaction, so that ids
// do not depend on what interrupts later work. Pictures that the database knows keep their camera.
// Leaves out pictures whose size is not that of the camera they would get. The report gets a line a
// camera: which pictures it took, and where its lens is from; so does the log where one is new.
std::vector<RegisteredPicture> RegisterPictures(const std::vector<ReadablePicture>& pictures,
                                                const ImageReaderOptions& options,
                                                ColmapDatabase* database, RunReport* report);

}  // namespace colmap_seapoint
