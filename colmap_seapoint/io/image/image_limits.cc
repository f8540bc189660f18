#include "colmap_seapoint/io/image/image_limits.h"

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/system/memory_budget.h"
#include "colmap_seapoint/system/memory_limit.h"

namespace colmap_seapoint {
namespace {

// Into how many bytes one byte of a file can unfold, for a picture of one colour: an all black
// photograph and an all white mask are legal, what is beyond them is not.
uint64_t MaxUnpacked(Packing packing) {
  switch (packing) {
    case Packing::kNone:
      return 1;
    case Packing::kPackBits:
      return 64;  // 128 bytes from 2
    case Packing::kJpeg:
      return 512;  // every block of 64 samples has a bit for its mean
    case Packing::kLzw:
      return 1400;  // codes of 12 bits for up to 4000 bytes that grow one by one
    case Packing::kWebp:
      return 4096;  // in theory more, but not with anything to be seen in the picture
    case Packing::kDeflate:
      return 1040;  // 1032 and a margin
  }
  return 1;
}

[[noreturn]] void ThrowTooLarge(const ImageSource& source, const std::string& finding,
                                const std::string& remedy) {
  throw Error(source.path.string(), finding, remedy + ", or take it out of the folder");
}

}  // namespace

uint64_t BytesToDecode(const ImageSource& source, const ImageHeader& header) {
  const auto num_pixels =
      static_cast<uint64_t>(header.size.width) * static_cast<uint64_t>(header.size.height);
  if (header.unpacked_bytes / MaxUnpacked(header.packing) > source.size) {
    ThrowDamagedImage(source.path, "the file ends too early: " + std::to_string(num_pixels) +
                                       " pixels do not fit into " + std::to_string(source.size) +
                                       " bytes");
  }
  const uint64_t bytes = num_pixels * header.bytes_per_pixel + header.more_bytes;
  if (bytes > MaxMemory()) {
    ThrowTooLarge(
        source,
        "takes " + BytesText(bytes) + " to decode, --max_memory is " + BytesText(MaxMemory()),
        "raise --max_memory, make the picture smaller");
  }
  return bytes;
}

}  // namespace colmap_seapoint
