#include "colmap_seapoint/io/raster/gdal_session.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <gdal_frmts.h>

#include <algorithm>
#include <mutex>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/system/system_error.h"

namespace colmap_seapoint {
namespace {

// Holds a row of scratch tiles (cog_file.cc) of a map of 100,000 pixels.
constexpr GIntBig kCacheBytes = GIntBig{128} << 20;
constexpr const char* kDrivers[] = {"GTiff", "COG", "VRT"};

// Only what this room needs: all of GDAL's drivers take 50 ms to start.
void SetUp() {
  GDALRegister_GTiff();
  GDALRegister_COG();
  GDALRegister_VRT();
  GDALSetCacheMax64(kCacheBytes);
  CPLSetErrorHandler(CPLQuietErrorHandler);
}

std::string OneLine(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text.empty() ? "no reason given" : text;
}

}  // namespace

GdalSession::GdalSession(const std::filesystem::path& path) : path_(path) {
  static std::once_flag once;
  std::call_once(once, SetUp);
  for (const char* name : kDrivers) {
    if (GDALGetDriverByName(name) != nullptr) continue;
    throw Error(path.string(), std::string("this GDAL cannot write it: it has no driver ") + name,
                "install GDAL 3.1 or later (Debian: libgdal32)");
  }
  CPLPushErrorHandlerEx(&GdalSession::Note, this);
  // No .aux.xml beside the files; overviews of large tiles.
  CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", "NO");
  CPLSetThreadLocalConfigOption("GDAL_TIFF_OVR_BLOCKSIZE", "512");
  CPLSetThreadLocalConfigOption("GDAL_NUM_THREADS", "1");
}

GdalSession::~GdalSession() { CPLPopErrorHandler(); }

void GdalSession::Note(CPLErr level, CPLErrorNum number, const char* message) {
  auto* session = static_cast<GdalSession*>(CPLGetErrorHandlerUserData());
  if (level < CE_Failure || !session->failure_.empty()) return;
  session->failure_ = OneLine(message);
  if (number == CPLE_OutOfMemory) session->failure_ += " (out of memory)";
}

void GdalSession::Check(bool succeeded, const AtomicPath* written) const {
  if (succeeded && failure_.empty()) return;
  const int error = written == nullptr ? 0 : written->GrowthError();
  if (error != 0) throw SystemError(path_, "cannot be written", error);
  throw Error(path_.string(),
              std::string(written == nullptr ? "cannot be read" : "cannot be written") +
                  " (GDAL: " + OneLine(failure_) + ")",
              written == nullptr ? "make it again" : "choose another folder, or check the disk");
}

GDALDriverH GdalDriver(const char* name) { return GDALGetDriverByName(name); }

char** GdalStrings::List() {
  list_.clear();
  for (std::string& text : strings_) list_.push_back(text.data());
  list_.push_back(nullptr);
  return list_.data();
}

}  // namespace colmap_seapoint
