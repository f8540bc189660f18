// Any file as a table of positions, of scale bars, of targets, and as a list of pictures.
#include "colmap_seapoint/io/files/positions_csv.h"
#include "colmap_seapoint/io/files/scale_csv.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/fuzz/fuzz_files.h"

using namespace colmap_seapoint;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::filesystem::path path = WriteFuzzFile("table.csv", data, size);
  Accepts([&] {
    for (const auto& [name, position] : ReadPositionsCsv(path).positions) {
      FUZZ_REQUIRE(!name.empty() && position.allFinite());
    }
  });
  Accepts([&] {
    for (const ScaleBar& bar : ReadScaleBarsCsv(path)) FUZZ_REQUIRE(bar.metres > 0);
  });
  Accepts([&] {
    for (const TargetMark& mark : ReadTargetsCsv(path)) FUZZ_REQUIRE(mark.pixel.allFinite());
  });
  Accepts([&] {
    for (const std::string& name : ReadImageList(path)) FUZZ_REQUIRE(IsSafeImageName(name));
  });
  return 0;
}
