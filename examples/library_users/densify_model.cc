// colmap_seapoint::densify from outside: a COLMAP model in text form and its pictures -> a cloud.
//   densify_model IMAGE_FOLDER MODEL_FOLDER CLOUD.ply
// (colmap model_converter --output_type TXT makes a text model of any other.)
#include <exception>
#include <fstream>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <stdexcept>

#include "densify/densify_sequence.h"
#include "feature/extract_features.h"
#include "feature/match_features.h"

namespace {

namespace cs = colmap_seapoint;

// Pictures from a folder; SeaPoints and matches are worked out, as none are stored.
class PictureFolder : public cs::PictureSource {
 public:
  PictureFolder(std::string folder, const cs::SparseModel& model)
      : folder_(std::move(folder)), model_(model) {}

  cs::Picture ReadPicture(int image_idx) override {
    const std::string path = folder_ + "/" + model_.images.at(image_idx).name;
    const cv::Mat bgr = cv::imread(path, cv::IMREAD_COLOR);
    if (bgr.empty()) throw std::runtime_error(path + ": cannot be read");
    cs::ColorImage rgb(bgr.cols, bgr.rows, 3);
    for (int y = 0; y < bgr.rows; ++y) {
      for (int x = 0; x < bgr.cols; ++x) {
        for (int c = 0; c < 3; ++c) rgb.At(x, y, c) = bgr.at<cv::Vec3b>(y, x)[2 - c];
      }
    }
    return cs::PictureOf(rgb);
  }
  std::optional<cs::Features> ReadSeaPoints(int) override { return std::nullopt; }
  cs::Features FindSeaPoints(const cs::GrayImage& picture) override {
    return cs::ExtractFeatures(picture, cs::GrayImage(), extraction_).features;
  }
  std::optional<cs::FeatureMatches> ReadMatches(int, int) override { return std::nullopt; }
  cs::FeatureMatches Match(const cs::Features& a, const cs::Features& b) override {
    return cs::MatchSeaPoints(a, b, matching_);
  }

 private:
  std::string folder_;
  const cs::SparseModel& model_;
  cs::SeaPointExtractionOptions extraction_;
  cs::SeaPointMatchingOptions matching_;
};

// Every line of `path` that is no comment.
std::vector<std::string> Lines(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] != '#') lines.push_back(line);
  }
  return lines;
}

cs::SparseModel ReadTextModel(const std::string& folder) {
  cs::SparseModel model;
  for (const std::string& line : Lines(folder + "/cameras.txt")) {
    std::istringstream words(line);
    cs::Camera camera;
    std::string name;
    words >> camera.camera_id >> name >> camera.width >> camera.height;
    const cs::CameraModelInfo* info = cs::FindCameraModel(name);
    if (info == nullptr) throw std::runtime_error("unknown camera model " + name);
    camera.model = info->model;
    for (double param; words >> param;) camera.params.push_back(param);
    model.cameras[camera.camera_id] = camera;
  }
  const std::vector<std::string> images = Lines(folder + "/images.txt");
  for (size_t i = 0; i < images.size(); i += 2) {
    std::istringstream words(images[i]);
    cs::PosedImage image;
    Eigen::Quaterniond& q = image.cam_from_world.rotation;
    Eigen::Vector3d& t = image.cam_from_world.translation;
    words >> image.image_id >> q.w() >> q.x() >> q.y() >> q.z() >> t.x() >> t.y() >> t.z() >>
        image.camera_id >> std::ws;
    std::getline(words, image.name);
    std::istringstream points(i + 1 < images.size() ? images[i + 1] : "");
    Eigen::Vector2d point;
    for (long long id; points >> point.x() >> point.y() >> id;) {
      image.points2D.push_back(point);
      image.point3D_ids.push_back(id < 0 ? cs::kNoPoint3D : static_cast<uint64_t>(id));
    }
    model.images.push_back(image);
  }
  for (const std::string& line : Lines(folder + "/points3D.txt")) {
    std::istringstream words(line);
    uint64_t id = 0;
    cs::SparsePoint point;
    int red = 0, green = 0, blue = 0;
    words >> id >> point.xyz.x() >> point.xyz.y() >> point.xyz.z() >> red >> green >> blue >>
        point.error;
    for (cs::SparsePoint::TrackElement e; words >> e.image_id >> e.point2D_idx;) {
      point.track.push_back(e);
    }
    model.points3D[id] = point;
  }
  return model;
}

void WritePly(const std::string& path, const std::vector<cs::DensePoint>& points) {
  std::ofstream file(path);
  file << "ply\nformat ascii 1.0\nelement vertex " << points.size()
       << "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
          "property uchar green\nproperty uchar blue\nend_header\n";
  for (const cs::DensePoint& point : points) {
    file << point.xyz.transpose() << " " << int{point.rgb[0]} << " " << int{point.rgb[1]} << " "
         << int{point.rgb[2]} << "\n";
  }
  if (!file.flush()) throw std::runtime_error(path + ": cannot be written");
}

int Run(const std::string& images, const std::string& folder, const std::string& output) {
  const cs::SparseModel model = ReadTextModel(folder);
  PictureFolder pictures(images, model);
  std::vector<cs::DensePoint> points;
  cs::SequenceCallbacks callbacks;
  callbacks.sink = [&](const cs::PartialCloud& part) {
    points.insert(points.end(), part.points.begin(), part.points.end());
  };
  const int num_threads = 2;
  cs::DensifySequence(model, &pictures, cs::PartialDensificationOptions(), num_threads, callbacks);
  WritePly(output, points);
  std::cout << points.size() << " points of " << model.images.size() << " pictures\n";
  return points.empty() ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "usage: densify_model IMAGE_FOLDER MODEL_FOLDER CLOUD.ply\n";
    return 2;
  }
  try {
    return Run(argv[1], argv[2], argv[3]);
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
