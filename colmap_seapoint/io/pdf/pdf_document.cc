#include "colmap_seapoint/io/pdf/pdf_document.h"

#include <hpdf.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <type_traits>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_file.h"

namespace colmap_seapoint {
namespace {

constexpr double kPointsPerMillimetre = 72 / 25.4;
constexpr double kLineWidth = 0.2;  // millimetres

using Document = std::unique_ptr<std::remove_pointer_t<HPDF_Doc>, void (*)(HPDF_Doc)>;

// The library's own handler is C: nothing may be thrown through it, so that every call is checked
// once at the end, by the document's own error.
void Ignore(HPDF_STATUS, HPDF_STATUS, void*) {}

HPDF_REAL Points(double millimetres) {
  return static_cast<HPDF_REAL>(kPointsPerMillimetre * millimetres);
}

std::string Printable(std::string text) {
  for (char& c : text) {
    if (c < ' ' || c > '~') c = '?';
  }
  return text;
}

void Draw(const PdfPage& page, HPDF_Font font, HPDF_Doc document) {
  const HPDF_Page sheet = HPDF_AddPage(document);
  const double width = page.is_landscape ? kA4Long : kA4Short,
               height = page.is_landscape ? kA4Short : kA4Long;
  HPDF_Page_SetWidth(sheet, Points(width));
  HPDF_Page_SetHeight(sheet, Points(height));
  for (const PdfRectangle& r : page.rectangles) {
    HPDF_Page_Rectangle(sheet, Points(r.x), Points(height - r.y - r.height), Points(r.width),
                        Points(r.height));
  }
  if (!page.rectangles.empty()) HPDF_Page_Fill(sheet);
  HPDF_Page_SetLineWidth(sheet, Points(kLineWidth));
  for (const PdfLine& l : page.lines) {
    HPDF_Page_MoveTo(sheet, Points(l.x1), Points(height - l.y1));
    HPDF_Page_LineTo(sheet, Points(l.x2), Points(height - l.y2));
  }
  if (!page.lines.empty()) HPDF_Page_Stroke(sheet);
  HPDF_Page_BeginText(sheet);
  for (const PdfText& t : page.texts) {
    HPDF_Page_SetFontAndSize(sheet, font, Points(t.height));
    HPDF_Page_TextOut(sheet, Points(t.x), Points(height - t.y), Printable(t.text).c_str());
  }
  HPDF_Page_EndText(sheet);
}

// The document's bytes.
std::string Save(HPDF_Doc document) {
  SEAPOINT_CHECK(HPDF_SaveToStream(document) == HPDF_OK);
  std::string bytes;
  for (;;) {
    HPDF_BYTE buffer[4096];
    HPDF_UINT32 size = sizeof(buffer);
    const HPDF_STATUS status = HPDF_ReadFromStream(document, buffer, &size);
    bytes.append(reinterpret_cast<const char*>(buffer), size);
    if (status != HPDF_OK || size == 0) break;
  }
  return bytes;
}

}  // namespace

void WritePdf(const std::filesystem::path& path, const std::vector<PdfPage>& pages) {
  const Document document(HPDF_New(Ignore, nullptr), HPDF_Free);
  if (!document) throw std::bad_alloc();
  HPDF_SetCompressionMode(document.get(), HPDF_COMP_TEXT);
  HPDF_SetInfoAttr(document.get(), HPDF_INFO_CREATOR, kPdfCreator);
  const HPDF_Font font = HPDF_GetFont(document.get(), "Helvetica", nullptr);
  for (const PdfPage& page : pages) Draw(page, font, document.get());
  SEAPOINT_CHECK(HPDF_GetError(document.get()) == HPDF_OK);
  WriteTextFile(path, Save(document.get()));
}

}  // namespace colmap_seapoint
