// lens_benchmark ports: how each form of lens bends the ground of surveys through ports, whose
// observations are exact but for noise.
// lens_benchmark choose: the lens that a model's tracks prove.
// lens_benchmark bend: a model's ground against a survey's truth.
#include <boost/program_options.hpp>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "colmap_seapoint/adjustment/bundle_adjustment.h"
#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/timer.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/lens/choose_lens.h"
#include "colmap_seapoint/lens/ground_bend.h"
#include "colmap_seapoint/lens/held_out_tracks.h"
#include "colmap_seapoint/lens/refraction_sign.h"
#include "examples/subcommands.h"
#include "examples/survey/alignment.h"
#include "examples/survey/scene/noise.h"
#include "examples/survey/survey.h"

namespace colmap_seapoint {
namespace {

namespace po = boost::program_options;

constexpr char kUsage[] =
    "lens_benchmark ports [options]\n"
    "lens_benchmark choose --input_path MODEL [options]\n"
    "lens_benchmark bend --survey_path DIR --input_path MODEL\n"
    "lens_benchmark <command> -h lists the options.\n";

constexpr double kWay = 10;  // metres

// The rise in the middle of 10 metres of the survey's way by which the model's points are off the
// truth's surface, metres; and the camera centres likewise.
struct Bends {
  double of_ground = 0, of_centres = 0;
};

Bends BendsOf(const SurveyTruth& truth, const SparseModel& model) {
  const Similarity3d truth_from_model = AlignCentres(truth.model, model, false).truth_from_model;
  const auto frame = FindGroundFrame(truth.model);
  if (!frame) throw Error("the survey", "has too few pictures", "make a longer one");
  const double per_curvature = 0.25 * kWay * kWay;
  const double sign = frame->up.z() > 0 ? 1 : -1;
  Bends bends;
  std::vector<Eigen::Vector3d> places;
  std::vector<double> heights;
  const auto curvature = [&]() {
    return sign *
           CurvatureOf(places, Eigen::Map<Eigen::VectorXd>(heights.data(), heights.size()), *frame);
  };
  for (const auto& [id, point] : model.points3D) {
    const Eigen::Vector3d place = truth_from_model * point.xyz;
    const double off = place.z() - truth.surface.Ground().Height(place.x(), place.y());
    if (!(std::abs(off) < 64 * truth.gsd)) continue;
    places.push_back(place);
    heights.push_back(off);
  }
  bends.of_ground = per_curvature * curvature();
  places.clear();
  heights.clear();
  for (const PosedImage& exact : truth.model.images) {
    for (const PosedImage& image : model.images) {
      if (image.name != exact.name) continue;
      places.push_back(exact.cam_from_world.OriginInSource());
      heights.push_back(
          (truth_from_model * image.cam_from_world.OriginInSource() - places.back()).z());
    }
  }
  bends.of_centres = per_curvature * curvature();
  return bends;
}

double Gaussian(uint64_t seed, size_t i) {
  const auto index = static_cast<int64_t>(i);
  const double u = Uniform(Hash(seed, index, 0)), v = Uniform(Hash(seed, index, 1));
  return std::sqrt(-2 * std::log(1 - u)) * std::cos(6.283185307179586 * v);
}

void AddNoise(double sigma, SparseModel* model) {
  size_t count = 0;
  for (PosedImage& image : model->images) {
    for (Eigen::Vector2d& pixel : image.points2D) {
      pixel.x() += sigma * Gaussian(7, ++count);
      pixel.y() += sigma * Gaussian(7, ++count);
    }
  }
}

// The model with no more known of the lens than that it has none of a distortion.
SparseModel AsKnownBefore(const SparseModel& truth, double noise) {
  TrackSplit split;
  split.max_fitted_observations = 20000;
  SparseModel model = Split(split, truth).fitted;
  Camera& camera = model.cameras.at(1);
  const double focal = camera.MeanFocal();
  camera = MakeCamera(CameraModel::kOpenCV, 1.02 * focal, camera.width, camera.height);
  camera.camera_id = 1;
  AddNoise(noise, &model);
  return model;
}

void PrintRow(const SurveyTruth& truth, const SparseModel& start, const LensForm& form) {
  SparseModel model = start;
  for (auto& [id, camera] : model.cameras) camera = InForm(form, camera);
  BundleAdjustmentOptions options;
  options.lenses[1] = FreedomOf(form);
  const auto adjusted = AdjustBundleInFull(options, model);
  if (!adjusted) return;
  const Bends bends = BendsOf(truth, adjusted->model);
  std::printf("  %-32s %8.2f %8.2f %9.3f\n", Describe(form).c_str(), bends.of_ground / truth.gsd,
              bends.of_centres / truth.gsd, adjusted->error_sigma);
}

void PrintChoice(const SurveyTruth& truth, const SparseModel& start) {
  BundleAdjustmentOptions options;
  options.lenses[1].ties_focals = true;
  const auto first = AdjustBundle(options, start);
  if (!first) return;
  LensChoice choice = ChooseLens({}, *first);
  SparseModel model = *first;
  model = InForm(choice.form, std::move(model));
  options.lenses[1] = FreedomOf(choice.form);
  const auto frame = FindGroundFrame(model);
  if (frame) options.centre_weights = CurvatureWeights(model, *frame);
  const auto adjusted = AdjustBundleInFull(options, model);
  if (!adjusted || !frame) return;
  std::printf(
      "  chosen: %s; bend %.2f GSD, said to be within %.2f (noise) and %.2f (forms); "
      "sign of refraction %.1f\n",
      choice.said.c_str(), BendsOf(truth, adjusted->model).of_ground / truth.gsd,
      2 * adjusted->centre_sigma * 25 / truth.gsd, choice.bend * 25 / truth.gsd,
      RefractionSign(adjusted->model));
}

int Ports(const std::vector<std::string>& arguments) {
  double noise = 0.1;
  int num_strips = 3;
  double relief = 1;
  po::options_description description("lens_benchmark ports");
  auto add = description.add_options();
  add("help,h", "this text");
  add("noise", Default(&noise), "of the observations, pixels");
  add("relief", Default(&relief), "factor on the seabed's heights");
  add("num_strips", Default(&num_strips), "of 12 metres");
  if (!ParseOptions(description, arguments)) return 0;
  struct Case {
    const char* name;
    PortOptions port;
  };
  PortOptions flat, dome;
  flat.kind = PortKind::kFlat;
  dome.kind = PortKind::kDome;
  dome.decentring = 0.01;
  // A dome around the entrance pupil is no port to the rays.
  const Case cases[] = {{"none", {}}, {"flat", flat}, {"dome, 10 mm off", dome}};
  for (const Case& c : cases) {
    for (const double altitude : {1.0, 2.0, 4.0}) {
      SurveyOptions o;
      o.width = 800;
      o.height = 600;
      o.port = c.port;
      o.altitude = altitude;
      o.num_strips = num_strips;
      o.relief = relief;
      o.images_per_strip = static_cast<int>(12 / (0.25 * NominalGsd(o) * o.height));
      const SurveyTruth truth = MakeSurveyTruth(o);
      std::printf(
          "port %s, %.0f m, %zu pictures: bend of the ground and the centres over 10 m in "
          "GSD, sigma of the errors in px\n",
          c.name, altitude, truth.model.images.size());
      const SparseModel start = AsKnownBefore(truth.model, noise);
      for (const auto& forms : LensFormSteps(PrincipalPoint::kFree)) {
        for (const LensForm& form : forms) PrintRow(truth, start, form);
      }
      PrintChoice(truth, start);
      std::fflush(stdout);
    }
  }
  return 0;
}

int Choose(const std::vector<std::string>& arguments) {
  std::string input_path;
  po::options_description description("lens_benchmark choose");
  auto add = description.add_options();
  add("help,h", "this text");
  add("input_path", po::value(&input_path)->required(), "COLMAP model");
  if (!ParseOptions(description, arguments)) return 0;
  const SparseModel model = ReadSparseModel(input_path);
  const Timer timer;
  const LensChoice choice = ChooseLens({}, model);
  std::printf("%s; %.2f CPU s\n", choice.said.c_str(), timer.CpuSeconds());
  return 0;
}

int Bend(const std::vector<std::string>& arguments) {
  std::string survey_path, input_path;
  po::options_description description("lens_benchmark bend");
  auto add = description.add_options();
  add("help,h", "this text");
  add("survey_path", po::value(&survey_path)->required(), "folder of demo_survey generate");
  add("input_path", po::value(&input_path)->required(), "estimated COLMAP model");
  if (!ParseOptions(description, arguments)) return 0;
  const SurveyTruth truth = ReadSurveyTruth(survey_path);
  const SparseModel model = ReadSparseModel(input_path);
  const Bends bends = BendsOf(truth, model);
  std::printf(
      "over 10 m: ground %.2f GSD, camera centres %.2f GSD; centres rms %.3f mm; sign of "
      "refraction %.1f\n",
      bends.of_ground / truth.gsd, bends.of_centres / truth.gsd,
      1000 * AlignCentres(truth.model, model, false).rms, RefractionSign(model));
  return 0;
}

}  // namespace
}  // namespace colmap_seapoint

int main(int argc, char** argv) {
  using namespace colmap_seapoint;
  return RunSubcommands(argc, argv, "lens_benchmark", kUsage,
                        {{"ports", Ports}, {"choose", Choose}, {"bend", Bend}});
}
