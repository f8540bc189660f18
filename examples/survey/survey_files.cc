#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

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
  if (o.revisit > 0) json["revisit"] = o.revisit;  // surveys without one keep their bytes
  return json;
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

HeightField ReadSurface(const std::filesystem::path& dir) {
  const nlohmann::ordered_json json = ReadJson(dir / "surface.json");
  GridSpec grid;
  try {
    grid.ix0 = json.at("first_node_x");
    grid.iy0 = json.at("first_node_y");
    grid.nx = json.at("num_nodes_x");
    grid.ny = json.at("num_nodes_y");
    grid.step = json.at("cell");
  } catch (const nlohmann::json::exception& e) {
    throw Error((dir / "surface.json").string(), e.what(), kRemedy);
  }
  const std::filesystem::path path = dir / "surface.bin";
  std::error_code code;
  const auto size = std::filesystem::file_size(path, code);
  if (code || grid.nx < 2 || grid.ny < 2 || size != grid.Size() * sizeof(float)) {
    throw Error(path.string(), "is missing or has another size than surface.json says", kRemedy);
  }
  Field heights(grid.Size());
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(heights.data()), static_cast<std::streamsize>(size));
  if (!file) throw Error(path.string(), "cannot be read", kRemedy);
  return HeightField(grid, std::move(heights));
}

}  // namespace

void WriteSurveyTruth(const std::filesystem::path& dir, const SurveyOptions& options,
                      const SurveyTruth& truth) {
  const std::filesystem::path truth_dir = dir / "truth";
  std::filesystem::create_directories(truth_dir);
  WriteSparseModelText(truth_dir / "sparse", truth.model);
  AtomicFile surface(truth_dir / "surface.bin");
  surface.Write(truth.surface.Heights().data(), truth.surface.Heights().size() * sizeof(float));
  surface.Commit();
  const GridSpec& grid = truth.surface.Grid();
  const nlohmann::ordered_json surface_json = {
      {"what",
       "node (i, j) lies at x = (first_node_x + i) * cell, y = (first_node_y + j) * cell; "
       "surface.bin holds its z; bilinear between the nodes"},
      {"first_node_x", grid.ix0},
      {"first_node_y", grid.iy0},
      {"num_nodes_x", grid.nx},
      {"num_nodes_y", grid.ny},
      {"cell", grid.step},
      {"min_z", truth.surface.MinHeight()},
      {"max_z", truth.surface.MaxHeight()}};
  WriteTextFile(truth_dir / "surface.json", surface_json.dump(2) + "\n");
  const nlohmann::ordered_json survey_json = {{"gsd", truth.gsd},
                                              {"unit", "metre"},
                                              {"num_images", truth.model.images.size()},
                                              {"camera_model", "OPENCV"},
                                              {"camera_params", ParamsText(truth.model)},
                                              {"options", OptionsJson(options)}};
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
  truth.model = ReadSparseModel(truth_dir / "sparse");
  truth.surface = ReadSurface(truth_dir);
  return truth;
}

}  // namespace colmap_seapoint
