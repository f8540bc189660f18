#include "colmap_seapoint/pipeline/page/completeness_page.h"

#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/gaps/gap_files.h"
#include "colmap_seapoint/gaps/gap_map.h"
#include "colmap_seapoint/io/files/input_stream.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/page/html_page.h"
#include "colmap_seapoint/page/section.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kMosaicSide = 1800;  // pixels
constexpr size_t kMaxLayers = 8;

ColorImage ReadIfReadable(const fs::path& path) {
  try {
    return ReadColorImage(path);
  } catch (const Error&) {
    return {};  // it is named among what was left out already
  }
}

std::vector<std::pair<std::string, ColorImage>> OtherLayers(const CompletenessResult& result,
                                                            const std::string& unit) {
  std::set<LayerKey> keys;
  for (const Gap& gap : result.gaps) keys.insert(gap.region.layer);
  keys.erase({Side::kTop, 0});
  std::vector<std::pair<std::string, ColorImage>> layers;
  for (const LayerKey& key : keys) {
    if (layers.size() < kMaxLayers) {
      layers.emplace_back(LayerName(key), DrawGapMap(result, key, unit));
    }
  }
  return layers;
}

Eigen::Vector3d MiddleOf(const std::vector<ColoredPoint>& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const ColoredPoint& point : points) sum += point.xyz;
  return points.empty() ? sum : Eigen::Vector3d(sum / static_cast<double>(points.size()));
}

// What the densifier wrote beside the cloud; "" where it did not.
std::string JobBeside(const fs::path& cloud_path) {
  const fs::path path = cloud_path.parent_path() / "run.json";
  const auto in = OpenIfThere(path);
  if (in == nullptr) return "";
  try {
    Json job = Json::parse(std::string{std::istreambuf_iterator<char>(*in), {}});
    for (const char* name :
         {"command", "version", "images_in", "images_used", "points", "left_out", "stages"}) {
      if (!job.contains(name)) return "";  // another program's
    }
    job.erase("inputs");
    return job.dump();
  } catch (const Json::exception&) {
    return "";
  }
}

}  // namespace

std::string CompletenessPage(const CompletenessPageInput& input) {
  const Ground& ground = input.result.ground;
  SectionInput section;
  section.model = &input.model;
  section.result = &input.result;
  section.places = &input.places;
  section.answer = input.answer;
  section.maps = DrawGroundMaps(input.result, input.places.Unit());
  if (!input.map_path.empty()) {
    section.mosaic = ReadMosaic(input.map_path, ground.frame, MiddleOf(input.points), kMosaicSide);
  }
  if (!input.image_path.empty()) {
    section.gap_pictures = CutGapPictures(
        input.result, input.model,
        [&](const std::string& name) { return ReadIfReadable(input.image_path / name); },
        input.num_threads);
  }
  section.layers = OtherLayers(input.result, input.places.Unit());
  section.cloud = PackCloud(input.points, ground.frame.map_from_world);
  const TrackInput track = {&input.model, &input.result.records, &input.brightness};
  section.track = FollowTrack(track);
  section.hints = HintsOf(track, section.track);
  section.pairs = ReadPairRows(input.cloud_path.parent_path() / "pairs.csv");
  PageContent page;
  page.title = "Did we cover it all?";
  page.answer = input.answer;
  page.sections = {SectionJson(section)};
  page.names = {""};
  page.job = JobBeside(input.cloud_path);
  return HtmlPage(std::move(page));
}

}  // namespace colmap_seapoint
