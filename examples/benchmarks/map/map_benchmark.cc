// map_benchmark survey: the map of a demo survey, with its true poses, against its truth.
// map_benchmark draw: the map of any model and cloud, as pictures to look at.
#include <boost/program_options.hpp>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/timer.h"
#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/model_units.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/orthomosaic/orthomosaic.h"
#include "examples/benchmarks/map/map_measures.h"
#include "examples/subcommands.h"

namespace colmap_seapoint {
namespace {

namespace po = boost::program_options;
namespace fs = std::filesystem;

constexpr char kUsage[] =
    "map_benchmark survey --survey_path DIR --cloud_path fused.ply --output_path DIR [options]\n"
    "map_benchmark draw --image_path DIR --input_path MODEL --cloud_path fused.ply --output_path "
    "DIR\n"
    "map_benchmark <command> -h lists the options.\n";

MapPictureReader ReaderOf(const SparseModel& model, const fs::path& image_path) {
  return [&model, image_path](size_t i) { return ReadPicture(image_path / model.images[i].name); };
}

// CPU seconds to decode every picture once.
double DecodingSeconds(const SparseModel& model, const MapPictureReader& read) {
  const Timer timer;
  for (size_t i = 0; i < model.images.size(); ++i) read(i);
  return timer.CpuSeconds();
}

// White where there is no colour; the relief lit from the upper left; sources in colours.
void WritePictures(const MemoryMap& map, const fs::path& folder) {
  fs::create_directories(folder);
  const MapTile& whole = map.Whole();
  ColorImage color(whole.rgba.width, whole.rgba.height, 3, 255), sources = color;
  GrayImage shade(whole.rgba.width, whole.rgba.height);
  const auto pixel_size = static_cast<float>(map.Grid().pixel_size);
  for (int y = 0; y < color.height; ++y) {
    for (int x = 0; x < color.width; ++x) {
      const auto id = static_cast<uint32_t>(whole.source.At(x, y)) * 2654435761u;
      for (int c = 0; c < 3 && whole.rgba.At(x, y, 3) > 0; ++c) {
        color.At(x, y, c) = whole.rgba.At(x, y, c);
        sources.At(x, y, c) = static_cast<uint8_t>(id >> (8 * c + 4));
      }
      if (x == 0 || y == 0) continue;
      const float rise =
          2 * whole.relief.At(x, y) - whole.relief.At(x - 1, y) - whole.relief.At(x, y - 1);
      const float light = 140 + 60 * rise / pixel_size;
      if (light == light) shade.At(x, y) = static_cast<uint8_t>(std::clamp(light, 1.0f, 255.0f));
    }
  }
  WriteImage(folder / "orthomosaic.png", color);
  WriteImage(folder / "source.png", sources);
  WriteImage(folder / "relief.png", shade);
}

void PrintSummary(const OrthomosaicSummary& summary, double seconds, double decoding) {
  const auto surface = static_cast<double>(summary.num_surface_pixels);
  std::printf("%s; GSD %.6g, pixel %.6g, %d x %d pixels, cells of %d\n", summary.frame.text.c_str(),
              summary.gsd, summary.grid.pixel_size, summary.grid.width, summary.grid.height,
              summary.cell_size);
  std::printf(
      "surface %.0f pixels, coloured %.4f, bridged %.4f, filled %.4f, overhang %.4f; %zu pictures "
      "used, %zu unread, %zu readings\n",
      surface, static_cast<double>(summary.num_colored_pixels) / surface,
      static_cast<double>(summary.num_bridged_pixels) / surface,
      static_cast<double>(summary.num_filled_pixels) / surface,
      static_cast<double>(summary.num_overhang_pixels) / surface, summary.pictures_used.size(),
      summary.pictures_unread.size(), summary.num_picture_reads);
  std::printf("%.2f CPU s, decoding all once %.2f: %.2f times\n", seconds, decoding,
              seconds / decoding);
}

int Survey(const std::vector<std::string>& arguments) {
  std::string survey_path, cloud_path, output_path;
  SurveyOptions survey;
  OrthomosaicOptions options;
  po::options_description description("map_benchmark survey");
  auto add = description.add_options();
  add("help,h", "this text");
  add("survey_path", po::value(&survey_path)->required(), "folder of demo_survey generate");
  add("cloud_path", po::value(&cloud_path)->required(), "cloud made with the true poses");
  add("output_path", po::value(&output_path)->required(), "folder for the pictures");
  add("seed", Default(&survey.seed), "of the survey");
  add("relief", Default(&survey.relief), "of the survey");
  add("pixel_size", Default(&options.pixel_size), "metres; 0: the survey's GSD");
  add("restore", Default(&options.restore), "colours without the water");
  add("num_threads", Default(&options.num_threads), "-1: all");
  if (!ParseOptions(description, arguments)) return 0;
  const SurveyTruth truth = ReadSurveyTruth(survey_path);
  const MapPictureReader read = ReaderOf(truth.model, fs::path(survey_path) / "images");
  ModelUnits units;
  units.is_metric = true;
  units.frame = "local";
  MemoryMap map;
  const double decoding = DecodingSeconds(truth.model, read);
  const Timer timer;
  const OrthomosaicSummary summary =
      MakeOrthomosaic(options, {truth.model, cloud_path, units, read, "/tmp"}, &map);
  PrintSummary(summary, timer.CpuSeconds(), decoding);
  WritePictures(map, output_path);
  std::vector<Eigen::Vector3f> points;
  for (const CloudPoint& point : ReadCloud(cloud_path)) points.push_back(point.xyz);
  const ReliefErrors relief = MeasureRelief(truth, map);
  const MapCoverage coverage = MeasureCoverage(truth, points, map);
  const MarkErrors marks = MeasureMarks(truth, survey, map);
  const SeamSteps seams = MeasureSeams(truth, read, map);
  std::printf("relief: median %.3f GSD, p95 %.3f\n", relief.median, relief.p95);
  std::printf("covered surface coloured %.5f; coloured though unseen %.5f\n",
              coverage.colored_share, coverage.unseen_share);
  std::printf("%d marks: median %.3f pixels, p95 %.3f\n", marks.num_marks, marks.median, marks.p95);
  std::printf("colours: mean CIEDE2000 %.2f%s\n", MeasureColors(truth, survey, map),
              summary.water ? ("; " + WaterText(*summary.water)).c_str() : "");
  std::printf("%d pairs across seams: step %.3f %%, inside one picture %.3f: %.2f times\n",
              seams.num_pairs, seams.across, seams.inside, seams.across / seams.inside);
  return 0;
}

int Draw(const std::vector<std::string>& arguments) {
  std::string image_path, input_path, cloud_path, output_path;
  OrthomosaicOptions options;
  po::options_description description("map_benchmark draw");
  auto add = description.add_options();
  add("help,h", "this text");
  add("image_path", po::value(&image_path)->required(), "folder of the pictures");
  add("input_path", po::value(&input_path)->required(), "COLMAP model");
  add("cloud_path", po::value(&cloud_path)->required(), "cloud in its frame");
  add("output_path", po::value(&output_path)->required(), "folder for the pictures");
  add("pixel_size", Default(&options.pixel_size), "the model's unit; 0: the survey's GSD");
  add("fill", Default(&options.fill), "fill holes");
  add("balance", Default(&options.balance), "one exposure for all pictures");
  add("num_threads", Default(&options.num_threads), "-1: all");
  if (!ParseOptions(description, arguments)) return 0;
  const SparseModel model = ReadSparseModel(input_path, ModelContent::kPosesAndPoints);
  const MapPictureReader read = ReaderOf(model, image_path);
  MemoryMap map;
  const double decoding = DecodingSeconds(model, read);
  const Timer timer;
  const OrthomosaicSummary summary =
      MakeOrthomosaic(options, {model, cloud_path, ReadModelUnits(input_path), read, "/tmp"}, &map);
  PrintSummary(summary, timer.CpuSeconds(), decoding);
  WritePictures(map, output_path);
  return 0;
}

}  // namespace
}  // namespace colmap_seapoint

int main(int argc, char** argv) {
  return colmap_seapoint::RunSubcommands(
      argc, argv, "map_benchmark", colmap_seapoint::kUsage,
      {{"survey", colmap_seapoint::Survey}, {"draw", colmap_seapoint::Draw}});
}
