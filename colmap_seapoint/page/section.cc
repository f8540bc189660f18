#include "colmap_seapoint/page/section.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "colmap_seapoint/gaps/gap_colors.h"
#include "colmap_seapoint/gaps/gap_files.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/page/base64.h"
#include "colmap_seapoint/report/format_text.h"

namespace colmap_seapoint {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kCropQuality = 78, kMosaicQuality = 82;

std::string PngUri(const Image<uint8_t>& image) {
  const std::vector<uint8_t> bytes = EncodePng(image);
  return DataUri("image/png", bytes.data(), bytes.size());
}

std::string JpegUri(const ColorImage& image, int quality) {
  const std::vector<uint8_t> bytes = EncodeJpeg(image, quality);
  return DataUri("image/jpeg", bytes.data(), bytes.size());
}

// Places of the world on the plan, and numbers no longer than they are exact.
class PlanWriter {
 public:
  explicit PlanWriter(const Ground& ground)
      : map_from_world_(ground.frame.map_from_world),
        digit_(std::pow(10.0, std::floor(std::log10(ground.cell_side)) - 2)) {}

  double Number(double value) const {
    // Through text, so that 0.1 is not 0.1000000001.
    return std::stod(Format("%.12g", std::round(value / digit_) * digit_));
  }
  Json Place(const Eigen::Vector3d& world) const {
    const Eigen::Vector3d p = map_from_world_ * world;
    return {Number(p.x()), Number(p.y()), Number(p.z())};
  }
  Json Line(const std::vector<Eigen::Vector3d>& corners) const {
    Json line = Json::array();
    for (const Eigen::Vector3d& corner : corners) line.push_back(Place(corner));
    return line;
  }
  Json Direction(const Eigen::Vector3d& world) const {
    const Eigen::Vector3d d = map_from_world_ * world;
    const auto rounded = [](double v) { return std::round(v * 1000) / 1000; };
    return {rounded(d.x()), rounded(d.y()), rounded(d.z())};
  }

 private:
  Eigen::Matrix3d map_from_world_;
  double digit_;
};

// null where nothing was checked.
Json SelfCheckJson(const SelfCheck& check) {
  if (check.num_folds == 0) return nullptr;
  return {{"hidden_area", check.hidden_area},
          {"found_share", check.found_share},
          {"area_error", check.area_error}};
}

Json FiguresJson(const SectionInput& input) {
  const CompletenessResult& result = *input.result;
  Json coverage = Json::array(), missing = Json::array();
  for (const CoverageAt& at : result.coverage) {
    coverage.push_back({{"spacing", at.spacing}, {"area", at.area}, {"share", at.share}});
  }
  for (size_t c = 1; c < result.missing_area.size(); ++c) {
    const auto cause = static_cast<GapCause>(c);
    if (cause == GapCause::kOutOfArea || result.missing_area[c] <= 0) continue;
    missing.push_back({{"cause", GapCauseName(cause)}, {"area", result.missing_area[c]}});
  }
  return {{"tolerance", result.share_tolerance},
          {"self_check", SelfCheckJson(result.self_check)},
          {"expected_area", result.expected_area},
          {"coverage", std::move(coverage)},
          {"missing", std::move(missing)},
          {"unlisted_area", result.unlisted_area},
          {"gsd", result.gsd},
          {"points_per_area", result.points_per_area},
          {"mean_views", result.mean_views},
          {"parallax_deg", result.median_parallax_deg},
          {"route_length", result.route_length}};
}

Json CausesJson() {
  Json causes = Json::object();
  for (int c = 1; c < kNumGapCauses; ++c) {
    const auto cause = static_cast<GapCause>(c);
    const std::array<uint8_t, 3> color = CauseColor(cause);
    causes[GapCauseName(cause)] = {
        {"text", CauseText(cause)},
        {"color", Format("#%02x%02x%02x", color[0], color[1], color[2])}};
  }
  return causes;
}

Json MapsJson(const SectionInput& input) {
  const GroundMaps& maps = input.maps;
  Json list = Json::array();
  for (const GroundMap& map : maps.maps) {
    Json legend = Json::array();
    for (const LegendEntry& entry : map.legend) legend.push_back({entry.color, entry.text});
    list.push_back({{"key", map.key},
                    {"title", map.title},
                    {"note", map.note},
                    {"src", PngUri(map.picture)},
                    {"legend", std::move(legend)}});
  }
  Json json = {{"left", maps.left},
               {"top", maps.top},
               {"right", maps.right},
               {"bottom", maps.bottom},
               {"list", std::move(list)}};
  if (input.mosaic) {
    const auto& m = input.mosaic->plan_from_pixel;
    json["mosaic"] = {{"src", JpegUri(input.mosaic->picture, kMosaicQuality)},
                      {"width", input.mosaic->picture.width},
                      {"height", input.mosaic->picture.height},
                      {"plan_from_pixel", {m(0, 0), m(1, 0), m(0, 1), m(1, 1), m(0, 2), m(1, 2)}}};
  }
  Json layers = Json::array();
  for (const auto& [name, picture] : input.layers) {
    layers.push_back({{"name", name}, {"src", PngUri(picture)}});
  }
  json["layers"] = std::move(layers);
  return json;
}

Json GapPictureJson(const GapPicture& picture) {
  Json outline = Json::array();
  for (const auto& ring : picture.outline) {
    Json& corners = outline.emplace_back(Json::array());
    for (const Eigen::Vector2d& p : ring) {
      corners.push_back(Json{std::round(p.x()), std::round(p.y())});
    }
  }
  return {{"name", picture.name},
          {"shows_gap", picture.shows_gap},
          {"src", JpegUri(picture.crop, kCropQuality)},
          {"width", picture.crop.width},
          {"height", picture.crop.height},
          {"outline", std::move(outline)}};
}

Json PassJson(const ClosingPass& pass, const PlanWriter& plan) {
  return {{"corners", plan.Line(pass.corners)},
          {"heading_deg", std::round(pass.heading_deg)},
          {"altitude", plan.Number(pass.altitude)},
          {"tilt_deg", std::round(pass.tilt_deg)},
          {"lines", pass.num_lines},
          {"pictures", pass.num_pictures},
          {"length", plan.Number(pass.length)}};
}

// The middle of the gap's cell that is nearest to its centroid, which may lie outside of the gap.
Eigen::Vector3d MarkOf(const Gap& gap, const Ground& ground) {
  const GroundLayer& layer = ground.layers.at(gap.region.layer);
  const Eigen::Vector3d centroid = layer.layer_from_world * gap.centroid;
  Eigen::Vector3d nearest = gap.centroid;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [x, y] : gap.region.cells) {
    const Eigen::Vector3d place = ground.PlaceOf(layer, x, y, centroid.z());
    const double distance = (place - gap.centroid).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    nearest = place;
  }
  return nearest;
}

Json GapJson(const SectionInput& input, size_t index, const PlanWriter& plan) {
  const Gap& gap = input.result->gaps[index];
  Json outline = Json::array(), names = Json::array(), pictures = Json::array();
  for (const auto& ring : gap.outline) outline.push_back(plan.Line(ring));
  for (const int i : gap.pictures) {
    names.push_back(input.model->images[static_cast<size_t>(i)].name);
  }
  if (index < input.gap_pictures.size()) {
    for (const GapPicture& picture : input.gap_pictures[index]) {
      pictures.push_back(GapPictureJson(picture));
    }
  }
  const Eigen::Vector3d place = input.places->Write(gap.centroid);
  return {{"id", gap.id},
          {"cause", GapCauseName(gap.region.cause)},
          {"layer", LayerName(gap.region.layer)},
          {"area", gap.region.area},
          {"middle", plan.Place(MarkOf(gap, input.result->ground))},
          {"place", input.places->IsGeographic()
                        ? Format("%.7f, %.7f, %.2f", place.y(), place.x(), place.z())
                        : Format("%.4g, %.4g, %.4g", place.x(), place.y(), place.z())},
          {"outline", std::move(outline)},
          {"names", std::move(names)},
          {"pictures", std::move(pictures)},
          {"pass", PassJson(gap.pass, plan)}};
}

Json TrackJson(const SectionInput& input, const PlanWriter& plan) {
  Json pictures = Json::array(), hints = Json::array(), pairs = Json::array();
  for (const TrackPicture& picture : input.track) {
    const auto i = static_cast<size_t>(picture.image_idx);
    pictures.push_back({{"name", input.model->images[i].name},
                        {"center", plan.Place(picture.center)},
                        {"axis", plan.Direction(picture.axis)},
                        {"distance", plan.Number(picture.distance)},
                        {"overlap", std::round(picture.overlap * 1000) / 1000},
                        {"covered", std::round(picture.covered * 1000) / 1000},
                        {"is_bad", input.result->records[i].is_bad}});
  }
  for (const TrackHint& hint : input.hints) {
    hints.push_back({{"text", hint.text}, {"first", hint.first}, {"last", hint.last}});
  }
  for (const PairRow& pair : input.pairs) {
    pairs.push_back(Json{pair.image1, pair.image2, std::round(pair.overlap * 1000) / 1000,
                         pair.num_points, pair.skipped});
  }
  return {
      {"pictures", std::move(pictures)}, {"hints", std::move(hints)}, {"pairs", std::move(pairs)}};
}

Json CloudJson(const PackedCloud& cloud) {
  return {{"count", cloud.colors.size() / 3},
          {"low", {cloud.low.x(), cloud.low.y(), cloud.low.z()}},
          {"step", cloud.step},
          {"codes", Base64(cloud.codes.data(), cloud.codes.size())},
          {"colors", Base64(cloud.colors.data(), cloud.colors.size())}};
}

Json LostJson(const SectionInput& input) {
  const auto name = [&](int i) {
    return i < 0 ? Json(nullptr) : Json(input.model->images[static_cast<size_t>(i)].name);
  };
  Json lost = Json::array();
  for (const LostRun& run : input.result->lost_runs) {
    lost.push_back(
        {{"names", run.names}, {"before", name(run.before)}, {"after", name(run.after)}});
  }
  return lost;
}

}  // namespace

std::string SectionJson(const SectionInput& input) {
  const CompletenessResult& result = *input.result;
  const PlanWriter plan(result.ground);
  Json json = {{"answer", input.answer},
               {"unit", input.places->Unit()},
               {"frame", input.places->Description()},
               {"is_north_up", input.places->IsGeographic() && result.ground.frame.IsWorld()},
               {"is_geographic", input.places->IsGeographic()}};
  json["figures"] = FiguresJson(input);
  json["causes"] = CausesJson();
  json["map"] = MapsJson(input);
  Json& gaps = json["gaps"] = Json::array();
  for (size_t i = 0; i < result.gaps.size(); ++i) gaps.push_back(GapJson(input, i, plan));
  Json& route = json["route"] = Json::array();
  for (const RouteStop& stop : result.route) {
    route.push_back({{"gap", stop.pass}, {"is_reversed", stop.is_reversed}});
  }
  json["track"] = TrackJson(input, plan);
  json["lost"] = LostJson(input);
  json["cloud"] = CloudJson(input.cloud);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace colmap_seapoint
