#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "examples/survey/survey.h"

namespace colmap_seapoint {
namespace {

constexpr char kRemedy[] = "make it again with demo_survey generate";

nlohmann::ordered_json ReadJson(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw Error(path.string(), "cannot be read", "give the folder of a demo survey");
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(file, nullptr, false);
  if (json.is_discarded()) throw Error(path.string(), "is no JSON", kRemedy);
  return json;
}

const char* CameraModelName(const SurveyOptions& options) {
  return FindCameraModel(static_cast<int>(options.camera_model))->name;
}

nlohmann::ordered_json OptionsJson(const SurveyOptions& o) {
  nlohmann::ordered_json json = {{"seed", o.seed},
                                 {"num_strips", o.num_strips},
                                 {"images_per_strip", o.images_per_strip},
                                 {"width", o.width},
                                 {"height", o.height},
                                 {"forward_overlap", o.forward_overlap},
                                 {"side_overlap", o.side_overlap},
                                 {"altitude", o.altitude},
                                 {"field_of_view", o.field_of_view_deg},
                                 {"relief", o.relief},
                                 {"turbidity", o.turbidity},
                                 {"caustics", o.caustics},
                                 {"marine_snow", o.marine_snow},
                                 {"noise", o.noise},
                                 {"jitter", o.jitter},
                                 {"image_format", o.image_format}};
  // What came later is written where it is used: surveys without it keep their bytes.
  if (o.revisit > 0) json["revisit"] = o.revisit;
  if (o.path != SurveyPath::kStrips) json["path"] = SurveyPathName(o.path);
  if (o.path == SurveyPath::kSwim) json["pitch"] = o.pitch_deg;
  if (o.roll_deg != 0) json["roll"] = o.roll_deg;
  if (o.max_range > 0) json["max_range"] = o.max_range;
  if (o.markers > 0) {
    json["markers"] = o.markers;
    json["marker_size"] = o.marker_size;
    json["marker_bar"] = o.marker_bar;
  }
  if (o.camera_model != CameraModel::kOpenCV) json["camera_model"] = CameraModelName(o);
  if (o.port.kind != PortKind::kNone) json["port"] = PortKindName(o.port.kind);
  return json;
}

nlohmann::ordered_json PortJson(const PortOptions& port) {
  nlohmann::ordered_json json = {{"kind", PortKindName(port.kind)}, {"thickness", port.thickness}};
  if (port.kind == PortKind::kFlat) {
    json["distance"] = port.distance;
    json["tilt"] = port.tilt_deg;
  } else {
    json["radius"] = port.radius;
    json["decentring"] = port.decentring;
    json["sideways"] = port.sideways;
  }
  return json;
}

PortOptions ReadPort(const nlohmann::ordered_json& json) {
  PortOptions port;
  port.kind = ParsePortKind(json.at("kind").get<std::string>());
  port.thickness = json.at("thickness");
  port.distance = json.value("distance", port.distance);
  port.tilt_deg = json.value("tilt", port.tilt_deg);
  port.radius = json.value("radius", port.radius);
  port.decentring = json.value("decentring", port.decentring);
  port.sideways = json.value("sideways", port.sideways);
  return port;
}

// The lens in the form that --ImageReader.camera_params takes, for runs with a calibrated camera.
std::string ParamsText(const SparseModel& model) {
  std::string text;
  for (double param : model.cameras.at(1).params) {
    char number[32];
    std::snprintf(number, sizeof(number), "%s%.10g", text.empty() ? "" : ",", param);
    text += number;
  }
  return text;
}

nlohmann::ordered_json MarkersJson(const std::vector<MarkerBoard>& boards) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const MarkerBoard& board : boards) {
    json.push_back({{"marker", MarkerText(board.name)},
                    {"centre", {board.centre.x(), board.centre.y(), board.centre.z()}},
                    {"turn", board.turn},
                    {"size", board.size}});
  }
  return json;
}

std::vector<MarkerBoard> ReadMarkers(const nlohmann::ordered_json& json) {
  std::vector<MarkerBoard> boards;
  for (const auto& item : json) {
    const auto name = ParseMarkerName(item.at("marker").get<std::string>()).name;
    const auto centre = item.at("centre").get<std::array<double, 3>>();
    if (name) {
      boards.push_back(
          {*name, {centre[0], centre[1], centre[2]}, item.at("turn"), item.at("size")});
    }
  }
  return boards;
}

// Two boards each.
std::string BarsCsv(const std::vector<MarkerBoard>& boards) {
  std::string text = "name1,name2,length_m,sigma_m\n";
  for (size_t k = 0; k + 1 < boards.size(); k += 2) {
    char length[64];
    std::snprintf(length, sizeof(length), ",%.6f,0.001\n",
                  (boards[k + 1].centre - boards[k].centre).norm());
    text += MarkerText(boards[k].name) + "," + MarkerText(boards[k + 1].name) + length;
  }
  return text;
}

std::vector<float> ReadFloats(const std::filesystem::path& path, size_t count) {
  std::error_code code;
  const auto size = std::filesystem::file_size(path, code);
  if (code || size != count * sizeof(float)) {
    throw Error(path.string(), "is missing or has another size than surface.json says", kRemedy);
  }
  std::vector<float> values(count);
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(size));
  if (!file) throw Error(path.string(), "cannot be read", kRemedy);
  return values;
}

Rigid3d ReadTurn(const nlohmann::ordered_json& json) {
  Rigid3d world_from_ground;
  if (!json.contains("world_from_ground")) return world_from_ground;
  const auto numbers = json["world_from_ground"].get<std::array<double, 7>>();
  world_from_ground.rotation =
      Eigen::Quaterniond(numbers[0], numbers[1], numbers[2], numbers[3]).normalized();
  world_from_ground.translation = {numbers[4], numbers[5], numbers[6]};
  return world_from_ground;
}

Sheet ReadObject(const std::filesystem::path& dir, const nlohmann::ordered_json& json) {
  if (!json.contains("object")) return Sheet();
  const auto& object = json["object"];
  const int nx = object.at("num_nodes_x"), ny = object.at("num_nodes_y");
  if (nx < 2 || ny < 2) throw Error((dir / "surface.json").string(), "has no object", kRemedy);
  const size_t count = static_cast<size_t>(nx) * static_cast<size_t>(ny);
  const std::vector<float> values = ReadFloats(dir / "object.bin", 3 * count);
  std::vector<Eigen::Vector3f> nodes(count);
  for (size_t i = 0; i < count; ++i) nodes[i] = Eigen::Map<const Eigen::Vector3f>(&values[3 * i]);
  return Sheet(nx, ny, std::move(nodes), object.at("cell"));
}

Surface ReadSurface(const std::filesystem::path& dir) {
  const nlohmann::ordered_json json = ReadJson(dir / "surface.json");
  try {
    GridSpec grid;
    grid.ix0 = json.at("first_node_x");
    grid.iy0 = json.at("first_node_y");
    grid.nx = json.at("num_nodes_x");
    grid.ny = json.at("num_nodes_y");
    grid.step = json.at("cell");
    if (grid.nx < 2 || grid.ny < 2) {
      throw Error((dir / "surface.json").string(), "has no nodes", kRemedy);
    }
    return Surface(HeightField(grid, ReadFloats(dir / "surface.bin", grid.Size())), ReadTurn(json),
                   ReadObject(dir, json));
  } catch (const nlohmann::json::exception& e) {
    throw Error((dir / "surface.json").string(), e.what(), kRemedy);
  }
}

nlohmann::ordered_json SurfaceJson(const Surface& surface) {
  const GridSpec& grid = surface.Ground().Grid();
  nlohmann::ordered_json json = {
      {"what",
       "node (i, j) lies at x = (first_node_x + i) * cell, y = (first_node_y + j) * cell; "
       "surface.bin holds its z; bilinear between the nodes"},
      {"first_node_x", grid.ix0},
      {"first_node_y", grid.iy0},
      {"num_nodes_x", grid.nx},
      {"num_nodes_y", grid.ny},
      {"cell", grid.step},
      {"min_z", surface.Ground().MinHeight()},
      {"max_z", surface.Ground().MaxHeight()}};
  const Rigid3d& turn = surface.WorldFromGround();
  if (!turn.rotation.vec().isZero(0)) {
    json["world_from_ground"] = {turn.rotation.w(),   turn.rotation.x(),    turn.rotation.y(),
                                 turn.rotation.z(),   turn.translation.x(), turn.translation.y(),
                                 turn.translation.z()};
  }
  if (!surface.Object().Empty()) {
    json["object"] = {
        {"what", "object.bin holds x, y, z of the nodes; two triangles a cell: 00 10 11, 00 11 01"},
        {"num_nodes_x", surface.Object().NumX()},
        {"num_nodes_y", surface.Object().NumY()},
        {"cell", surface.Object().Step()}};
  }
  return json;
}

void WriteFloats(const std::filesystem::path& path, const float* values, size_t count) {
  AtomicFile file(path);
  file.Write(values, count * sizeof(float));
  file.Commit();
}

}  // namespace

void WriteSurveyTruth(const std::filesystem::path& dir, const SurveyOptions& options,
                      const SurveyTruth& truth) {
  const std::filesystem::path truth_dir = dir / "truth";
  std::filesystem::create_directories(truth_dir);
  WriteSparseModelText(truth_dir / "sparse", truth.model);
  const Field& heights = truth.surface.Ground().Heights();
  WriteFloats(truth_dir / "surface.bin", heights.data(), heights.size());
  const std::vector<Eigen::Vector3f>& nodes = truth.surface.Object().Nodes();
  if (!nodes.empty()) WriteFloats(truth_dir / "object.bin", nodes[0].data(), 3 * nodes.size());
  WriteTextFile(truth_dir / "surface.json", SurfaceJson(truth.surface).dump(2) + "\n");
  nlohmann::ordered_json survey_json = {{"gsd", truth.gsd},
                                        {"unit", "metre"},
                                        {"num_images", truth.model.images.size()},
                                        {"camera_model", CameraModelName(options)},
                                        {"camera_params", ParamsText(truth.model)},
                                        {"options", OptionsJson(options)}};
  if (!truth.boards.empty()) {
    survey_json["markers"] = MarkersJson(truth.boards);
    WriteTextFile(truth_dir / "bars.csv", BarsCsv(truth.boards));
  }
  if (std::isfinite(truth.max_range)) survey_json["max_range"] = truth.max_range;
  if (truth.port.kind != PortKind::kNone) survey_json["port"] = PortJson(truth.port);
  WriteTextFile(truth_dir / "survey.json", survey_json.dump(2) + "\n");
}

SurveyTruth ReadSurveyTruth(const std::filesystem::path& dir) {
  const std::filesystem::path truth_dir = dir / "truth";
  SurveyTruth truth;
  const nlohmann::ordered_json json = ReadJson(truth_dir / "survey.json");
  if (!json.is_object() || !json.contains("gsd") || !json["gsd"].is_number() || json["gsd"] <= 0) {
    throw Error((truth_dir / "survey.json").string(), "has no gsd", kRemedy);
  }
  truth.gsd = json["gsd"];
  if (json.contains("max_range") && json["max_range"].is_number()) {
    truth.max_range = json["max_range"];
  }
  try {
    if (json.contains("port")) truth.port = ReadPort(json["port"]);
  } catch (const nlohmann::json::exception& e) {
    throw Error((truth_dir / "survey.json").string(), e.what(), kRemedy);
  }
  truth.model = ReadSparseModel(truth_dir / "sparse");
  truth.surface = ReadSurface(truth_dir);
  if (json.contains("markers")) {
    try {
      truth.boards = ReadMarkers(json["markers"]);
    } catch (const nlohmann::json::exception& e) {
      throw Error((truth_dir / "survey.json").string(), e.what(), kRemedy);
    }
  }
  return truth;
}

}  // namespace colmap_seapoint
