// densify_benchmark measure: complete against partial densification on a model (paper 3, Tables 2
// and 3), with the exact truth when it is a demo survey. holdout: sparse points kept from the
// densifier as witnesses. program: the whole program against decoding. tables: of all sets measured
// so far. scripts/benchmark_densify.sh runs them. reach: a cloud against that of a peer.
// holes: what a cloud lacks inside its own outline.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/natural_order.h"
#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "examples/benchmarks/densify/densify_tables.h"
#include "examples/benchmarks/densify/holes.h"
#include "examples/benchmarks/densify/measure_densify.h"
#include "examples/benchmarks/densify/measure_program.h"
#include "examples/benchmarks/densify/reach.h"
#include "examples/subcommands.h"

namespace colmap_seapoint {
namespace {

namespace po = boost::program_options;

constexpr char kUsage[] =
    "densify_benchmark measure [--output_path SETS/NAME.measure.csv] SET\n"
    "densify_benchmark holdout [--output_path SETS/NAME.holdout.csv] SET\n"
    "densify_benchmark program --binary colmap_seapoint [--output_path SETS/NAME.program.csv] SET\n"
    "densify_benchmark tables --input_path SETS --output_path DIR\n"
    "densify_benchmark reach --input_path MODEL --cloud_path A.ply --reference_path PEER.ply\n"
    "densify_benchmark holes --cloud_path A.ply [--spacing S] [--output_path MAP.png]\n"
    "SET: --survey_path DIR (exact cameras), or --input_path MODEL --image_path DIR, or both\n"
    "densify_benchmark <command> -h lists the options.\n";

// The options that tell what is measured, and how it is densified.
struct SetArguments {
  DensifySet set;
  std::string image_path, input_path, survey_path, output_path;
  PartialDensificationOptions densification;
  OptionTable table;
  std::vector<std::string> given;  // of the table, as --name value ...

  void Add(po::options_description* description) {
    auto add = description->add_options();
    add("help,h", "this text");
    add("survey_path", po::value(&survey_path), "folder of demo_survey generate");
    add("input_path", po::value(&input_path), "COLMAP model; of the survey's truth when not given");
    add("image_path", po::value(&image_path), "pictures; of the survey when not given");
    add("database_path", po::value(&set.database_path), "SeaPoints; found again when not given");
    add("set_name", po::value(&set.name), "in the tables; of the folder when not given");
    add("output_path", po::value(&output_path), "CSV to write");
    densification.Bind(&table);
    for (const OptionInfo& option : table.Options()) {
      const std::string name = option.name;
      add(name.c_str(), po::value<std::string>()->notifier([this, name](const std::string& text) {
        const std::string problem = table.Set(name, text);
        if (!problem.empty()) throw UsageError(problem);
        given.insert(given.end(), {"--" + name, text});
      }),
          (option.help + " [" + option.default_value + "]").c_str());
    }
  }

  void Check() {
    if (survey_path.empty() && (input_path.empty() || image_path.empty())) {
      throw UsageError("--survey_path, or --input_path and --image_path, are required");
    }
    for (const std::string& problem : {table.Check(), densification.Check()}) {
      if (!problem.empty()) throw UsageError(problem);
    }
    set.survey_path = survey_path;
    set.input_path = input_path;
    set.image_path = image_path;
    if (set.name.empty()) {
      const std::filesystem::path folder = survey_path.empty() ? input_path : survey_path;
      set.name = std::filesystem::absolute(folder / ".").parent_path().filename().string();
    }
    if (!output_path.empty()) {
      CheckWritableDir(std::filesystem::absolute(output_path).parent_path());
    }
  }
};

std::vector<std::string> SplitNames(const std::string& text) {
  std::vector<std::string> names;
  std::istringstream stream(text);
  for (std::string name; std::getline(stream, name, ',');) {
    FindVariant(name);
    names.push_back(name);
  }
  if (names.empty()) throw UsageError("--variants is empty");
  return names;
}

int Measure(const std::vector<std::string>& arguments) {
  SetArguments set;
  DensifyMeasureOptions o;
  std::string variants = "complete,sequential,complete_all,all", debug_path;
  po::options_description description("densify_benchmark measure");
  set.Add(&description);
  auto add = description.add_options();
  add("variants", Default(&variants), "in the order in which they run");
  add("num_repeats", Default(&o.num_repeats), "of every timing; the median counts");
  add("num_threads", Default(&o.num_threads), "-1 = all");
  add("debug_path", po::value(&debug_path), "folder for every variant's cloud and pairs.csv");
  if (!ParseOptions(description, arguments)) return 0;
  set.Check();
  if (o.num_repeats < 1) throw UsageError("1 <= num_repeats is required");
  o.set = set.set;
  o.densification = set.densification;
  o.variants = SplitNames(variants);
  o.debug_path = debug_path;
  const std::vector<DensifyRow> rows = MeasureDensify(o);
  if (!set.output_path.empty()) WriteDensifyRows(set.output_path, rows);
  std::cout << DensifyTables({rows, {}, {}});
  return 0;
}

int HoldOutCommand(const std::vector<std::string>& arguments) {
  SetArguments set;
  HoldOutOptions o;
  std::string debug_path;
  po::options_description description("densify_benchmark holdout");
  set.Add(&description);
  auto add = description.add_options();
  add("variant", Default(&o.variant), "complete, sequential, complete_all or all");
  add("every", Default(&o.every), "every so manieth sparse point is held out");
  add("num_threads", Default(&o.num_threads), "-1 = all");
  add("debug_path", po::value(&debug_path), "folder for cloud and pairs.csv");
  if (!ParseOptions(description, arguments)) return 0;
  set.Check();
  if (o.every < 2) throw UsageError("2 <= every is required");
  FindVariant(o.variant);
  o.set = set.set;
  o.densification = set.densification;
  o.debug_path = debug_path;
  const HoldOutRow row = MeasureHoldOut(o);
  if (!set.output_path.empty()) WriteHoldOutRows(set.output_path, {row});
  std::cout << DensifyTables({{}, {row}, {}});
  return 0;
}

int Program(const std::vector<std::string>& arguments) {
  SetArguments set;
  ProgramOptions o;
  std::string binary;
  po::options_description description("densify_benchmark program");
  set.Add(&description);
  auto add = description.add_options();
  add("binary", po::value(&binary)->required(), "colmap_seapoint");
  add("num_repeats", Default(&o.num_repeats), "of every timing; the median counts");
  if (!ParseOptions(description, arguments)) return 0;
  set.Check();
  if (o.num_repeats < 1) throw UsageError("1 <= num_repeats is required");
  o.set_name = set.set.name;
  o.binary = std::filesystem::absolute(binary);
  const DensifySet filled = WithPaths(set.set);
  o.image_path = filled.image_path;
  o.input_path = filled.input_path;
  o.arguments = set.given;
  o.database_path = set.set.database_path;
  const ProgramRow row = MeasureProgram(o);
  if (!set.output_path.empty()) WriteProgramRows(set.output_path, {row});
  std::cout << DensifyTables({{}, {}, {row}});
  return 0;
}

bool EndsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

template <typename Row>
void Append(const std::vector<Row>& more, std::vector<Row>* rows) {
  rows->insert(rows->end(), more.begin(), more.end());
}

int Tables(const std::vector<std::string>& arguments) {
  std::string input_path, output_path;
  po::options_description description("densify_benchmark tables");
  auto add = description.add_options();
  add("help,h", "this text");
  add("input_path", po::value(&input_path)->required(), "folder with the CSVs of the others");
  add("output_path", po::value(&output_path)->required(),
      "folder for densify.csv, densify.md and densify.dat");
  if (!ParseOptions(description, arguments)) return 0;
  std::vector<std::string> names;
  std::error_code code;
  for (const auto& entry : std::filesystem::directory_iterator(input_path, code)) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end(), NaturalLess);
  DensifyResults results;
  for (const std::string& name : names) {
    const std::filesystem::path path = std::filesystem::path(input_path) / name;
    if (EndsWith(name, ".measure.csv")) Append(ReadDensifyRows(path), &results.rows);
    if (EndsWith(name, ".holdout.csv")) Append(ReadHoldOutRows(path), &results.hold_outs);
    if (EndsWith(name, ".program.csv")) Append(ReadProgramRows(path), &results.programs);
  }
  const std::string text = DensifyTables(results);
  if (text.empty()) throw Error(input_path, "holds no measurement", "measure a set first");
  const std::filesystem::path dir = output_path;
  CheckWritableDir(dir);
  WriteDensifyRows(dir / "densify.csv", results.rows);
  WriteTextFile(dir / "densify.md", DensifyDefinitions() + text);
  WriteTextFile(dir / "densify.dat", DensifyPlotData(results.rows));
  return 0;
}

std::vector<Eigen::Vector3f> ReadPoints(const std::string& path) {
  std::vector<Eigen::Vector3f> points;
  for (const CloudPoint& point : ReadCloud(path)) points.push_back(point.xyz);
  return points;
}

int ReachCommand(const std::vector<std::string>& arguments) {
  std::string input_path, cloud_path, reference_path;
  po::options_description description("densify_benchmark reach");
  auto add = description.add_options();
  add("help,h", "this text");
  add("input_path", po::value(&input_path)->required(), "COLMAP model of both clouds");
  add("cloud_path", po::value(&cloud_path)->required(), "our cloud");
  add("reference_path", po::value(&reference_path)->required(), "the peer's cloud");
  if (!ParseOptions(description, arguments)) return 0;
  std::vector<Eigen::Vector3f> centers;
  for (const PosedImage& image :
       ReadSparseModel(input_path, ModelContent::kPosesAndPoints).images) {
    centers.push_back(image.cam_from_world.OriginInSource().cast<float>());
  }
  if (centers.empty()) throw Error(input_path, "the model has no pictures", "choose another one");
  std::cout << ReachText(MeasureReach(ReadPoints(cloud_path), ReadPoints(reference_path), centers));
  return 0;
}

int HolesCommand(const std::vector<std::string>& arguments) {
  std::string cloud_path, output_path;
  double spacing = 0;
  size_t num_holes = 10;
  po::options_description description("densify_benchmark holes");
  auto add = description.add_options();
  add("help,h", "this text");
  add("cloud_path", po::value(&cloud_path)->required(), "the cloud");
  add("spacing", Default(&spacing), "between samples, model units; 0 = measured");
  add("num_holes", Default(&num_holes), "so many of the largest are listed");
  add("output_path", po::value(&output_path), "PNG of the map to write");
  if (!ParseOptions(description, arguments)) return 0;
  if (!(spacing >= 0)) throw UsageError("0 <= spacing is required");
  const std::vector<CloudPoint> cloud = ReadCloud(cloud_path);
  const HoleMap map = FindHoles(cloud, spacing > 0 ? spacing : MedianSpacing(cloud));
  if (!output_path.empty()) WriteImage(output_path, map.picture);
  std::cout << HolesText(map, num_holes);
  return 0;
}

}  // namespace
}  // namespace colmap_seapoint

int main(int argc, char** argv) {
  using namespace colmap_seapoint;
  return RunSubcommands(argc, argv, "densify_benchmark", kUsage,
                        {{"measure", Measure},
                         {"holdout", HoldOutCommand},
                         {"program", Program},
                         {"tables", Tables},
                         {"reach", ReachCommand},
                         {"holes", HolesCommand}});
}
