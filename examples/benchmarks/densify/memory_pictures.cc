#include "examples/benchmarks/densify/memory_pictures.h"

#include <time.h>

#include <algorithm>
#include <utility>

#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "examples/benchmarks/densify/cpu_seconds.h"
#include "examples/benchmarks/feature/row_csv.h"

namespace colmap_seapoint {
namespace {

int64_t ThreadCpuNanoseconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return int64_t{now.tv_sec} * 1000000000 + now.tv_nsec;
}

std::optional<ColmapDatabase> OpenDatabase(const std::string& path) {
  if (path.empty()) return std::nullopt;
  return ColmapDatabase(path, ColmapDatabase::Mode::kReadOnly);
}

}  // namespace

MemoryPictures::MemoryPictures(const SparseModel& model, const std::filesystem::path& image_path,
                               const std::string& database_path, int num_threads)
    : database_(OpenDatabase(database_path)),
      source_(model, image_path, PictureMasks(""), database_ ? &*database_ : nullptr,
              SeaPointExtractionOptions(), SeaPointMatchingOptions()) {
  pictures_.resize(model.images.size());
  features_.resize(model.images.size());
  ParallelFor(num_threads, static_cast<int64_t>(model.images.size()), [&](int64_t i) {
    pictures_[static_cast<size_t>(i)] = source_.ReadPicture(static_cast<int>(i));
  });
  for (size_t i = 0; i < model.images.size(); ++i) {
    if (auto stored = source_.ReadSeaPoints(static_cast<int>(i))) {
      features_[i] = std::move(*stored);
      continue;
    }
    seapoint_cpu_ += CpuSecondsOf([&] { features_[i] = source_.FindSeaPoints(pictures_[i]); });
  }
  if (source_.NumInDatabase() > 0) seapoint_cpu_ = kNotMeasured;
}

Picture MemoryPictures::ReadPicture(int image_idx) {
  return pictures_.at(static_cast<size_t>(image_idx));
}

std::optional<Features> MemoryPictures::ReadSeaPoints(int image_idx) {
  return features_.at(static_cast<size_t>(image_idx));
}

Features MemoryPictures::FindSeaPoints(const Picture& picture) {
  return source_.FindSeaPoints(picture);
}

std::optional<FeatureMatches> MemoryPictures::ReadMatches(int image_idx1, int image_idx2) {
  if (dropped_) return std::nullopt;
  return source_.ReadMatches(image_idx1, image_idx2);
}

FeatureMatches MemoryPictures::Match(const Features& features1, const Features& features2) {
  const int64_t start = ThreadCpuNanoseconds();
  FeatureMatches matches = source_.Match(features1, features2);
  match_nanoseconds_ += ThreadCpuNanoseconds() - start;
  return matches;
}

void MemoryPictures::DropSeaPoints(int image_idx, const std::vector<Eigen::Vector2d>& places,
                                   double radius) {
  dropped_ = true;
  Features& features = features_.at(static_cast<size_t>(image_idx));
  Features kept;
  for (size_t i = 0; i < features.points.size(); ++i) {
    const Eigen::Vector2d at(features.points[i].x, features.points[i].y);
    const bool drop = std::any_of(places.begin(), places.end(), [&](const Eigen::Vector2d& place) {
      return (place - at).squaredNorm() <= radius * radius;
    });
    if (drop) continue;
    kept.points.push_back(features.points[i]);
    kept.descriptors.push_back(features.descriptors[i]);
    if (!features.sift_descriptors.empty()) {
      kept.sift_descriptors.push_back(features.sift_descriptors[i]);
    }
  }
  features = std::move(kept);
}

double MemoryPictures::Megapixels() const {
  double pixels = 0;
  for (const Picture& picture : pictures_) {
    pixels += static_cast<double>(picture.luma.width) * picture.luma.height;
  }
  return 1e-6 * pixels;
}

}  // namespace colmap_seapoint
