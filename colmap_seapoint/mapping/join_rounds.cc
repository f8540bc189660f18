#include "colmap_seapoint/mapping/join_rounds.h"

#include <algorithm>
#include <set>
#include <utility>

#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/joining/join_models.h"
#include "colmap_seapoint/mapping/mapper_process.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

std::string Contents(const fs::path& folder) {
  const SparseModel model = ReadSparseModel(folder, ModelContent::kPosesAndPoints);
  std::string text = std::to_string(model.images.size()) + " pictures, from ";
  std::set<std::string> names;
  for (const PosedImage& image : model.images) names.insert(image.name);
  return names.empty() ? "no pictures" : text + *names.begin() + " to " + *names.rbegin();
}

// Tries all pairs, in the models' order, that were not tried before.
class Joiner {
 public:
  Joiner(const MapperJob& job, const std::function<void(const fs::path&)>& polish)
      : job_(job), polish_(polish), models_(ListModels(job.output_path)) {
    options_.refine_lens = job.lens == LensRule::kFind;
    options_.refine_principal_point = job.adjusts_principal_point;
    options_.num_threads = job.num_threads;
    std::stable_sort(models_.begin(), models_.end(), [](const fs::path& a, const fs::path& b) {
      return NumPictures(a) > NumPictures(b);
    });
  }

  void Run() {
    const ColmapDatabase database(job_.database_path, ColmapDatabase::Mode::kReadOnly,
                                  ColmapDatabase::Check::kNone);
    for (size_t i = 0; i < models_.size(); ++i) {
      for (size_t j = i + 1; j < models_.size();) {
        // What was passed over may be tied to what has been joined since.
        j = Join(database, models_[i], models_[j]) ? (Drop(j), i + 1) : j + 1;
      }
    }
    Renumber();
    WriteTextFile(job_.log_folder / "joining.txt", report_);
  }

 private:
  static size_t NumPictures(const fs::path& folder) {
    return ReadSparseModel(folder, ModelContent::kPosesAndPoints).images.size();
  }

  bool Join(const ColmapDatabase& database, const fs::path& larger, const fs::path& smaller) {
    JoinedModel joined = TryToJoin(database, larger, smaller);
    const std::string line = "(" + Contents(larger) + ") and (" + Contents(smaller) +
                             "): " + (joined.model ? "joined " : "apart: ") + joined.outcome;
    report_ += line + "\n";
    LogInfo("Models " + line);
    if (!joined.model) return false;
    WriteSparseModelBinary(larger, *joined.model);
    joined.model.reset();
    polish_(larger);
    return true;
  }

  JoinedModel TryToJoin(const ColmapDatabase& database, const fs::path& larger,
                        const fs::path& smaller) const {
    const Progress progress("Two models tried to be joined", 1, 0, Work::kJoining);
    return JoinModels(database, ReadSparseModel(smaller), ReadSparseModel(larger), options_);
  }

  void Drop(size_t j) {
    fs::remove_all(models_[j]);
    models_.erase(models_.begin() + static_cast<std::ptrdiff_t>(j));
  }

  // By way of other names, for a number may still be taken.
  void Renumber() {
    for (size_t i = 0; i < models_.size(); ++i) {
      fs::rename(models_[i], job_.output_path / ("joined_" + std::to_string(i)));
    }
    for (size_t i = 0; i < models_.size(); ++i) {
      fs::rename(job_.output_path / ("joined_" + std::to_string(i)),
                 job_.output_path / std::to_string(i));
    }
  }

  const MapperJob& job_;
  const std::function<void(const fs::path&)>& polish_;
  std::vector<fs::path> models_;  // the largest first
  JoinOptions options_;
  std::string report_;
};

}  // namespace

void JoinModelsOfRounds(const MapperJob& job, const std::function<void(const fs::path&)>& polish) {
  if (ListModels(job.output_path).size() < 2) return;
  Joiner(job, polish).Run();
}

}  // namespace colmap_seapoint
