// colmap_seapoint::feature from outside: SeaPoints of one picture, drawn into it.
//   show_seapoints PICTURE DRAWN.png
#include <exception>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "feature/extract_features.h"

namespace {

namespace cs = colmap_seapoint;

cs::GrayImage GrayOf(const cv::Mat& color) {
  cv::Mat gray;
  cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
  cs::GrayImage image(gray.cols, gray.rows);
  for (int y = 0; y < gray.rows; ++y) {
    std::copy(gray.ptr(y), gray.ptr(y) + gray.cols, image.Row(y));
  }
  return image;
}

int Run(const std::string& input, const std::string& output) {
  cv::Mat picture = cv::imread(input, cv::IMREAD_COLOR);
  if (picture.empty()) {
    std::cerr << input << ": cannot be read\n";
    return 1;
  }
  const cs::SeaPointExtractionOptions options;
  const auto extracted = cs::ExtractFeatures(GrayOf(picture), cs::GrayImage(), options);
  for (const cs::SeaPoint& point : extracted.features.points) {
    // OpenCV counts from the centre of the first pixel, COLMAP (and we) from its corner.
    cv::circle(picture, cv::Point2f(point.x - 0.5f, point.y - 0.5f), 3, cv::Scalar(0, 255, 255));
  }
  std::cout << extracted.features.points.size() << " SeaPoints, each with "
            << 8 * sizeof(cs::Descriptor) << " bits of rBRIEF\n";
  return cv::imwrite(output, picture) ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: show_seapoints PICTURE DRAWN.png\n";
    return 2;
  }
  try {
    return Run(argv[1], argv[2]);
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
