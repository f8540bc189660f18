// Speaks the few words of COLMAP that automatic_reconstructor uses. The variable FAKE_COLMAP_MODE
// tells what its mapper does:
//   model     (default) the exact model of a synthetic strip, from the database's images
//   partial   ... without the last picture       two_models  ... as two models of half the pictures
//   two_rounds ... the first half in the first round, the others when they are asked for alone
//   no_model  ends like COLMAP 3.8 without any   crash       a half-written model, then SIGABRT
//   global    has a global_mapper too, which finds all; the mapper fails
//   global_partial  has one that leaves a picture out; the mapper finds all
//   continues  knows the options that --input_path asks for
//   babble    first prints 200 MB without the end of a line
// Its point_triangulator leaves the points as they are.
// FAKE_COLMAP_SECONDS: how long the mapper takes. FAKE_COLMAP_PID: file that gets its process id.
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "colmap_seapoint/base/natural_order.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "tests/cli/synthetic_strip.h"

namespace {

using namespace colmap_seapoint;

std::string Variable(const char* name, const std::string& fallback) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : fallback;
}

void PrintHelp() {
  std::cout
      << "COLMAP 3.8 (fake)\n\nOptions can either be specified via command-line or by ...\n\n"
      << "  -h [ --help ] \n  --random_seed arg (=0)\n  --database_path arg\n"
      << "  --image_path arg\n  --image_list_path arg\n  --input_path arg\n  --output_path arg\n  "
         "--Mapper.num_threads arg (=-1)\n"
      << "  --Mapper.min_model_size arg (=10)\n";
  if (Variable("FAKE_COLMAP_MODE", "model") != "continues") return;
  for (const char* name :
       {"fix_existing_images", "ba_refine_focal_length", "ba_refine_extra_params"}) {
    std::cout << "  --Mapper." << name << " arg (=0)\n";
  }
}

PosedImage PoseImage(const DatabaseImage& image, const Camera& camera,
                     const ColmapDatabase& database) {
  PosedImage posed;
  posed.image_id = image.image_id;
  posed.camera_id = image.camera_id;
  posed.name = image.name;
  posed.cam_from_world = StripPose(image.name, camera);
  const auto features = ReadFeatures(database, image.image_id);
  if (features) {
    for (const SeaPoint& point : features->points) posed.points2D.emplace_back(point.x, point.y);
  }
  posed.point3D_ids.assign(posed.points2D.size(), kNoPoint3D);
  return posed;
}

// Every inlier of neighbouring pictures becomes a point on the ground.
void AddPoints(const ColmapDatabase& database, SparseModel* model) {
  for (size_t i = 0; i + 1 < model->images.size(); ++i) {
    PosedImage* images[] = {&model->images[i], &model->images[i + 1]};
    if (images[0]->image_id > images[1]->image_id) std::swap(images[0], images[1]);
    const Camera& camera = model->cameras.at(images[0]->camera_id);
    const auto geometry = ReadTwoViewGeometry(database, {images[0]->image_id, images[1]->image_id});
    for (const FeatureMatch& match : geometry.inliers) {
      if (images[0]->point3D_ids[match.idx1] != kNoPoint3D) continue;
      if (images[1]->point3D_ids[match.idx2] != kNoPoint3D) continue;
      const uint64_t id = model->points3D.size() + 1;
      const auto ray = camera.CamFromImg(images[0]->points2D[match.idx1]);
      if (!ray) continue;
      SparsePoint point;
      point.xyz = images[0]->cam_from_world.Inverse() *
                  Eigen::Vector3d(kStripRange * ray->x(), kStripRange * ray->y(), kStripRange);
      point.track = {{images[0]->image_id, match.idx1}, {images[1]->image_id, match.idx2}};
      images[0]->point3D_ids[match.idx1] = id;
      images[1]->point3D_ids[match.idx2] = id;
      model->points3D[id] = point;
    }
  }
}

void WriteModel(const std::vector<DatabaseImage>& images, const ColmapDatabase& database,
                const std::string& folder) {
  SparseModel model;
  model.cameras = ReadCameras(database);
  for (const DatabaseImage& image : images) {
    model.images.push_back(PoseImage(image, model.cameras.at(image.camera_id), database));
  }
  AddPoints(database, &model);
  WriteSparseModelBinary(folder, model);
}

std::vector<DatabaseImage> ImagesInOrder(const ColmapDatabase& database) {
  std::vector<DatabaseImage> images;
  for (const DatabaseImage& image : ReadImages(database)) {
    const auto features = ReadFeatures(database, image.image_id);
    if (features && !features->points.empty()) images.push_back(image);
  }
  std::sort(images.begin(), images.end(),
            [](const auto& a, const auto& b) { return NaturalLess(a.name, b.name); });
  return images;
}

// One name a line; empty when there is no list.
std::set<std::string> ReadList(const std::string& path) {
  std::set<std::string> names;
  std::ifstream list(path);
  for (std::string name; std::getline(list, name);) names.insert(name);
  return names;
}

int RunMapper(bool is_global, std::map<std::string, std::string> options) {
  const std::string mode = Variable("FAKE_COLMAP_MODE", "model");
  const std::string pid_file = Variable("FAKE_COLMAP_PID", "");
  if (!pid_file.empty()) std::ofstream(pid_file) << getpid() << std::endl;
  const ColmapDatabase database(options["--database_path"], ColmapDatabase::Mode::kReadOnly);
  std::vector<DatabaseImage> images = ImagesInOrder(database);
  const std::set<std::string> listed = ReadList(options["--image_list_path"]);
  if (!listed.empty()) {
    const auto is_unlisted = [&](const auto& image) { return listed.count(image.name) == 0; };
    images.erase(std::remove_if(images.begin(), images.end(), is_unlisted), images.end());
  }
  if (mode == "babble") {
    const std::string words(1 << 20, 'x');
    for (int i = 0; i < 200; ++i) std::cout << words << std::flush;
  }
  const double seconds = std::atof(Variable("FAKE_COLMAP_SECONDS", "0").c_str());
  for (size_t i = 0; i < images.size(); ++i) {
    std::cout << "Registering image #" << images[i].image_id << " (" << i + 1 << ")" << std::endl;
    std::this_thread::sleep_for(
        std::chrono::duration<double>(seconds / static_cast<double>(images.size())));
  }
  const std::string output = options["--output_path"];
  if (!options["--input_path"].empty()) {
    // Goes on with a model: here, to what it would have found in the first place.
    WriteModel(images, database, output);
    return EXIT_SUCCESS;
  }
  if (mode == "no_model") {
    std::cerr << "ERROR: failed to create sparse model" << std::endl;
    return EXIT_FAILURE;
  }
  if (mode == "crash") {
    std::ofstream(output + "/half_a_model") << "x";
    raise(SIGABRT);
  }
  if (mode == "partial" || (is_global && mode == "global_partial")) images.pop_back();
  if (mode == "two_rounds" && listed.empty()) images.resize(images.size() / 2);
  if (mode == "two_models") {
    const auto middle = images.begin() + static_cast<std::ptrdiff_t>(images.size() / 2);
    WriteModel({middle, images.end()}, database, output + "/1");
    images.erase(middle, images.end());
  }
  WriteModel(images, database, output + "/0");
  return EXIT_SUCCESS;
}

// The points that are there are the best that it finds.
int RunTriangulator(std::map<std::string, std::string> options) {
  std::filesystem::copy(options["--input_path"], options["--output_path"],
                        std::filesystem::copy_options::recursive);
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const std::string mode = Variable("FAKE_COLMAP_MODE", "model");
  const bool has_global_mapper = mode.rfind("global", 0) == 0;
  if (arguments.size() == 1 && arguments[0] == "help") {
    std::cout << "Available commands:\n  mapper\n"
              << (has_global_mapper ? "  global_mapper\n" : "");
    return EXIT_SUCCESS;
  }
  const bool is_global = has_global_mapper && !arguments.empty() && arguments[0] == "global_mapper";
  const bool is_triangulator = !arguments.empty() && arguments[0] == "point_triangulator";
  if (arguments.size() < 2 || (arguments[0] != "mapper" && !is_global && !is_triangulator)) {
    return EXIT_FAILURE;
  }
  if (arguments[1] == "-h") {
    PrintHelp();
    if (is_global) std::cout << "  --GlobalMapper.num_threads arg (=-1)\n";
    return EXIT_SUCCESS;
  }
  std::map<std::string, std::string> options;
  for (size_t i = 1; i + 1 < arguments.size(); i += 2) options[arguments[i]] = arguments[i + 1];
  if (is_triangulator) return RunTriangulator(options);
  if (mode == "global" && !is_global) return EXIT_FAILURE;
  return RunMapper(is_global, options);
}
