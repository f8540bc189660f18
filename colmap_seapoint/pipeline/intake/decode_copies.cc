#include "colmap_seapoint/pipeline/intake/decode_copies.h"

#include <algorithm>
#include <map>
#include <system_error>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/io/image/camera_picture.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr char kStage[] = "copies";
// Raise it when the same picture gives another copy.
constexpr char kVersion[] = "1";
// Decoded between two records: what a killed run loses.
constexpr size_t kBatch = 32;

// Name of a copy -> version and hash of its source, and its own hash.
using Record = std::map<std::string, std::pair<std::string, std::string>>;

struct Copy {
  std::string source_name, name;
  std::string source_hash, hash;
  std::string reason;  // why there is none; empty = there is
};

Record ReadRecord(const WorkspaceState& state) {
  try {
    const auto record = state.Read(kStage);
    return record ? record->get<Record>() : Record();
  } catch (const nlohmann::json::exception&) {
    return {};
  }
}

bool IsThere(const Record& known, const Copy& copy, const fs::path& path) {
  const auto found = known.find(copy.name);
  std::error_code error;
  return found != known.end() && found->second.first == copy.source_hash &&
         fs::exists(path, error) && HashFile(path) == found->second.second;
}

// Called from several threads.
void Decode(const fs::path& source, const fs::path& folder, const Record& known, Copy* copy) {
  try {
    const fs::path from = source / copy->source_name, to = folder / copy->name;
    copy->source_hash = kVersion + (":" + HashFile(from));
    if (IsThere(known, *copy, to)) {
      copy->hash = known.at(copy->name).second;
      return;
    }
    const CameraPicture picture = ReadCameraPicture(from);
    std::error_code error;  // whose result WriteJpeg says
    fs::create_directories(to.parent_path(), error);
    WriteJpeg(to, picture.pixels, picture.exif);
    copy->hash = HashFile(to);
  } catch (const Error& error) {
    copy->reason = error.Finding();
  }
}

// The picture itself, by a link where the disk knows links.
void Hand(const fs::path& from, const std::string& name, OutputFolder* folder) {
  const fs::path to = folder->Path() / name;
  std::error_code error;
  if (folder->IsOurs(name) && fs::read_symlink(to, error) == from && !error) return;
  if (folder->IsOurs(name)) folder->Remove(name);
  folder->Claim({name});
  fs::create_directories(to.parent_path(), error);
  fs::create_symlink(from, to, error);
  if (error) CopyFileAtomically(from, to);
}

std::vector<Copy> CopiesOf(const FolderListing& listing) {
  std::vector<Copy> copies;
  for (const std::string& name : listing.camera_pictures) {
    copies.push_back({name, name + ".jpg", {}, {}, {}});
  }
  return copies;
}

void DecodeAll(const fs::path& source, int num_threads, OutputFolder* folder, WorkspaceState* state,
               std::vector<Copy>* copies) {
  const Record known = ReadRecord(*state);
  Record record = known;
  std::vector<std::string> names;
  for (const Copy& copy : *copies) names.push_back(copy.name);
  folder->Claim(names);
  Progress progress("HEIC and RAW pictures decoded", static_cast<int64_t>(copies->size()), 0,
                    Work::kIntake);
  for (size_t begin = 0; begin < copies->size(); begin += kBatch) {
    const size_t end = std::min(copies->size(), begin + kBatch);
    ParallelFor(num_threads, static_cast<int64_t>(end - begin), [&](int64_t i) {
      Decode(source, folder->Path(), known, &(*copies)[begin + static_cast<size_t>(i)]);
    });
    bool has_news = false;
    for (size_t i = begin; i < end; ++i) {
      const Copy& copy = (*copies)[i];
      const auto entry = std::pair(copy.source_hash, copy.hash);
      has_news |= copy.reason.empty() && record[copy.name] != entry;
      if (copy.reason.empty()) record[copy.name] = entry;
    }
    if (has_news) state->Write(kStage, record);
    progress.Update(static_cast<int64_t>(end));
  }
  progress.Finish();
}

}  // namespace

std::set<std::string> DecodeCopies(const fs::path& source, const FolderListing& listing,
                                   int num_threads, OutputFolder* folder, WorkspaceState* state,
                                   RunReport* report) {
  std::vector<Copy> copies = CopiesOf(listing);
  DecodeAll(source, EffectiveNumThreads(num_threads), folder, state, &copies);
  std::set<std::string> names;
  for (const Copy& copy : copies) {
    if (copy.reason.empty()) {
      names.insert(copy.name);
    } else {
      LeaveOut(copy.source_name, copy.reason, report);
    }
  }
  for (const std::string& name : listing.pictures) {
    // A.HEIC beside A.HEIC.jpg, which somebody has converted already.
    if (!names.insert(name).second) continue;
    Hand(source / name, name, folder);
  }
  if (!names.empty()) return names;
  throw Error((source / copies.front().source_name).string(), copies.front().reason,
              "convert the pictures to JPEG");
}

}  // namespace colmap_seapoint
