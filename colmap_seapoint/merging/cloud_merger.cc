#include "colmap_seapoint/merging/cloud_merger.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <sstream>
#include <utility>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/median.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/compare/point_index.h"
#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/cloud/ply_reader.h"
#include "colmap_seapoint/io/cloud/seen_cloud.h"
#include "colmap_seapoint/io/outputs/output_folder.h"
#include "colmap_seapoint/merging/known_places.h"
#include "colmap_seapoint/workspace/output_paths.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr size_t kSampled = 1000;    // points
constexpr size_t kAroundEach = 100;  // of their neighbours

std::vector<fs::path> PathsOf(const CloudMergerOptions& options) {
  std::vector<fs::path> paths;
  std::istringstream names(options.input_path);
  for (std::string name; std::getline(names, name, ',');) {
    if (!name.empty()) paths.emplace_back(name);
  }
  if (paths.size() < 2) {
    throw UsageError("--input_path " + options.input_path +
                     ": must be two clouds or more, with commas between");
  }
  for (const fs::path& path : paths) {
    std::error_code ignored;
    if (!fs::equivalent(path, options.output_path, ignored)) continue;
    throw UsageError("--output_path: " + path.string() + " is one of the clouds that are read");
  }
  return paths;
}

// Points of a pair stand one after the other: from the middle on, so many that most have their
// neighbours among them.
PointVector RunOfPoints(const fs::path& path) {
  CloudReader cloud(path);
  PointVector run;
  CloudVertex vertex;
  for (uint64_t i = 0; cloud.Next(&vertex) && run.size() < kSampled * kAroundEach; ++i) {
    if (i >= cloud.NumPoints() / 2) run.push_back(vertex.xyz);
  }
  std::sort(run.begin(), run.end(), [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  });
  run.erase(std::unique(run.begin(), run.end()), run.end());
  return run;
}

// The distance to the nearest other point, of half of them.
double SpacingOf(const fs::path& path) {
  const PointVector run = RunOfPoints(path);
  if (run.size() < 2) {
    throw Error(path.string(), "has too few points to tell their spacing", "give --spacing");
  }
  const PointIndex index(run);
  std::vector<double> distances;
  const size_t stride = std::max<size_t>(1, run.size() / kSampled);
  for (size_t i = 0; i < run.size(); i += stride) {
    double squared = kBeyond;
    index.Nearest(run[i], NearestOf::kOtherPlace, &squared);
    distances.push_back(std::sqrt(squared));
  }
  return UpperMedian(std::move(distances));
}

using Visit = std::function<void(const CloudPoint&, const std::vector<uint32_t>&)>;

void ReadPoints(const fs::path& path, bool tells_pictures, const Visit& visit) {
  if (tells_pictures) {
    ReadSeenCloud(path, [&](const CloudPoint& point, uint32_t a, uint32_t b) {
      visit(point, {a, b});
    });
    return;
  }
  CloudReader cloud(path);
  CloudVertex vertex;
  while (cloud.Next(&vertex)) {
    visit({vertex.xyz.cast<float>(), vertex.normal, vertex.rgb, vertex.confidence}, {});
  }
}

// What is new in each cloud. Returns how many points were read.
uint64_t Merge(const std::vector<fs::path>& paths, double spacing, CloudWriter* cloud) {
  const bool tell_pictures = std::all_of(paths.begin(), paths.end(), [](const fs::path& path) {
    return fs::exists(path.string() + ".vis");
  });
  KnownPlaces known(spacing);
  uint64_t num_read = 0;
  for (const fs::path& path : paths) {
    ReadPoints(path, tell_pictures,
               [&](const CloudPoint& point, const std::vector<uint32_t>& pictures) {
                 ++num_read;
                 const Eigen::Vector3d place = point.xyz.cast<double>();
                 if (known.IsNear(place)) return;
                 known.Add(place);
                 cloud->Add(point, pictures.data(), static_cast<uint32_t>(pictures.size()));
               });
    known.Settle();
  }
  return num_read;
}

}  // namespace

void CloudMergerOptions::Bind(OptionTable* table) {
  table->AddRequired("input_path", &input_path,
                     "clouds in one frame, PLY, separated by commas; where two show a place, the "
                     "first one's points stay");
  table->AddRequired("output_path", &output_path, "the cloud to write, PLY");
  table->Add("spacing", &spacing,
             "between points, units of the clouds; 0 = as the first cloud has it", "ours", 0, 1e6);
  run.Bind(table);
  table->MarkOutput("output_path");
}

CommandResult RunCloudMerger(const CloudMergerOptions& options) {
  CheckOutputPaths(options);
  const std::vector<fs::path> paths = PathsOf(options);
  const fs::path output = options.output_path;
  const std::string name = output.filename().string();
  OutputFolder folder(FolderOf(output), "--output_path");
  folder.Claim({name, name + ".vis"});
  CloudWriter cloud(folder.Path() / name);
  const uint64_t num_read =
      Merge(paths, options.spacing > 0 ? options.spacing : SpacingOf(paths.front()), &cloud);
  cloud.Finish();
  LogInfo(std::to_string(cloud.NumPoints()) + " of " + std::to_string(num_read) + " points of " +
          std::to_string(paths.size()) + " clouds in " + output.string() +
          "; the others lie where an earlier cloud has points");
  return {};
}

}  // namespace colmap_seapoint
