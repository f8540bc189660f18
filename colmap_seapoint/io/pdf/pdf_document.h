// A document of A4 pages with rectangles, lines and text: what a printer needs for a marker.
// Written with libharu.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace colmap_seapoint {

// Millimetres from the upper left corner of the page, y down.
struct PdfRectangle {
  double x = 0, y = 0, width = 0, height = 0;  // filled with black
};
struct PdfLine {
  double x1 = 0, y1 = 0, x2 = 0, y2 = 0;  // black, 0.2 mm thick
};
struct PdfText {
  double x = 0, y = 0;  // left end of its base line
  double height = 4;    // of the letters, about
  std::string text;     // printable ASCII; other letters become '?'
};

inline constexpr double kA4Short = 210, kA4Long = 297;  // millimetres

struct PdfPage {
  bool is_landscape = false;
  std::vector<PdfRectangle> rectangles;
  std::vector<PdfLine> lines;
  std::vector<PdfText> texts;
};

// What the file begins with tells that it is ours (CheckReplaceable).
inline constexpr char kPdfCreator[] = "colmap_seapoint marker_sheet";

// Atomic; the same bytes for the same pages. Throws Error when the file cannot be written.
void WritePdf(const std::filesystem::path& path, const std::vector<PdfPage>& pages);

}  // namespace colmap_seapoint
