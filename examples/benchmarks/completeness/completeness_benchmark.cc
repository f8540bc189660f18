// completeness_benchmark plant: a demo survey with planted gaps.
// completeness_benchmark cover: an exact cloud of a whole survey.
// completeness_benchmark score: what completeness_reporter says of it, against the exact truth.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <boost/program_options.hpp>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "densify/completeness/completeness_options.h"
#include "densify/completeness/surface/asked_area.h"
#include "examples/benchmarks/completeness/gap_truth.h"
#include "examples/benchmarks/completeness/peer_maps.h"
#include "examples/subcommands.h"

namespace colmap_seapoint {
namespace {

namespace po = boost::program_options;
namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr char kUsage[] =
    "completeness_benchmark plant --survey_path DIR --output_path OUT [--seed N] [--num_strips N]\n"
    "completeness_benchmark score --survey_path DIR [--planted_path OUT] --cloud_path fused.ply "
    "--report_path REPORT\n"
    "completeness_benchmark cover --survey_path DIR --output_path CLOUD\n";

// OUT/images, OUT/sparse (exact poses, without lost and removed pictures), OUT/planted.json.
int Plant(const std::vector<std::string>& arguments) {
  std::string survey_path, output_path;
  int seed = 1, num_strips = 4;
  po::options_description description("completeness_benchmark plant");
  auto add = description.add_options();
  add("help,h", "this text");
  add("survey_path", po::value(&survey_path)->required(), "of demo_survey generate");
  add("output_path", po::value(&output_path)->required(), "folder");
  add("seed", Default(&seed), "of the places");
  add("num_strips", Default(&num_strips), "of the survey");
  if (!ParseOptions(description, arguments)) return 0;
  const SurveyTruth truth = ReadSurveyTruth(survey_path);
  const PlantedGaps gaps = ChooseGaps(truth, num_strips, seed);
  SparseModel model = truth.model;
  CheckWritableDir(fs::path(output_path) / "images");
  std::set<uint32_t> gone;
  for (const PosedImage& image : truth.model.images) {
    if (gaps.removed.count(image.name) || gaps.lost.count(image.name)) gone.insert(image.image_id);
    if (gaps.removed.count(image.name)) continue;
    ColorImage picture = ReadColorImage(fs::path(survey_path) / "images" / image.name);
    PlantInPicture(truth, gaps, image, &picture);
    WriteImage(fs::path(output_path) / "images" / image.name, picture);
  }
  std::vector<PosedImage> kept;
  for (PosedImage& image : model.images) {
    if (!gone.count(image.image_id)) kept.push_back(std::move(image));
  }
  model.images = std::move(kept);
  for (auto it = model.points3D.begin(); it != model.points3D.end();) {
    auto& track = it->second.track;
    const bool is_moving = gaps.moving[0].Contains(it->second.xyz.head<2>()) ||
                           gaps.smooth[0].Contains(it->second.xyz.head<2>());
    track.erase(std::remove_if(track.begin(), track.end(),
                               [&](const auto& e) { return gone.count(e.image_id) > 0; }),
                track.end());
    if (track.size() >= 2 && !is_moving) {
      ++it;
      continue;
    }
    const uint64_t id = it->first;
    for (PosedImage& image : model.images) {
      for (uint64_t& of : image.point3D_ids) {
        if (of == id) of = kNoPoint3D;
      }
    }
    it = model.points3D.erase(it);
  }
  WriteSparseModelText(fs::path(output_path) / "sparse", model);
  WritePlantedGaps(fs::path(output_path) / "planted.json", gaps);
  return 0;
}

// An exact cloud of the whole ground, for what large surveys cost.
int Cover(const std::vector<std::string>& arguments) {
  std::string survey_path, output_path;
  double points = 20e6;
  po::options_description description("completeness_benchmark cover");
  auto add = description.add_options();
  add("help,h", "this text");
  add("survey_path", po::value(&survey_path)->required(), "of demo_survey generate");
  add("output_path", po::value(&output_path)->required(), "PLY");
  add("num_points", Default(&points), "about");
  if (!ParseOptions(description, arguments)) return 0;
  const SurveyTruth truth = ReadSurveyTruth(survey_path);
  const GridSpec& grid = truth.surface.Ground().Grid();
  const double width = grid.MaxX() - grid.MinX(), height = grid.MaxY() - grid.MinY();
  const double step = std::sqrt(width * height / points);
  CloudWriter writer(output_path);
  for (double y = grid.MinY() + step; y < grid.MaxY(); y += step) {
    for (double x = grid.MinX() + step; x < grid.MaxX(); x += step) {
      const SurfaceHit hit = truth.surface.GroundAt(x, y);
      const uint32_t seen_by[2] = {0, 1};
      writer.Add({hit.xyz.cast<float>(), hit.normal.cast<float>(), {0, 0, 0}, 1}, seen_by, 2);
    }
  }
  writer.Finish();
  std::printf("%zu points, %.3f gsd apart\n", static_cast<size_t>(writer.NumPoints()),
              step / truth.gsd);
  return 0;
}

struct ReportedGaps {
  double spacing = 0, covered_share = 0, tolerance = 0;
  struct One {
    GapCause cause;
    AskedArea area;
  };
  std::vector<One> gaps;
};

GapCause CauseOfName(const std::string& name) {
  for (int i = 0; i < kNumGapCauses; ++i) {
    if (name == GapCauseName(static_cast<GapCause>(i))) return static_cast<GapCause>(i);
  }
  throw Error(name, "is no cause of a gap", "give a report of this program");
}

ReportedGaps ReadReported(const SurveyTruth& truth, const fs::path& path) {
  std::ifstream in(path / "completeness.json");
  const Json json = Json::parse(in);
  ReportedGaps reported{
      json.at("spacing"), json.at("covered_share"), json.at("covered_share_tolerance"), {}};
  for (const Json& gap : json.at("gaps")) {
    if (gap.at("layer") != "top") continue;
    ReportedGaps::One one{CauseOfName(gap.at("cause")), {}};
    for (const Json& ring : gap.at("outline")) {
      Ring& corners = one.area.rings.emplace_back();
      for (const Json& p : ring) {
        const Eigen::Vector3d corner(p[0], p[1], p[2]);
        corners.emplace_back(truth.surface.InGround(corner).head<2>());
      }
    }
    reported.gaps.push_back(std::move(one));
  }
  return reported;
}

// Red: a gap that was not found; blue: found, but none; yellow: a gap of another cause; green:
// right. Grey: covered; black: not expected.
void DrawScore(const GapTruth& truth, const std::vector<int>& owner, const ReportedGaps& reported,
               const std::string& path) {
  ColorImage picture(truth.nx, truth.ny, 3);
  for (int j = 0; j < truth.ny; ++j) {
    for (int i = 0; i < truth.nx; ++i) {
      const TruthCell& cell = truth.At(i, j);
      const int g = owner[static_cast<size_t>(j * truth.nx + i)];
      const bool is_missing = cell.is_expected && !cell.is_covered;
      std::array<uint8_t, 3> rgb = {0, 0, 0};
      if (cell.is_covered) rgb = {110, 110, 110};
      if (is_missing) rgb = {170, 150, 150};
      if (cell.is_gap && g < 0) rgb = {255, 0, 0};
      if (!is_missing && g >= 0) rgb = {60, 60, 255};
      if (is_missing && g >= 0) {
        const bool is_right = cell.IsRight(reported.gaps[static_cast<size_t>(g)].cause);
        rgb = is_right ? std::array<uint8_t, 3>{0, 180, 0} : std::array<uint8_t, 3>{240, 220, 0};
      }
      for (int c = 0; c < 3; ++c) picture.At(i, truth.ny - 1 - j, c) = rgb[static_cast<size_t>(c)];
    }
  }
  WriteImage(path, picture);
}

// m^2 on the plan.
struct Tally {
  double truth = 0, found = 0, reported = 0, right = 0, right_cause = 0;
};

struct Tallies {
  Tally all;
  std::map<std::string, Tally> by_cause;
  std::map<std::pair<std::string, std::string>, double> confusion;  // true, said
  double covered = 0, expected = 0;                                 // along the surface
};

// Which reported gap holds each cell; -1: none.
std::vector<int> OwnersOf(const GapTruth& truth, const ReportedGaps& reported) {
  std::vector<int> owner(truth.cells.size(), -1);
  for (size_t g = 0; g < reported.gaps.size(); ++g) {
    Eigen::AlignedBox2d box;
    for (const Ring& ring : reported.gaps[g].area.rings) {
      for (const Eigen::Vector2d& p : ring) box.extend(p);
    }
    for (size_t k = 0; k < owner.size(); ++k) {
      const int i = static_cast<int>(k) % truth.nx, j = static_cast<int>(k) / truth.nx;
      const Eigen::Vector2d p = truth.Place(i, j);
      if (box.contains(p) && reported.gaps[g].area.Contains(p)) owner[k] = static_cast<int>(g);
    }
  }
  return owner;
}

void TallyReported(const TruthCell& cell, const std::string& said, double area, Tallies* t) {
  t->all.reported += area;
  t->by_cause[said].reported += area;
  if (cell.is_expected && !cell.is_covered) {
    t->all.right += area;
    t->by_cause[said].right += area;
  } else {
    t->confusion[{cell.is_expected ? "(covered)" : "(not expected)", said}] += area;
  }
}

// `said`: kNone where no gap was reported.
void TallyGap(const TruthCell& cell, GapCause said, double area, Tallies* t) {
  const std::string cause = GapCauseName(cell.cause);
  const bool is_found = said != GapCause::kNone;
  for (Tally* tally : {&t->all, &t->by_cause[cause]}) {
    tally->truth += area;
    if (is_found) tally->found += area;
    if (is_found && cell.IsRight(said)) tally->right_cause += area;
  }
  if (!is_found || !cell.IsRight(said)) {
    t->confusion[{cause, is_found ? GapCauseName(said) : "-"}] += area;
  }
}

Tallies TallyCells(const GapTruth& truth, const std::vector<int>& owner,
                   const ReportedGaps& reported) {
  Tallies tallies;
  const double area = truth.side * truth.side;
  for (size_t k = 0; k < truth.cells.size(); ++k) {
    const TruthCell& cell = truth.cells[k];
    if (cell.is_expected) tallies.expected += cell.area;
    if (cell.is_covered) tallies.covered += cell.area;
    const GapCause said =
        owner[k] < 0 ? GapCause::kNone : reported.gaps[static_cast<size_t>(owner[k])].cause;
    if (owner[k] >= 0) TallyReported(cell, GapCauseName(said), area, &tallies);
    if (cell.is_gap) TallyGap(cell, said, area, &tallies);
  }
  return tallies;
}

void PrintRow(const char* name, const Tally& t) {
  std::printf(
      "%-15s truth %8.3f m2  recall %5.1f %%  reported %8.3f  precision %5.1f %%  cause %5.1f %%\n",
      name, t.truth, 100 * t.found / std::max(t.truth, 1e-12), t.reported,
      100 * t.right / std::max(t.reported, 1e-12), 100 * t.right_cause / std::max(t.found, 1e-12));
}

void PrintTallies(const Tallies& tallies) {
  for (const auto& [name, tally] : tallies.by_cause) PrintRow(name.c_str(), tally);
  PrintRow("all", tallies.all);
  for (const auto& [pair, area] : tallies.confusion) {
    if (area > 0.01 * tallies.all.truth) {
      std::printf("   %s said to be %s: %.3f m2\n", pair.first.c_str(), pair.second.c_str(), area);
    }
  }
}

int Score(const std::vector<std::string>& arguments) {
  std::string survey_path, planted_path, cloud_path, report_path, picture_path;
  po::options_description description("completeness_benchmark score");
  auto add = description.add_options();
  add("help,h", "this text");
  add("survey_path", po::value(&survey_path)->required(), "of demo_survey generate");
  add("planted_path", po::value(&planted_path), "of plant; without it nothing was planted");
  add("cloud_path", po::value(&cloud_path)->required(), "PLY, exact poses");
  add("report_path", po::value(&report_path)->required(), "of completeness_reporter");
  add("picture_path", po::value(&picture_path), "PNG to write: what is right, and what not");
  if (!ParseOptions(description, arguments)) return 0;
  const SurveyTruth truth = ReadSurveyTruth(survey_path);
  const ReportedGaps reported = ReadReported(truth, report_path);
  const PlantedGaps planted = planted_path.empty()
                                  ? PlantedGaps()
                                  : ReadPlantedGaps(fs::path(planted_path) / "planted.json");
  std::vector<Eigen::Vector3f> points, sure;
  const CompletenessOptions defaults;
  for (const CloudPoint& p : ReadCloud(cloud_path)) {
    points.push_back(p.xyz);
    if (p.confidence >= defaults.min_confidence) sure.push_back(p.xyz);
  }
  const GapTruth gaps = MeasureGapTruth(truth, planted, sure, -1);
  const std::vector<int> owner = OwnersOf(gaps, reported);
  if (!picture_path.empty()) DrawScore(gaps, owner, reported, picture_path);
  const Tallies tallies = TallyCells(gaps, owner, reported);
  PrintTallies(tallies);
  std::printf("falsely covered: ours %.3f m2, footprints %.3f m2, views of points %.3f m2\n",
              tallies.all.truth - tallies.all.found,
              FalselyCovered(gaps, FootprintMap(truth, planted, gaps)),
              FalselyCovered(gaps, ViewsMap(truth, points, gaps)));
  std::printf("covered share: said %.2f +- %.2f %%, true %.2f %% (spacing: said %.4f, true %.4f)\n",
              100 * reported.covered_share, 100 * reported.tolerance,
              100 * tallies.covered / tallies.expected, reported.spacing, gaps.spacing);
  return 0;
}

}  // namespace
}  // namespace colmap_seapoint

int main(int argc, char** argv) {
  using namespace colmap_seapoint;
  return RunSubcommands(argc, argv, "completeness_benchmark", kUsage,
                        {{"plant", Plant}, {"cover", Cover}, {"score", Score}});
}
