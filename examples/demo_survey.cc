// demo_survey generate: pictures of a made-up seabed with their exact truth.
// demo_survey control: a scale bar and noisy positions for such a survey.
// demo_survey markers: which of its coded markers were found, and how exactly.
// demo_survey score: a COLMAP model and its dense cloud against that truth.
#include <boost/program_options.hpp>
#include <cstdio>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/timer.h"
#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/markers_csv.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "examples/subcommands.h"
#include "examples/survey/control.h"
#include "examples/survey/paths/dive_passes.h"
#include "examples/survey/score.h"
#include "examples/survey/score_markers.h"
#include "examples/survey/survey.h"
#include "examples/survey/view_gsd.h"

namespace colmap_seapoint {
namespace {

namespace po = boost::program_options;

constexpr char kUsage[] =
    "demo_survey generate --output_path DIR [options]\n"
    "demo_survey control --survey_path DIR --output_path DIR [options]\n"
    "demo_survey markers --survey_path DIR --markers_path found_markers.csv\n"
    "demo_survey score --survey_path DIR --input_path MODEL --cloud_path fused.ply [options]\n"
    "demo_survey <command> -h lists the options.\n";

void AddTrackOptions(po::options_description* description, SurveyOptions* o) {
  auto add = description->add_options();
  add("num_strips", Default(&o->num_strips), "lawn-mower strips, lanes, rows, rings or dives");
  add("images_per_strip", Default(&o->images_per_strip),
      "pictures a strip; 0: a ring or a dive has as many as forward_overlap asks for");
  add("revisit", Default(&o->revisit),
      "pictures taken over the first strip again at the end, from another height and heading");
  add("forward_overlap", Default(&o->forward_overlap),
      "with the next picture, 0..0.98 (0.98: as a video of 30 pictures a second)");
  add("side_overlap", Default(&o->side_overlap), "with the next strip, 0..0.98");
  add("altitude", Default(&o->altitude), "above the seabed, or to wall and statue, metres");
  add("pitch", Default(&o->pitch_deg), "of a swim: degrees below the horizon, 10..90");
  add("roll", Default(&o->roll_deg),
      "of every second picture against the first, about its axis, degrees, -180..180");
  add("jitter", Default(&o->jitter), "factor on the vehicle's unsteadiness");
}

void AddPictureOptions(po::options_description* description, SurveyOptions* o) {
  auto add = description->add_options();
  add("width", Default(&o->width), "of a picture, pixels");
  add("height", Default(&o->height), "of a picture, pixels");
  add("field_of_view", Default(&o->field_of_view_deg),
      "horizontal, degrees, 20..80 (OPENCV) or 20..150 (OPENCV_FISHEYE)");
  add("noise", Default(&o->noise), "factor on the sensor noise");
  add("image_format", Default(&o->image_format), "jpg or png");
}

void AddWaterOptions(po::options_description* description, SurveyOptions* o) {
  auto add = description->add_options();
  add("relief", Default(&o->relief), "factor on the seabed's heights, 0..1.5");
  add("turbidity", Default(&o->turbidity), "0 clear .. 1 murky");
  add("caustics", Default(&o->caustics), "0 none .. 1 strong");
  add("marine_snow", Default(&o->marine_snow), "0 none .. 1 heavy");
  add("max_range", Default(&o->max_range),
      "that the pictures see, metres; 0: 3.5 x altitude (descent: 5 x) where they show open water");
}

void AddPortOptions(po::options_description* description, PortOptions* port, std::string* kind) {
  auto add = description->add_options();
  add("port", Default(kind), "none, flat or dome: the window between camera and water, refracting");
  add("port_thickness", Default(&port->thickness), "of its glass, metres");
  add("port_distance", Default(&port->distance),
      "flat: of the entrance pupil to the glass, metres");
  add("port_tilt", Default(&port->tilt_deg), "flat: about the camera's y, degrees, -10..10");
  add("port_radius", Default(&port->radius), "dome: of its outside, metres");
  add("port_decentring", Default(&port->decentring),
      "dome: its centre before the entrance pupil, metres");
  add("port_sideways", Default(&port->sideways), "dome: its centre aside of the axis, metres");
}

void AddMarkerOptions(po::options_description* description, SurveyOptions* o) {
  auto add = description->add_options();
  add("markers", Default(&o->markers),
      "scale bars of two coded markers on the seabed (tag36h11, bar k has 2 k and 2 k + 1); their "
      "lengths: truth/bars.csv");
  add("marker_size", Default(&o->marker_size), "side of the markers' black squares, metres");
  add("marker_bar", Default(&o->marker_bar), "length of a bar on the map, metres");
}

int Generate(const std::vector<std::string>& arguments) {
  SurveyOptions o;
  std::string output_path, passes_path, path = SurveyPathName(o.path), camera_model = "OPENCV",
                                        port = "none";
  po::options_description description("demo_survey generate");
  auto add = description.add_options();
  add("help,h", "this text");
  add("output_path", po::value(&output_path)->required(), "folder to write to");
  add("passes_path", po::value(&passes_path),
      "gaps.geojson of completeness_reporter on the survey of these options: the pictures of its "
      "passes are made, as a second dive; truth/sparse holds both dives");
  add("seed", Default(&o.seed), "of everything random");
  add("path", Default(&path), "strips, random, swim, circle, statue, wall or descent");
  add("camera_model", Default(&camera_model), "OPENCV or OPENCV_FISHEYE");
  AddTrackOptions(&description, &o);
  AddPictureOptions(&description, &o);
  AddWaterOptions(&description, &o);
  AddPortOptions(&description, &o.port, &port);
  AddMarkerOptions(&description, &o);
  add("num_threads", Default(&o.num_threads), "-1 = all");
  if (!ParseOptions(description, arguments)) return 0;
  o.path = ParseSurveyPath(path);
  o.port.kind = ParsePortKind(port);
  o.camera_model = ParseSurveyCameraModel(camera_model);
  const std::string problem = CheckSurveyOptions(o);
  if (!problem.empty()) throw UsageError(problem);

  const std::filesystem::path dir = output_path;
  CheckWritableDir(dir / "images");
  const Timer timer;
  std::vector<PosedImage> passes;
  if (!passes_path.empty()) {
    DivePasses dive = PlanPasses(passes_path, o.image_format, o.seed, o.jitter);
    if (dive.num_tilted > 0)
      std::fprintf(stderr, "%d passes along walls left out\n", dive.num_tilted);
    passes = std::move(dive.images);
  }
  SurveyTruth truth = MakeSurveyTruth(o, passes);
  WriteSurveyTruth(dir, o, truth);
  if (!passes.empty()) {
    std::vector<PosedImage>& images = truth.model.images;
    images.erase(images.begin(), images.end() - static_cast<std::ptrdiff_t>(passes.size()));
  }
  size_t num_done = 0;
  RenderSurvey(o, truth, [&](const PosedImage& image, ColorImage&& picture) {
    WriteImage(dir / "images" / image.name, picture);
    std::fprintf(stderr, "\r%zu of %zu pictures", ++num_done, truth.model.images.size());
  });
  const double megapixels = 1e-6 * o.width * o.height * static_cast<double>(num_done);
  std::fprintf(stderr, "\n");
  std::printf("%zu pictures, %.1f megapixels, gsd %.4f mm, %.1f s (%.2f CPU s/megapixel)\n",
              num_done, megapixels, 1000 * truth.gsd, timer.WallSeconds(),
              timer.CpuSeconds() / megapixels);
  return 0;
}

int Control(const std::vector<std::string>& arguments) {
  ControlOptions o;
  std::string survey_path, output_path;
  po::options_description description("demo_survey control");
  auto add = description.add_options();
  add("help,h", "this text");
  add("survey_path", po::value(&survey_path)->required(), "folder of demo_survey generate");
  add("output_path", po::value(&output_path)->required(),
      "folder for bars.csv, targets.csv and positions.csv");
  add("seed", Default(&o.seed), "of everything random");
  add("bar_length", Default(&o.bar_length), "of the scale bar, about, metres");
  add("pixel_noise", Default(&o.pixel_noise), "standard deviation of the targets' marks, pixels");
  add("position_noise", Default(&o.position_noise),
      "standard deviation of the cameras' positions, each axis, metres");
  add("outlier_share", Default(&o.outlier_share),
      "share of positions that are grossly wrong, 0..1");
  add("outlier_size", Default(&o.outlier_size), "how far these are off, metres");
  if (!ParseOptions(description, arguments)) return 0;
  const std::string problem = CheckControlOptions(o);
  if (!problem.empty()) throw UsageError(problem);
  const ControlTables tables = MakeControl(ReadSurveyTruth(survey_path), o);
  const std::filesystem::path dir = output_path;
  CheckWritableDir(dir);
  WriteTextFile(dir / "bars.csv", tables.bars);
  WriteTextFile(dir / "targets.csv", tables.targets);
  WriteTextFile(dir / "positions.csv", tables.positions);
  std::printf("bars.csv, targets.csv and positions.csv in %s\n", output_path.c_str());
  return 0;
}

int Markers(const std::vector<std::string>& arguments) {
  std::string survey_path, markers_path;
  po::options_description description("demo_survey markers");
  auto add = description.add_options();
  add("help,h", "this text");
  add("survey_path", po::value(&survey_path)->required(),
      "folder of demo_survey generate --markers");
  add("markers_path", po::value(&markers_path)->required(), "table of marker_finder");
  if (!ParseOptions(description, arguments)) return 0;
  std::cout << MarkerScoreText(
      ScoreMarkers(ReadSurveyTruth(survey_path), ReadMarkersCsv(markers_path)));
  return 0;
}

int Score(const std::vector<std::string>& arguments) {
  ScoreOptions o;
  std::string survey_path, input_path, cloud_path, output_path;
  po::options_description description("demo_survey score");
  auto add = description.add_options();
  add("help,h", "this text");
  add("survey_path", po::value(&survey_path)->required(), "folder of demo_survey generate");
  add("input_path", po::value(&input_path)->required(), "estimated COLMAP model");
  add("cloud_path", po::value(&cloud_path)->required(), "dense cloud in the model's frame, PLY");
  add("output_path", po::value(&output_path), "JSON to write");
  add("truth_poses", Default(&o.truth_poses), "1: the model is in the truth's frame already");
  add("refine", Default(&o.refine),
      "1: after the alignment by camera centres, fit the cloud to the surface as well");
  add("num_threads", Default(&o.num_threads), "-1 = all");
  if (!ParseOptions(description, arguments)) return 0;

  const SurveyTruth truth = ReadSurveyTruth(survey_path);
  const SparseModel model = ReadSparseModel(input_path);
  ScoredCloud cloud;
  for (const CloudPoint& point : ReadCloud(cloud_path)) cloud.points.push_back(point.xyz);
  cloud.view_gsd = ViewGsd(model, cloud.points, cloud_path);
  const SurveyScore score = ScoreSurvey(truth, model, std::move(cloud), o);
  if (!output_path.empty()) WriteTextFile(output_path, ScoreJson(score));
  std::cout << ScoreTable(score);
  return 0;
}

}  // namespace
}  // namespace colmap_seapoint

int main(int argc, char** argv) {
  using namespace colmap_seapoint;
  return RunSubcommands(
      argc, argv, "demo_survey", kUsage,
      {{"generate", Generate}, {"control", Control}, {"markers", Markers}, {"score", Score}});
}
