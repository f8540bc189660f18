// A PNG written row by row: pictures that are too large for memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

namespace colmap_seapoint {

enum class PngColors { kGray, kGrayAlpha, kRgb, kRgba };

class PngRows {
 public:
  // 8 bits a channel. Throws Error when the file cannot be created, or a side is beyond what a PNG
  // may have.
  PngRows(const std::filesystem::path& path, int width, int height, PngColors colors);
  ~PngRows();  // without Finish(), nothing is left
  PngRows(const PngRows&) = delete;
  PngRows& operator=(const PngRows&) = delete;

  // The next row, from the top; channels interleaved. Throws Error, e.g. on a full disk.
  void Write(const uint8_t* row);
  // To be called after the last row.
  void Finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace colmap_seapoint
