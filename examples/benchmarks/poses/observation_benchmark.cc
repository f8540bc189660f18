// observation_benchmark score: a model's observations and camera centres against a survey's truth.
// observation_benchmark adjust: a model's bundle adjustment.
// observation_benchmark measure: a model's observations, measured again in its pictures.
#include <boost/program_options.hpp>
#include <iostream>
#include <string>
#include <vector>

#include "colmap_seapoint/adjustment/bundle_adjustment.h"
#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/timer.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/mapping/adjust_lens.h"
#include "colmap_seapoint/remeasuring/remeasure_observations.h"
#include "examples/benchmarks/poses/observation_errors.h"
#include "examples/subcommands.h"
#include "examples/survey/alignment.h"
#include "examples/survey/survey.h"

namespace colmap_seapoint {
namespace {

namespace po = boost::program_options;

constexpr char kUsage[] =
    "observation_benchmark score --survey_path DIR --input_path MODEL [options]\n"
    "observation_benchmark adjust --input_path MODEL --output_path MODEL [options]\n"
    "observation_benchmark measure --image_path DIR --input_path MODEL --output_path MODEL\n"
    "observation_benchmark <command> -h lists the options.\n";

int Score(const std::vector<std::string>& arguments) {
  std::string survey_path, input_path;
  int images_per_strip = 0;
  po::options_description description("observation_benchmark score");
  auto add = description.add_options();
  add("help,h", "this text");
  add("survey_path", po::value(&survey_path)->required(), "folder of demo_survey generate");
  add("input_path", po::value(&input_path)->required(), "estimated COLMAP model");
  add("images_per_strip", po::value(&images_per_strip)->required(), "of the survey");
  if (!ParseOptions(description, arguments)) return 0;
  if (images_per_strip < 1) throw UsageError("images_per_strip must be at least 1");
  const SparseModel truth =
      ReadSparseModel(std::filesystem::path(survey_path) / "truth" / "sparse");
  const SparseModel model = ReadSparseModel(input_path);
  std::cout << ErrorTable(MeasureObservations(truth, model, images_per_strip));
  const CentreAlignment centres = AlignCentres(truth, model, false);
  std::printf("%d pictures, camera centres: rms %.3f mm, max %.3f mm; reprojection rms %.4f px\n",
              centres.num_registered, 1000 * centres.rms, 1000 * centres.max,
              ReprojectionError(model));
  return 0;
}

int Adjust(const std::vector<std::string>& arguments) {
  std::string input_path, output_path;
  BundleAdjustmentOptions options;
  po::options_description description("observation_benchmark adjust");
  auto add = description.add_options();
  add("help,h", "this text");
  add("input_path", po::value(&input_path)->required(), "COLMAP model");
  add("output_path", po::value(&output_path)->required(), "folder of the adjusted model");
  add("observation_sigma", Default(&options.loss.scale), "pixels, where the loss bends");
  if (!ParseOptions(description, arguments)) return 0;
  const SparseModel model = ReadSparseModel(input_path);
  const Timer timer;
  const auto adjusted = AdjustBundle(options, model);
  if (!adjusted) throw Error(input_path, "cannot be adjusted", "give a model with points");
  std::filesystem::create_directories(output_path);
  WriteSparseModelBinary(output_path, *adjusted);
  std::printf("%.1f CPU s; reprojection rms %.4f -> %.4f px\n", timer.CpuSeconds(),
              ReprojectionError(model), ReprojectionError(*adjusted));
  return 0;
}

void PrintCounts(const Remeasurement& measured) {
  const RemeasuringCounts& c = measured.counts;
  std::printf(
      "%zu references, %zu moved, %zu unmeasured; out: %zu unlike, %zu diverged, %zu unsure, "
      "%zu elsewhere, %zu twice, %zu alone; %zu points out; %zu pictures of another size\n",
      c.references, c.moved, c.unmeasured, c.unlike, c.diverged, c.unsure, c.elsewhere, c.twice,
      c.alone, c.removed_points, measured.of_other_size.size());
}

int Measure(const std::vector<std::string>& arguments) {
  std::string image_path, input_path, output_path;
  RemeasuringOptions options;
  po::options_description description("observation_benchmark measure");
  auto add = description.add_options();
  add("help,h", "this text");
  add("image_path", po::value(&image_path)->required(), "folder of the pictures");
  add("input_path", po::value(&input_path)->required(), "COLMAP model");
  add("output_path", po::value(&output_path)->required(), "folder of the measured model");
  add("max_move", Default(&options.max_move), "pixels");
  add("num_threads", Default(&options.num_threads), "-1 = all");
  if (!ParseOptions(description, arguments)) return 0;
  const SparseModel model = ReadSparseModel(input_path);
  const Timer timer;
  const Remeasurement measured =
      RemeasureObservations(options, model, [&](const PosedImage& image) {
        return ReadGrayImage(std::filesystem::path(image_path) / image.name);
      });
  const double seconds = timer.CpuSeconds();
  PrintCounts(measured);
  std::printf("%.1f CPU s, %.1f microseconds a measured observation\n", seconds,
              1e6 * seconds / static_cast<double>(measured.counts.moved));
  std::filesystem::create_directories(output_path);
  WriteSparseModelBinary(output_path, measured.model);
  return 0;
}

}  // namespace
}  // namespace colmap_seapoint

int main(int argc, char** argv) {
  using namespace colmap_seapoint;
  return RunSubcommands(argc, argv, "observation_benchmark", kUsage,
                        {{"score", Score}, {"adjust", Adjust}, {"measure", Measure}});
}
