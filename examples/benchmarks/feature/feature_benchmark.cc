// feature_benchmark measure: SeaPoints, ORB and SIFT on a folder of pictures (paper 3, Table 1),
// and against the exact truth when it is a demo survey. feature_benchmark tables: the tables of all
// sets measured so far. scripts/benchmark_features.sh runs both.
#include <algorithm>
#include <boost/program_options.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/natural_order.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "examples/benchmarks/feature/feature_tables.h"
#include "examples/benchmarks/feature/measure_set.h"
#include "examples/subcommands.h"

namespace colmap_seapoint {
namespace {

namespace po = boost::program_options;

constexpr char kUsage[] =
    "feature_benchmark measure --output_path SETS/NAME.csv (--image_path DIR | --survey_path DIR)\n"
    "feature_benchmark tables --input_path SETS --output_path DIR\n"
    "feature_benchmark <command> -h lists the options.\n";

int Measure(const std::vector<std::string>& arguments) {
  MeasureOptions o;
  std::string image_path, survey_path, output_path;
  po::options_description description("feature_benchmark measure");
  auto add = description.add_options();
  add("help,h", "this text");
  add("output_path", po::value(&output_path)->required(),
      "CSV to write, a row a pair and detector");
  add("image_path", po::value(&image_path), "pictures; of the survey when not given");
  add("survey_path", po::value(&survey_path), "folder of demo_survey generate");
  add("set_name", po::value(&o.set_name), "in the tables; of the CSV when not given");
  add("min_num_features", Default(&o.min_num_features), "of SeaPoints, a picture");
  add("max_num_features", Default(&o.max_num_features), "of every detector, a picture");
  add("adjust_thresholds", Default(&o.adjust_thresholds),
      "1: lower ORB's and SIFT's own thresholds until they find min_num_features; 0: OpenCV's");
  add("num_repeats", Default(&o.num_repeats), "of every timing; the median counts");
  if (!ParseOptions(description, arguments)) return 0;
  if (image_path.empty() && survey_path.empty()) {
    throw UsageError("--image_path or --survey_path is required");
  }
  if (o.min_num_features < 1 || o.max_num_features < o.min_num_features || o.num_repeats < 1) {
    throw UsageError("1 <= min_num_features <= max_num_features and 1 <= num_repeats is required");
  }
  if (!survey_path.empty()) o.survey_path = survey_path;
  o.image_path = image_path;
  if (image_path.empty()) o.image_path = *o.survey_path / "images";
  if (o.set_name.empty()) o.set_name = std::filesystem::path(output_path).stem().string();
  CheckWritableDir(std::filesystem::absolute(output_path).parent_path());
  WriteFeatureRows(output_path, MeasureSet(o));
  return 0;
}

int Tables(const std::vector<std::string>& arguments) {
  std::string input_path, output_path;
  po::options_description description("feature_benchmark tables");
  auto add = description.add_options();
  add("help,h", "this text");
  add("input_path", po::value(&input_path)->required(), "folder with the CSVs of measure");
  add("output_path", po::value(&output_path)->required(),
      "folder for features.csv, features.md and features.dat");
  if (!ParseOptions(description, arguments)) return 0;
  std::vector<std::string> names;
  std::error_code code;
  for (const auto& entry : std::filesystem::directory_iterator(input_path, code)) {
    if (entry.path().extension() == ".csv") names.push_back(entry.path().filename().string());
  }
  if (names.empty()) throw Error(input_path, "holds no CSV", "run feature_benchmark measure first");
  std::sort(names.begin(), names.end(), NaturalLess);
  std::vector<FeatureRow> rows;
  for (const std::string& name : names) {
    const auto set = ReadFeatureRows(std::filesystem::path(input_path) / name);
    rows.insert(rows.end(), set.begin(), set.end());
  }
  const std::filesystem::path dir = output_path;
  CheckWritableDir(dir);
  WriteFeatureRows(dir / "features.csv", rows);
  WriteTextFile(dir / "features.md", MarkdownTables(rows));
  WriteTextFile(dir / "features.dat", PlotData(rows));
  return 0;
}

}  // namespace
}  // namespace colmap_seapoint

int main(int argc, char** argv) {
  using namespace colmap_seapoint;
  return RunSubcommands(argc, argv, "feature_benchmark", kUsage,
                        {{"measure", Measure}, {"tables", Tables}});
}
