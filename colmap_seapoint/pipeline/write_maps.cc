#include "colmap_seapoint/pipeline/write_maps.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/base/run_options.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/colmap/dense_workspace.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/system/memory_budget.h"
#include "densify/densify_pair.h"
#include "densify/maps/undistortion.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr size_t kBlockPoints = 8192;
constexpr double kMaxBytesAtOnce = 1.5e9;  // of maps and pictures that are being made
constexpr double kBytesPerPixel = 17 + 3 * 3;

// Whether one of them is the other or lies in it.
bool AreNested(const fs::path& one, const fs::path& other) {
  std::error_code ignored;
  const fs::path a = fs::weakly_canonical(fs::absolute(one), ignored);
  const fs::path b = fs::weakly_canonical(fs::absolute(other), ignored);
  const auto [in_a, in_b] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  const auto is_end = [](auto it, const fs::path& path) {
    return it == path.end() || (it->empty() && std::next(it) == path.end());  // "folder/"
  };
  return is_end(in_a, a) || is_end(in_b, b);
}

bool IsGray(const ColorImage& picture) {
  for (size_t i = 0; i < picture.data.size(); i += 3) {
    if (picture.data[i] != picture.data[i + 1] || picture.data[i] != picture.data[i + 2]) {
      return false;
    }
  }
  return true;
}

Image<uint8_t> FirstChannel(const ColorImage& picture) {
  Image<uint8_t> gray(picture.width, picture.height);
  for (size_t i = 0; i < gray.data.size(); ++i) gray.data[i] = picture.data[3 * i];
  return gray;
}

// Clears what the mask (of `from`; empty: none) hides, in maps of the undistorted camera `to`.
void HideMasked(const GrayImage& mask, const Camera& from, const Camera& to, ViewMaps* maps) {
  if (mask.Empty()) return;
  for (int y = 0; y < maps->depth.height; ++y) {
    for (int x = 0; x < maps->depth.width; ++x) {
      if (!(maps->depth.At(x, y) > 0)) continue;
      // A map's value at (x, y) is that of the ray through the place (x, y) (view_maps.h).
      const auto ray = to.CamFromImg({x, y});
      const auto pixel = ray ? from.ImgFromCam(ray->homogeneous()) : std::nullopt;
      if (!pixel || !from.InImage(*pixel)) continue;
      const int column = std::min(mask.width - 1, static_cast<int>(pixel->x()));
      const int row = std::min(mask.height - 1, static_cast<int>(pixel->y()));
      if (mask.At(column, row) != 0) continue;
      maps->depth.At(x, y) = 0;
      for (int c = 0; c < 3; ++c) maps->normal.At(x, y, c) = 0;
    }
  }
}

}  // namespace

void CheckMapFolders(const fs::path& image_path, const fs::path& input_path,
                     const fs::path& output_path) {
  if (AreNested(output_path / "images", image_path)) {
    throw Error(output_path.string(),
                "its images/ is, or is in, or holds the --image_path: "
                "PartialDensification.write_maps would write undistorted pictures over yours",
                "choose another --output_path");
  }
  if (AreNested(output_path / "sparse", input_path)) {
    throw Error(output_path.string(),
                "its sparse/ is, or is in, or holds the --input_path: "
                "PartialDensification.write_maps would write the undistorted model over yours",
                "choose another --output_path");
  }
}

MapWriter::MapWriter(const SparseModel& model, const fs::path& image_path,
                     const PictureMasks& masks, const fs::path& output_path,
                     const PartialDensificationOptions& options, int num_threads)
    : model_(model),
      image_path_(image_path),
      output_path_(output_path),
      masks_(masks),
      options_(options),
      num_threads_(num_threads) {
  for (const auto& [camera_id, camera] : model.cameras) {
    undistorted_[camera_id] = UndistortedCamera(camera);
  }
}

void MapWriter::WriteModel(const SparseModel& model) const {
  WriteSparseModelBinary(output_path_ / "sparse", UndistortedModel(model));
}

MapWriter::Sphere MapWriter::SphereOf(const std::vector<Eigen::Vector3f>& points) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& point : points) box.extend(point);
  Sphere sphere{box.center(), 0};
  for (const Eigen::Vector3f& point : points) {
    sphere.radius = std::max(sphere.radius, (point - sphere.center).norm());
  }
  sphere.radius *= 1.01f;  // patches reach beyond their samples
  return sphere;
}

void MapWriter::AddPair(const PartialCloud& part, uint64_t first_point) {
  Pair pair;
  pair.image_idx1 = part.image_idx1;
  pair.image_idx2 = part.image_idx2;
  std::vector<Eigen::Vector3f> all, block;
  const auto end_block = [&] {
    if (block.empty()) return;
    pair.blocks.push_back({first_point, static_cast<uint32_t>(block.size()), SphereOf(block)});
    first_point += block.size();
    block.clear();
  };
  for (const DensePoint& point : part.points) {
    if (!point.xyz.allFinite() || !point.normal.allFinite() || !std::isfinite(point.confidence)) {
      continue;  // not in the file
    }
    all.push_back(point.xyz);
    block.push_back(point.xyz);
    if (block.size() == kBlockPoints) end_block();
  }
  end_block();
  if (all.empty()) return;
  pair.sphere = SphereOf(all);
  pairs_.push_back(std::move(pair));
}

ViewMaps MapWriter::DrawMaps(size_t image_idx, const CloudRanges& cloud) const {
  const PosedImage& image = model_.images[image_idx];
  ViewMapRenderer renderer(undistorted_.at(image.camera_id), image.cam_from_world);
  const auto in_view = [&](const Sphere& sphere) {
    return renderer.MayShow(sphere.center.cast<double>(), sphere.radius);
  };
  std::vector<DensePoint> points;
  for (const Pair& pair : pairs_) {
    if (!in_view(pair.sphere)) continue;
    const PosedImage& image1 = model_.images[static_cast<size_t>(pair.image_idx1)];
    const PosedImage& image2 = model_.images[static_cast<size_t>(pair.image_idx2)];
    const Camera& camera1 = model_.cameras.at(image1.camera_id);
    const auto geometry = MakePairGeometry(
        camera1, image1.cam_from_world, model_.cameras.at(image2.camera_id), image2.cam_from_world);
    SEAPOINT_CHECK(geometry.has_value());  // it has been densified
    const SampleFrame frame{*geometry, static_cast<double>(SampleStep(camera1, options_.step))};
    for (const Block& block : pair.blocks) {
      if (!in_view(block.sphere)) continue;
      points.clear();
      for (const CloudPoint& point : cloud.Read(block.first, block.count)) {
        points.push_back({point.xyz, point.normal, point.rgb, point.confidence});
      }
      renderer.Add(frame, points.data(), points.size());
    }
  }
  return renderer.Finish();
}

void MapWriter::WritePicture(size_t image_idx, const ColorImage& picture) const {
  const PosedImage& image = model_.images[image_idx];
  const Camera& from = model_.cameras.at(image.camera_id);
  const fs::path target = UndistortedImagePath(output_path_, image.name);
  if (from.model == CameraModel::kPinhole || from.model == CameraModel::kSimplePinhole) {
    return CopyFileAtomically(image_path_ / image.name, target);
  }
  const Camera& to = undistorted_.at(image.camera_id);
  WriteImage(target, UndistortPicture(IsGray(picture) ? FirstChannel(picture) : picture, from, to));
}

// Why the picture is left out, or "".
std::string MapWriter::WriteView(size_t image_idx, const CloudRanges& cloud) const {
  const PosedImage& image = model_.images[image_idx];
  GrayImage mask;
  {
    const Camera& camera = model_.cameras.at(image.camera_id);
    ColorImage picture;
    try {
      picture = ReadColorImage(image_path_ / image.name);
      mask = masks_.ReadForResampling(image.name, camera.width, camera.height);
    } catch (const Error& error) {
      return error.Finding();
    }
    if (picture.width != camera.width || picture.height != camera.height) {
      return "is of another size than its camera";
    }
    WritePicture(image_idx, picture);
  }
  ViewMaps maps = DrawMaps(image_idx, cloud);
  HideMasked(mask, model_.cameras.at(image.camera_id), undistorted_.at(image.camera_id), &maps);
  WriteDenseMap(DepthMapPath(output_path_, image.name), maps.depth);
  WriteDenseMap(NormalMapPath(output_path_, image.name), maps.normal);
  return "";
}

int MapWriter::NumViewsAtOnce() const {
  double max_bytes = 1;
  for (const PosedImage& image : model_.images) {
    const Camera& from = model_.cameras.at(image.camera_id);
    const Camera& to = undistorted_.at(image.camera_id);
    const double pixels = std::max(static_cast<double>(from.width) * from.height,
                                   static_cast<double>(to.width) * to.height);
    max_bytes = std::max(max_bytes, kBytesPerPixel * pixels);
  }
  const double most = std::min(kMaxBytesAtOnce, 0.5 * static_cast<double>(MaxMemory()));
  return std::clamp(static_cast<int>(most / max_bytes), 1, num_threads_);
}

void MapWriter::WriteMaps(const std::vector<LeftOutPicture>& left_out, RunReport* report) const {
  std::vector<std::string> problems(model_.images.size()), found(problems);
  for (const LeftOutPicture& picture : left_out) {
    problems[static_cast<size_t>(picture.image_idx)] = picture.reason;
  }
  std::vector<std::string> names;
  for (const PosedImage& image : model_.images) names.push_back(image.name);
  CreateDenseWorkspaceFolders(output_path_, names);
  RemoveStereoConfigs(output_path_);
  const CloudRanges cloud(output_path_ / "fused.ply");
  Progress progress("Depth maps", static_cast<int64_t>(names.size()), 0, Work::kMaps);
  std::mutex mutex;
  int64_t num_done = 0;
  ParallelFor(NumViewsAtOnce(), static_cast<int64_t>(names.size()), [&](int64_t index) {
    const auto i = static_cast<size_t>(index);
    if (problems[i].empty()) problems[i] = found[i] = WriteView(i, cloud);
    const std::lock_guard<std::mutex> lock(mutex);
    progress.Update(++num_done);
  });
  progress.Finish();
  std::vector<std::string> with_maps;
  for (size_t i = 0; i < names.size(); ++i) {
    if (problems[i].empty()) with_maps.push_back(names[i]);
    if (!found[i].empty()) LeaveOut(names[i], found[i], report);
  }
  WriteStereoConfigs(output_path_, with_maps);
}

}  // namespace colmap_seapoint
