#include "colmap_seapoint/mapping/lens_pilot.h"

#include <string>
#include <vector>

#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "colmap_seapoint/lens/choose_lens.h"
#include "colmap_seapoint/mapping/sound_adjustment.h"
#include "colmap_seapoint/tracks/pilot_pictures.h"

namespace colmap_seapoint {
namespace {

constexpr uint32_t kPilotPictures = 60;

std::vector<std::string> PilotPictures(const ColmapDatabase& database) {
  const std::vector<DatabaseImage> images = ReadImages(database);
  std::map<uint32_t, uint32_t> indices;
  for (const DatabaseImage& image : images) {
    indices.emplace(image.image_id, static_cast<uint32_t>(indices.size()));
  }
  std::vector<TiedPair> pairs;
  for (const ImagePair& pair : ReadVerifiedPairs(database)) {
    const size_t num_matches = ReadTwoViewGeometry(database, pair).inliers.size();
    pairs.push_back(
        {indices.at(pair.first), indices.at(pair.second), static_cast<uint32_t>(num_matches)});
  }
  std::vector<std::string> names;
  for (const uint32_t i :
       ChoosePilotPictures(static_cast<uint32_t>(images.size()), pairs, kPilotPictures)) {
    names.push_back(images[i].name);
  }
  return names;
}

// The model of most pictures.
SparseModel LargestModel(const std::filesystem::path& folder) {
  SparseModel largest;
  for (const auto& path : ListModels(folder)) {
    SparseModel model = ReadSparseModel(path);
    if (model.images.size() > largest.images.size()) largest = std::move(model);
  }
  return largest;
}

}  // namespace

std::map<uint32_t, Camera> LearnLenses(const ColmapProgram& colmap, MapperCall call,
                                       bool frees_principal_point, int num_threads) {
  {
    const ColmapDatabase database(call.database_path, ColmapDatabase::Mode::kReadOnly,
                                  ColmapDatabase::Check::kNone);
    call.pictures = PilotPictures(database);
  }
  call.num_pictures = call.pictures.size();
  if (call.pictures.empty() || !RunMapperProcess(colmap, call).is_usable) return {};
  const SparseModel model = LargestModel(call.output_path);
  if (2 * model.images.size() < call.pictures.size()) return {};
  LensLimits limits;
  limits.form = FirstForm(frees_principal_point);
  limits.num_threads = num_threads;
  SoundAdjustment sound = AdjustSoundly(model, limits);
  if (!sound.fault.empty()) return {};
  LensChoiceOptions choice;
  choice.principal_point = limits.form.principal_point;
  choice.num_threads = num_threads;
  limits.form.has_two_focals = ChooseLens(choice, sound.adjustment.model).form.has_two_focals;
  if (limits.form.has_two_focals) sound = AdjustSoundly(sound.adjustment.model, limits);
  if (!sound.fault.empty()) return {};
  const SparseModel& adjusted = sound.adjustment.model;
  std::map<uint32_t, Camera> lenses;
  for (const PosedImage& image : adjusted.images) {
    lenses.emplace(image.camera_id, adjusted.cameras.at(image.camera_id));
  }
  LogInfo("Lens from " + std::to_string(adjusted.images.size()) + " pictures: focal length " +
          std::to_string(lenses.begin()->second.MeanFocal()) + " px");
  return lenses;
}

}  // namespace colmap_seapoint
