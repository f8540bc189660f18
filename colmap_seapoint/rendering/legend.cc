#include "colmap_seapoint/rendering/legend.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "colmap_seapoint/compare/plan_view.h"

namespace colmap_seapoint {
namespace {

constexpr int kMargin = 12;  // pixels
constexpr int kBarHeight = 6;
constexpr int kStripHeight = 36;
constexpr int kMinWidth = 120;
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontScale = 0.55;
const cv::Scalar kWhite(255, 255, 255), kBlack(0, 0, 0);

cv::Mat View(ColorImage* picture) {
  return cv::Mat(picture->height, picture->width, CV_8UC3, picture->data.data());
}

void DrawText(const std::string& text, const cv::Point& corner, cv::Mat* picture) {
  cv::putText(*picture, text, corner, kFont, kFontScale, kBlack, 4, cv::LINE_AA);
  cv::putText(*picture, text, corner, kFont, kFontScale, kWhite, 1, cv::LINE_AA);
}

}  // namespace

double RoundLength(double most) {
  if (!(most > 0) || !std::isfinite(most)) return 0;
  const double power = std::pow(10, std::floor(std::log10(most)));
  for (const double step : {5.0, 2.0, 1.0}) {
    if (step * power <= most * (1 + 1e-9)) return step * power;
  }
  return power / 2;  // log10 was rounded up
}

std::string LengthText(double length, const std::string& unit) {
  char number[32];
  std::snprintf(number, sizeof(number), length < 1000 ? "%.3g" : "%.0f", length);
  return number + (" " + unit);
}

void DrawScaleBar(double pixels_a_unit, const std::string& unit, ColorImage* picture) {
  if (picture->width < kMinWidth || picture->height < 5 * kMargin) return;
  const double length = RoundLength(picture->width / (5 * pixels_a_unit));
  if (!(length > 0) || !(pixels_a_unit > 0)) return;
  cv::Mat view = View(picture);
  const int bottom = picture->height - kMargin;
  const int right = kMargin + static_cast<int>(std::lround(length * pixels_a_unit));
  const cv::Point low(kMargin, bottom - kBarHeight), high(right, bottom);
  cv::rectangle(view, low - cv::Point(2, 2), high + cv::Point(2, 2), kBlack, cv::FILLED);
  cv::rectangle(view, low, high, kWhite, cv::FILLED);
  DrawText(LengthText(length, unit), low - cv::Point(0, kMargin / 2), &view);
}

ColorImage RampLegend(int width, double low, double high, const std::string& unit) {
  ColorImage strip(width, kStripHeight, 3);
  for (int x = 0; x < width; ++x) {
    const auto color = RampColor(width > 1 ? static_cast<double>(x) / (width - 1) : 0);
    for (int y = 0; y < kStripHeight; ++y) {
      for (int c = 0; c < 3; ++c) strip.At(x, y, c) = color[static_cast<size_t>(c)];
    }
  }
  if (width < 2 * kMinWidth) return strip;
  cv::Mat view = View(&strip);
  const int line = kStripHeight - kMargin;
  const std::string high_text = LengthText(high, unit);
  const int high_width = cv::getTextSize(high_text, kFont, kFontScale, 1, nullptr).width;
  DrawText(LengthText(low, unit), {kMargin, line}, &view);
  DrawText(high_text, {std::max(kMargin, width - kMargin - high_width), line}, &view);
  return strip;
}

}  // namespace colmap_seapoint
