// second_dive join: the model of a survey with planted gaps and of the dive that closes them.
// second_dive closed: how much of the gaps that dive has closed, against the exact truth.
#include <algorithm>
#include <boost/program_options.hpp>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "densify/completeness/completeness_options.h"
#include "densify/completeness/surface/asked_area.h"
#include "examples/benchmarks/completeness/gap_truth.h"
#include "examples/subcommands.h"

namespace colmap_seapoint {
namespace {

namespace po = boost::program_options;
namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr char kUsage[] =
    "second_dive join --first_path MODEL --survey_path DIVE --output_path MODEL\n"
    "second_dive closed --survey_path DIR --planted_path DIR --report_path REPORT --before_path "
    "fused.ply --cloud_path fused.ply\n";

// Of the second survey's exact model the pictures of the first model, and those of the passes.
int Join(const std::vector<std::string>& arguments) {
  std::string first_path, survey_path, output_path;
  po::options_description description("second_dive join");
  auto add = description.add_options();
  add("help,h", "this text");
  add("first_path", po::value(&first_path)->required(), "model of the first dive");
  add("survey_path", po::value(&survey_path)->required(), "of demo_survey generate --passes_path");
  add("output_path", po::value(&output_path)->required(), "model of both");
  if (!ParseOptions(description, arguments)) return 0;
  std::set<std::string> names;
  for (const PosedImage& image : ReadSparseModel(first_path).images) names.insert(image.name);
  SparseModel model = ReadSurveyTruth(survey_path).model;
  std::set<uint32_t> kept;
  const auto is_gone = [&](const PosedImage& image) {
    return names.count(image.name) == 0 && image.name.rfind("pass_", 0) != 0;
  };
  auto& images = model.images;
  images.erase(std::remove_if(images.begin(), images.end(), is_gone), images.end());
  for (const PosedImage& image : images) kept.insert(image.image_id);
  std::set<uint64_t> lonely;
  for (auto& [id, point] : model.points3D) {
    auto& track = point.track;
    track.erase(std::remove_if(track.begin(), track.end(),
                               [&](const auto& e) { return kept.count(e.image_id) == 0; }),
                track.end());
    if (track.size() < 2) lonely.insert(id);
  }
  for (const uint64_t id : lonely) model.points3D.erase(id);
  for (PosedImage& image : images) {
    for (uint64_t& id : image.point3D_ids) {
      if (lonely.count(id) > 0) id = kNoPoint3D;
    }
  }
  WriteSparseModelText(output_path, model);
  std::printf("%zu pictures\n", images.size());
  return 0;
}

// The gaps of a report's top layer, on the ground's plan; a gap is within an odd number of rings.
std::vector<AskedArea> ReadGaps(const SurveyTruth& truth, const fs::path& folder) {
  std::ifstream in(folder / "completeness.json");
  const Json json = Json::parse(in);
  std::vector<AskedArea> gaps;
  for (const Json& gap : json.at("gaps")) {
    if (gap.at("layer") != "top") continue;
    AskedArea& area = gaps.emplace_back();
    for (const Json& ring : gap.at("outline")) {
      Ring& corners = area.rings.emplace_back();
      for (const Json& p : ring) {
        corners.emplace_back(truth.surface.InGround(Eigen::Vector3d(p[0], p[1], p[2])).head<2>());
      }
    }
  }
  return gaps;
}

GapTruth TruthOf(const SurveyTruth& truth, const PlantedGaps& planted,
                 const std::string& cloud_path) {
  std::vector<Eigen::Vector3f> points;
  for (const CloudPoint& point : ReadCloud(cloud_path)) {
    if (point.confidence >= CompletenessOptions{}.min_confidence) points.push_back(point.xyz);
  }
  return MeasureGapTruth(truth, planted, points, -1);
}

int Closed(const std::vector<std::string>& arguments) {
  std::string survey_path, planted_path, report_path, before_path, cloud_path;
  po::options_description description("second_dive closed");
  auto add = description.add_options();
  add("help,h", "this text");
  add("survey_path", po::value(&survey_path)->required(), "of the first dive");
  add("planted_path", po::value(&planted_path)->required(), "of completeness_benchmark plant");
  add("report_path", po::value(&report_path)->required(), "of the first dive");
  add("before_path", po::value(&before_path)->required(), "cloud of the first dive");
  add("cloud_path", po::value(&cloud_path)->required(), "cloud of both dives");
  if (!ParseOptions(description, arguments)) return 0;
  const SurveyTruth truth = ReadSurveyTruth(survey_path);
  const PlantedGaps planted = ReadPlantedGaps(fs::path(planted_path) / "planted.json");
  const std::vector<AskedArea> gaps = ReadGaps(truth, report_path);
  const GapTruth before = TruthOf(truth, planted, before_path);
  const GapTruth after = TruthOf(truth, planted, cloud_path);
  double reported = 0, open = 0, closed = 0, missing = 0, found_later = 0;
  for (size_t k = 0; k < before.cells.size(); ++k) {
    const TruthCell& cell = before.cells[k];
    if (!cell.is_expected) continue;
    const auto i = static_cast<int>(k) % before.nx, j = static_cast<int>(k) / before.nx;
    const Eigen::Vector2d place = before.Place(i, j);
    const bool is_reported =
        std::any_of(gaps.begin(), gaps.end(), [&](const auto& gap) { return gap.Contains(place); });
    const bool is_covered = after.cells[k].is_covered;
    if (is_reported) {
      reported += cell.area;
      if (!cell.is_covered) open += cell.area;
      if (!cell.is_covered && is_covered) closed += cell.area;
    }
    if (cell.is_gap) missing += cell.area;
    if (cell.is_gap && is_covered) found_later += cell.area;
  }
  std::printf("reported %.3f m2, truly missing of it %.3f m2, closed %.1f %%\n", reported, open,
              100 * closed / open);
  std::printf("all true gaps %.3f m2, closed %.1f %%\n", missing, 100 * found_later / missing);
  return 0;
}

}  // namespace
}  // namespace colmap_seapoint

int main(int argc, char** argv) {
  using namespace colmap_seapoint;
  return RunSubcommands(argc, argv, "second_dive", kUsage, {{"join", Join}, {"closed", Closed}});
}
