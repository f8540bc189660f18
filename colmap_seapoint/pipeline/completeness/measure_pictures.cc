#include "colmap_seapoint/pipeline/completeness/measure_pictures.h"

#include <algorithm>
#include <mutex>
#include <numeric>
#include <optional>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/io/image/picture_masks.h"
#include "colmap_seapoint/pipeline/completeness/facts_file.h"

namespace colmap_seapoint {
namespace {

class Measurer {
 public:
  Measurer(const PictureFolders& folders, MeasuredPictures known)
      : folders_(folders), masks_(folders.masks), known_(std::move(known)) {}

  // Called from several threads at once. The picture is read once: what is hashed is what is
  // decoded.
  MeasuredPicture Measure(const std::string& name) const {
    const PictureFile file(folders_.images / name);
    const std::optional<PictureFile> mask = masks_.Open(name);
    const std::string content = file.Hash() + (mask ? mask->Hash() : "");
    const auto known = known_.find(name);
    if (known != known_.end() && known->second.content == content) return known->second;
    const GrayImage luma = file.DecodeGray();
    const uint64_t sum = std::accumulate(luma.data.begin(), luma.data.end(), uint64_t{0});
    return {content, MeasurePicture(luma, masks_.Decode(name, mask, luma.width, luma.height)),
            static_cast<double>(sum) / static_cast<double>(luma.data.size())};
  }

 private:
  const PictureFolders& folders_;
  PictureMasks masks_;
  MeasuredPictures known_;
};

void Keep(const SparseModel& model, const std::vector<MeasuredPicture>& measured,
          const std::filesystem::path& path) {
  MeasuredPictures pictures;
  for (size_t i = 0; i < measured.size(); ++i) {
    if (!measured[i].facts.Empty()) pictures[model.images[i].name] = measured[i];
  }
  WriteMeasuredPictures(path, pictures);
}

}  // namespace

PictureMeasures MeasurePictures(const SparseModel& model, const PictureFolders& folders,
                                int num_threads, const std::function<void(int64_t)>& done,
                                RunReport* report) {
  const bool keeps = !folders.facts_file.empty();
  const Measurer measurer(folders,
                          keeps ? ReadMeasuredPictures(folders.facts_file) : MeasuredPictures());
  std::vector<MeasuredPicture> measured(model.images.size());
  std::vector<std::string> problems(model.images.size());
  std::mutex mutex;
  int64_t num_done = 0;
  ParallelFor(num_threads, static_cast<int64_t>(measured.size()), [&](int64_t index) {
    const auto i = static_cast<size_t>(index);
    try {
      measured[i] = measurer.Measure(model.images[i].name);
    } catch (const Error& e) {
      problems[i] = e.Finding();
    }
    const std::lock_guard<std::mutex> lock(mutex);
    done(++num_done);
  });
  if (keeps) Keep(model, measured, folders.facts_file);
  PictureMeasures measures;
  for (size_t i = 0; i < measured.size(); ++i) {
    if (!problems[i].empty()) LeaveOut(model.images[i].name, problems[i], report);
    measures.facts.push_back(std::move(measured[i].facts));
    measures.facts.back().is_bad = !problems[i].empty();
    measures.brightness.push_back(measured[i].brightness);
  }
  if (std::all_of(measures.facts.begin(), measures.facts.end(),
                  [](const PictureFacts& facts) { return facts.Empty(); })) {
    throw Error(folders.images.string(),
                "none of the model's pictures can be read (" + model.images[0].name + ": " +
                    problems[0] + ")",
                "give the --image_path that the model was made from, or none");
  }
  JudgePictures(&measures.facts);
  return measures;
}

}  // namespace colmap_seapoint
