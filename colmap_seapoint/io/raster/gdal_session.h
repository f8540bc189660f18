// GDAL, set up once and silent: what it reports becomes an Error of ours. For this room only.
#pragma once

#include <gdal.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "colmap_seapoint/io/files/atomic_path.h"

namespace colmap_seapoint {

struct GdalCloser {
  using pointer = GDALDatasetH;
  void operator()(GDALDatasetH dataset) const { GDALClose(dataset); }
};
using GdalDataset = std::unique_ptr<void, GdalCloser>;

// While it lives, the thread that made it uses GDAL on `path`, and no other session.
class GdalSession {
 public:
  // GDAL uses no other thread: it waits for ever for one that the system does not give. Throws
  // Error when GDAL lacks a driver that this room needs.
  explicit GdalSession(const std::filesystem::path& path);
  ~GdalSession();
  GdalSession(const GdalSession&) = delete;
  GdalSession& operator=(const GdalSession&) = delete;

  // Throws Error unless `succeeded` and GDAL has reported no failure since: closing a dataset is a
  // failure that nothing else tells. `written` is the file that GDAL was to write, nullptr when it
  // was to read.
  void Check(bool succeeded, const AtomicPath* written = nullptr) const;

 private:
  static void Note(CPLErr level, CPLErrorNum number, const char* message);

  std::filesystem::path path_;
  std::string failure_;  // the first one
};

GDALDriverH GdalDriver(const char* name);

// NAME=VALUE strings, as GDAL takes options.
class GdalStrings {
 public:
  GdalStrings(std::initializer_list<std::string> strings) : strings_(strings) {}
  void Add(const std::string& text) { strings_.push_back(text); }
  // Ends with nullptr; valid until the next call.
  char** List();

 private:
  std::vector<std::string> strings_;
  std::vector<char*> list_;
};

}  // namespace colmap_seapoint
