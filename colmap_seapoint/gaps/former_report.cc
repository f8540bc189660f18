#include "colmap_seapoint/gaps/former_report.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/similarity3.h"
#include "colmap_seapoint/gaps/gap_files.h"
#include "colmap_seapoint/io/files/input_stream.h"

namespace colmap_seapoint {
namespace {

using Json = nlohmann::ordered_json;

constexpr size_t kMinCommonPictures = 3;
constexpr double kMaxMisfit = 0.05;  // of the cameras' extent

using PosePair = std::pair<Rigid3d, Rigid3d>;  // before, now

FormerOutline ReadGap(const Json& json) {
  FormerOutline gap;
  gap.id = json.at("id").get<int>();
  ParseLayerName(json.at("layer").get<std::string>(), &gap.layer);
  for (const Json& ring : json.at("outline")) {
    auto& corners = gap.rings.emplace_back();
    for (const Json& p : ring) {
      corners.emplace_back(p.at(0).get<double>(), p.at(1).get<double>(), p.at(2).get<double>());
    }
  }
  return gap;
}

Json OutlineJson(const FormerOutline& gap, double area) {
  Json outline = Json::array();
  for (const auto& corners : gap.rings) {
    Json& ring = outline.emplace_back(Json::array());
    for (const Eigen::Vector3d& p : corners) ring.push_back({p.x(), p.y(), p.z()});
  }
  return {{"id", gap.id},
          {"area", area},
          {"layer", LayerName(gap.layer)},
          {"outline", std::move(outline)}};
}

FormerPicture ReadPicture(const Json& json) {
  const auto pose = json.at("cam_from_world").get<std::vector<double>>();
  FormerPicture picture;
  picture.name = json.at("name").get<std::string>();
  picture.cam_from_world.rotation =
      Eigen::Quaterniond(pose.at(0), pose.at(1), pose.at(2), pose.at(3));
  picture.cam_from_world.translation = Eigen::Vector3d(pose.at(4), pose.at(5), pose.at(6));
  return picture;
}

bool IsSame(const PosePair& pair) {
  return pair.first.rotation.coeffs() == pair.second.rotation.coeffs() &&
         pair.first.translation == pair.second.translation;
}

std::vector<PosePair> CommonPictures(const SparseModel& model, const FormerReport& report) {
  std::map<std::string, const PosedImage*> images;
  for (const PosedImage& image : model.images) images[image.name] = &image;
  std::vector<PosePair> common;
  for (const FormerPicture& picture : report.pictures) {
    const auto found = images.find(picture.name);
    if (found == images.end()) continue;
    common.emplace_back(picture.cam_from_world, found->second->cam_from_world);
  }
  return common;
}

// The mean of what the pictures were turned by: a straight track alone would not tell it.
Eigen::Quaterniond MeanRotation(const std::vector<PosePair>& pairs) {
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  for (const auto& [before, now] : pairs) {
    const Eigen::Vector4d turn = (now.rotation.conjugate() * before.rotation).coeffs();
    sum += turn.dot(sum) < 0 ? Eigen::Vector4d(-turn) : turn;
  }
  return Eigen::Quaterniond(sum.normalized());
}

// nullopt where the centres do not fit.
std::optional<Similarity3d> NowFromBefore(const std::vector<PosePair>& pairs) {
  Eigen::Vector3d mean_before = Eigen::Vector3d::Zero(), mean_now = mean_before;
  for (const auto& [before, now] : pairs) {
    mean_before += before.OriginInSource() / static_cast<double>(pairs.size());
    mean_now += now.OriginInSource() / static_cast<double>(pairs.size());
  }
  double spread_before = 0, spread_now = 0, misfit = 0;
  for (const auto& [before, now] : pairs) {
    spread_before += (before.OriginInSource() - mean_before).squaredNorm();
    spread_now += (now.OriginInSource() - mean_now).squaredNorm();
  }
  Similarity3d similarity;
  similarity.scale = std::sqrt(spread_now / spread_before);
  similarity.rotation = MeanRotation(pairs);
  similarity.translation = mean_now - similarity.scale * (similarity.rotation * mean_before);
  for (const auto& [before, now] : pairs) {
    misfit += (similarity * before.OriginInSource() - now.OriginInSource()).squaredNorm();
  }
  if (!(misfit <= kMaxMisfit * kMaxMisfit * spread_now)) return std::nullopt;
  return similarity;
}

}  // namespace

FormerReport ParseFormerReport(const std::string& text, const std::string& origin) {
  FormerReport report;
  try {
    const Json json = Json::parse(text);
    report.last_id = json.at("last_gap_id").get<int>();
    for (const Json& gap : json.at("gaps")) {
      report.gaps.push_back(ReadGap(gap));
      report.areas.push_back(gap.at("area").get<double>());
    }
    for (const Json& picture : json.at("pictures")) {
      if (picture.contains("cam_from_world")) report.pictures.push_back(ReadPicture(picture));
    }
  } catch (const std::exception& e) {  // json's, and std::out_of_range
    throw Error(origin, "is no report of ours (" + std::string(e.what()) + ")",
                "move it away, or choose another --output_path");
  }
  return report;
}

std::string FormerReportText(const FormerReport& report) {
  Json gaps = Json::array(), pictures = Json::array();
  for (size_t i = 0; i < report.gaps.size(); ++i) {
    gaps.push_back(OutlineJson(report.gaps[i], report.areas[i]));
  }
  for (const FormerPicture& picture : report.pictures) {
    pictures.push_back(
        {{"name", picture.name}, {"cam_from_world", PoseNumbers(picture.cam_from_world)}});
  }
  const Json json = {{"last_gap_id", report.last_id},
                     {"gaps", std::move(gaps)},
                     {"pictures", std::move(pictures)}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

FormerReport ReadFormerReport(const std::filesystem::path& path) {
  const auto in = OpenIfThere(path);
  if (in == nullptr) return {};
  return ParseFormerReport(std::string{std::istreambuf_iterator<char>(*in), {}}, path.string());
}

std::vector<double> PoseNumbers(const Rigid3d& pose) {
  const Eigen::Quaterniond& q = pose.rotation;
  const Eigen::Vector3d& t = pose.translation;
  return {q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z()};
}

void MoveToModel(const SparseModel& model, FormerReport* report) {
  if (report->pictures.empty() || report->gaps.empty()) return;
  const std::vector<PosePair> common = CommonPictures(model, *report);
  if (common.size() >= kMinCommonPictures && std::all_of(common.begin(), common.end(), IsSame)) {
    return;
  }
  std::optional<Similarity3d> move;
  if (common.size() >= kMinCommonPictures) move = NowFromBefore(common);
  if (!move) {
    report->gaps.clear();
    report->areas.clear();
    return;
  }
  for (FormerOutline& gap : report->gaps) {
    for (auto& corners : gap.rings) {
      for (Eigen::Vector3d& corner : corners) corner = *move * corner;
    }
  }
  for (double& area : report->areas) area *= move->scale * move->scale;
}

}  // namespace colmap_seapoint
