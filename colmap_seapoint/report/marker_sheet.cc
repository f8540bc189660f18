#include "colmap_seapoint/report/marker_sheet.h"

#include <algorithm>
#include <cmath>

#include "colmap_seapoint/markers/marker_codes.h"
#include "colmap_seapoint/report/format_text.h"

namespace colmap_seapoint {
namespace {

constexpr double kMargin = 10;   // that printers leave white, millimetres
constexpr double kCaption = 16;  // height of the room for names and the ruler
constexpr double kGlue = 10;     // of a page of a bar that goes below the next one
constexpr double kPageOfBar = kA4Long - 2 * kMargin - kGlue;
constexpr double kMaxRuler = 150;

// A cell's white margin on each side: a fifth more than the cell, so that scissors may slip.
double QuietZone(const MarkerSheetOptions& options) {
  return 1.2 * options.size_mm / NumCells(options.first.family);
}

double BoardSide(const MarkerSheetOptions& options) {
  return options.size_mm + 2 * QuietZone(options);
}

MarkerName NameOf(const MarkerSheetOptions& options, int k) {
  return {options.first.family, options.first.id + k};
}

// `x`, `y`: upper left corner of the black square. Black cells side by side are one rectangle, so
// that no white hair lies between them.
void DrawMarker(const MarkerName& name, double x, double y, double size, PdfPage* page) {
  const int cells = NumCells(name.family);
  const double cell = size / cells;
  for (int row = 0; row < cells; ++row) {
    for (int first = 0; first < cells;) {
      int end = first;
      while (end < cells && !IsWhiteCell(name, end, row)) ++end;
      if (end > first) {
        page->rectangles.push_back({x + first * cell, y + row * cell, (end - first) * cell, cell});
      }
      first = end + 1;
    }
  }
}

void DrawRuler(double x, double y, double length, PdfPage* page) {
  page->lines.push_back({x, y, x + length, y});
  for (int mm = 0; mm <= static_cast<int>(length); mm += 5) {
    const double tick = mm % 50 == 0 ? 4 : mm % 10 == 0 ? 2.5 : 1.2;
    page->lines.push_back({x + mm, y, x + mm, y - tick});
  }
  page->texts.push_back(
      {x, y + 4, 3,
       Format("this line must be %.0f mm long: print at 100 %%, not 'fit to page'", length)});
}

double RulerLength(double room) { return 10 * std::floor(std::min(room, kMaxRuler) / 10); }

// The marker's number and size below its square.
void DrawCaption(const MarkerName& name, double x, double y, double size, PdfPage* page) {
  page->texts.push_back({x, y, std::clamp(size / 20, 2.5, 5.0),
                         MarkerText(name) + Format("  black square %.1f mm, this way up", size)});
}

std::vector<PdfPage> SingleMarkers(const MarkerSheetOptions& options) {
  const double quiet = QuietZone(options), width = BoardSide(options), height = width + 8;
  const int columns = std::max(1, static_cast<int>((kA4Short - 2 * kMargin) / width));
  const int rows = std::max(1, static_cast<int>((kA4Long - 2 * kMargin - kCaption) / height));
  std::vector<PdfPage> pages;
  for (int k = 0; k < options.count; ++k) {
    const int place = k % (columns * rows);
    if (place == 0) {
      pages.emplace_back();
      DrawRuler(kMargin + 5, kA4Long - kMargin - 6, RulerLength(kA4Short - 2 * kMargin - 10),
                &pages.back());
    }
    const int column = place % columns, row = place / columns;
    const double x = kMargin + column * width + quiet;
    const double y = kMargin + row * height + quiet;
    DrawMarker(NameOf(options, k), x, y, options.size_mm, &pages.back());
    DrawCaption(NameOf(options, k), x, y + options.size_mm + quiet + 4, options.size_mm,
                &pages.back());
  }
  return pages;
}

// A bar's whole strip, and the length of it that each page holds.
double StripLength(const MarkerSheetOptions& options) {
  return options.bar_length_mm + BoardSide(options);
}
int PagesOfBar(const MarkerSheetOptions& options) {
  return static_cast<int>(std::ceil(StripLength(options) / kPageOfBar));
}

// Page `part` of the bar whose first marker is `first`.
PdfPage BarPage(const MarkerSheetOptions& options, int first, int part) {
  PdfPage page;
  page.is_landscape = true;
  const int count = PagesOfBar(options);
  const double length = StripLength(options) / count, left = kMargin, top = 30;
  const double right = left + length, bottom = top + BoardSide(options);
  const double quiet = QuietZone(options);
  page.lines.push_back({left, top, right, top});
  page.lines.push_back({left, bottom, right, bottom});
  page.lines.push_back({left, top - 6, left, bottom + 6});
  page.lines.push_back({right, top - 6, right, bottom + 6});
  if (part == 0)
    DrawMarker(NameOf(options, first), left + quiet, top + quiet, options.size_mm, &page);
  if (part == count - 1) {
    DrawMarker(NameOf(options, first + 1), right - quiet - options.size_mm, top + quiet,
               options.size_mm, &page);
  }
  const std::string bar =
      MarkerText(NameOf(options, first)) + " - " + MarkerText(NameOf(options, first + 1));
  page.texts.push_back({left, 14, 5, bar + Format(", sheet %d of %d", part + 1, count)});
  page.texts.push_back({left, 21, 3,
                        "cut at the right line of one sheet, lay it on the left line of the next, "
                        "glue; then measure "
                        "from centre to centre"});
  page.texts.push_back({left, bottom + 12, 3,
                        Format("black squares %.1f mm, %.1f mm from centre to centre",
                               options.size_mm, options.bar_length_mm)});
  DrawRuler(left, kA4Short - kMargin - 6, RulerLength(length), &page);
  return page;
}

}  // namespace

std::string CheckMarkerSheet(const MarkerSheetOptions& options) {
  const int num_markers = NumMarkers(options.first.family);
  if (options.first.id + options.count > num_markers) {
    return FamilyText(options.first.family) + " has " + std::to_string(num_markers) +
           " markers: first_id and num_markers must lead no farther";
  }
  const double board = BoardSide(options);
  if (board > kA4Short - 2 * kMargin) {
    return Format("size must be %.3f or less: A4 holds no larger marker with its white margin",
                  (kA4Short - 2 * kMargin) / board * options.size_mm / 1000);
  }
  if (options.bar_length_mm <= 0) return "";
  if (options.count % 2 != 0) return "num_markers must be even: a bar has two";
  if (options.bar_length_mm < board) {
    return Format("bar_length must be %.3f or more: its markers would lie one on the other",
                  board / 1000);
  }
  constexpr double kMaxBoardOfBar = kA4Short - 2 * kMargin - 60;
  if (board <= kMaxBoardOfBar) return "";
  return Format("size must be %.3f or less: A4 holds no larger marker of a bar",
                kMaxBoardOfBar / board * options.size_mm / 1000);
}

std::vector<PdfPage> MarkerSheet(const MarkerSheetOptions& options) {
  if (options.bar_length_mm <= 0) return SingleMarkers(options);
  std::vector<PdfPage> pages;
  for (int first = 0; first + 1 < options.count; first += 2) {
    for (int part = 0; part < PagesOfBar(options); ++part) {
      pages.push_back(BarPage(options, first, part));
    }
  }
  return pages;
}

}  // namespace colmap_seapoint
