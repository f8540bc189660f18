#include "colmap_seapoint/io/image/png_rows.h"

#include <png.h>

#include <csetjmp>
#include <exception>
#include <string>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_file.h"

namespace colmap_seapoint {
namespace {

// Below libpng's own 6: of a large picture, packing is most of the time.
constexpr int kCompressionLevel = 1;

int PngType(PngColors colors) {
  switch (colors) {
    case PngColors::kGray:
      return PNG_COLOR_TYPE_GRAY;
    case PngColors::kGrayAlpha:
      return PNG_COLOR_TYPE_GRAY_ALPHA;
    case PngColors::kRgb:
      return PNG_COLOR_TYPE_RGB;
    case PngColors::kRgba:
      return PNG_COLOR_TYPE_RGB_ALPHA;
  }
  SEAPOINT_CHECK(false);
  return 0;
}

}  // namespace

// libpng jumps out of its functions, past no destructor: every step below has none. What the file
// throws is kept until libpng is left.
struct PngRows::Impl {
  explicit Impl(const std::filesystem::path& path_in) : path(path_in), file(path_in) {
    png = png_create_write_struct(PNG_LIBPNG_VER_STRING, this, OnError, OnWarning);
    if (png != nullptr) info = png_create_info_struct(png);
    if (info == nullptr) throw std::bad_alloc();
    png_set_write_fn(png, this, OnWrite, OnFlush);
    png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_set_compression_level(png, kCompressionLevel);
  }
  ~Impl() { png_destroy_write_struct(&png, &info); }

  static void OnError(png_structp png, png_const_charp message) {
    auto* self = static_cast<Impl*>(png_get_error_ptr(png));
    try {
      self->message = message;
    } catch (...) {
      self->thrown = std::current_exception();
    }
    longjmp(self->jump, 1);
  }
  static void OnWarning(png_structp, png_const_charp) {}
  static void OnWrite(png_structp png, png_bytep data, size_t size) {
    auto* self = static_cast<Impl*>(png_get_io_ptr(png));
    try {
      self->file.Write(data, size);
    } catch (...) {
      self->thrown = std::current_exception();
    }
    if (self->thrown) png_error(png, "");
  }
  static void OnFlush(png_structp) {}

  bool Begin(int width, int height, PngColors colors) {
    if (setjmp(jump) != 0) return false;
    png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 8,
                 PngType(colors), PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    return true;
  }
  bool WriteRow(const uint8_t* row) {
    if (setjmp(jump) != 0) return false;
    png_write_row(png, row);
    return true;
  }
  bool End() {
    if (setjmp(jump) != 0) return false;
    png_write_end(png, nullptr);
    return true;
  }
  void Check(bool succeeded) const {
    if (succeeded) return;
    if (thrown) std::rethrow_exception(thrown);
    throw Error(path.string(), "cannot be made a PNG of (" + message + ")",
                "make the picture smaller");
  }

  std::filesystem::path path;
  AtomicFile file;
  jmp_buf jump;
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::string message;
  std::exception_ptr thrown;
};

PngRows::PngRows(const std::filesystem::path& path, int width, int height, PngColors colors)
    : impl_(std::make_unique<Impl>(path)) {
  impl_->Check(impl_->Begin(width, height, colors));
}

PngRows::~PngRows() = default;

void PngRows::Write(const uint8_t* row) { impl_->Check(impl_->WriteRow(row)); }

void PngRows::Finish() {
  impl_->Check(impl_->End());
  impl_->file.Commit();
}

}  // namespace colmap_seapoint
