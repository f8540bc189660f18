// Any file as a picture of any format: its header, and its pixels in every form that is asked for.
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/system/memory_budget.h"
#include "tests/fuzz/fuzz_files.h"

using namespace colmap_seapoint;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  SetMaxMemory(64u << 20);  // what is larger is refused, and the fuzzer goes on
  const std::filesystem::path path = WriteFuzzFile("picture", data, size);
  Accepts([&] {
    const ImageInfo info = ReadImageInfo(path);
    FUZZ_REQUIRE(info.width > 0 && info.height > 0);
  });
  GrayImage gray;
  Picture picture;
  const bool has_gray = Accepts([&] { gray = ReadGrayImage(path); });
  const bool has_picture = Accepts([&] { picture = ReadPicture(path); });
  FUZZ_REQUIRE(has_gray == has_picture);
  FUZZ_REQUIRE(!has_gray || gray.data == picture.luma.data);
  Accepts([&] {
    const ColorImage color = ReadColorImage(path);
    FUZZ_REQUIRE(color.width > 0 && color.height > 0);
  });
  return 0;
}
