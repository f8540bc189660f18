#include "colmap_seapoint/report/marker_sheet.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "colmap_seapoint/markers/marker_codes.h"

namespace colmap_seapoint {
namespace {

// Of what is black on a page.
double Left(const PdfPage& page) {
  double left = 1e9;
  for (const PdfRectangle& r : page.rectangles) left = std::min(left, r.x);
  return left;
}
double Right(const PdfPage& page) {
  double right = 0;
  for (const PdfRectangle& r : page.rectangles) right = std::max(right, r.x + r.width);
  return right;
}

// The lines across a bar, where its sheets are cut and joined.
std::vector<double> Joints(const PdfPage& page) {
  std::vector<double> joints;
  for (const PdfLine& line : page.lines) {
    if (line.x1 == line.x2 && line.y2 - line.y1 > 50) joints.push_back(line.x1);
  }
  return joints;
}

TEST(MarkerSheetTest, BarsAreAsLongAsTheySay) {
  for (const double length : {150.0, 300.0, 500.0, 1000.0, 2000.0, 3333.0}) {
    const MarkerSheetOptions options = {{MarkerFamily::kTag36h11, 4}, 2, 80, length};
    ASSERT_EQ(CheckMarkerSheet(options), "");
    const std::vector<PdfPage> pages = MarkerSheet(options);
    double start = 0;  // of the page on the strip
    double first_left = 0, last_right = 0;
    for (size_t k = 0; k < pages.size(); ++k) {
      const std::vector<double> joints = Joints(pages[k]);
      ASSERT_EQ(joints.size(), 2u);
      if (k == 0) first_left = Left(pages[k]) - joints[0];
      if (k + 1 == pages.size()) last_right = start + Right(pages[k]) - joints[0];
      start += joints[1] - joints[0];
      EXPECT_LE(joints[1], kA4Long - 10);
      EXPECT_TRUE(pages[k].is_landscape);
    }
    EXPECT_NEAR(last_right - first_left, length + 80, 1e-9) << length;
  }
}

TEST(MarkerSheetTest, SingleMarkersStayOnThePaper) {
  for (const double size : {10.0, 37.0, 100.0, 145.0}) {
    const MarkerSheetOptions options = {{MarkerFamily::kAruco4x4, 0}, 30, size, 0};
    if (!CheckMarkerSheet(options).empty()) continue;
    int num_captions = 0;
    for (const PdfPage& page : MarkerSheet(options)) {
      EXPECT_GE(Left(page), 10);
      EXPECT_LE(Right(page), kA4Short - 10);
      for (const PdfRectangle& r : page.rectangles) EXPECT_LE(r.y + r.height, kA4Long - 20);
      for (const PdfText& text : page.texts) num_captions += text.text.rfind("DICT_4X4:", 0) == 0;
    }
    EXPECT_EQ(num_captions, 30);
  }
}

}  // namespace
}  // namespace colmap_seapoint
