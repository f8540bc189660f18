// colmap_seapoint::densify from outside: a COLMAP model and its pictures, from wherever -> a cloud.
//   densify_model IMAGE_FOLDER MODEL_FOLDER CLOUD.ply
#include <array>
#include <exception>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
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
  cs::Features FindSeaPoints(const cs::Picture& picture) override {
    return cs::ExtractFeatures(picture.luma, picture.mask, extraction_).features;
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

int Run(const std::string& images, const std::string& folder, const std::string& output) {
  const cs::SparseModel model = cs::ReadSparseModel(folder, cs::ModelContent::kPosesAndPoints);
  PictureFolder pictures(images, model);
  cs::CloudWriter cloud(output);
  cs::SequenceCallbacks callbacks;
  callbacks.sink = [&](const cs::PartialCloud& part) {
    const std::array<uint32_t, 2> seen_by = {static_cast<uint32_t>(part.image_idx1),
                                             static_cast<uint32_t>(part.image_idx2)};
    for (const cs::DensePoint& point : part.points) {
      cloud.Add({point.xyz, point.normal, point.rgb, point.confidence}, seen_by.data(), 2);
    }
  };
  const int num_threads = 2;
  cs::DensifySequence(model, &pictures, cs::PartialDensificationOptions(), num_threads, callbacks);
  cloud.Finish();
  std::cout << cloud.NumPoints() << " points of " << model.images.size() << " pictures\n";
  return cloud.NumPoints() == 0 ? 1 : 0;
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
