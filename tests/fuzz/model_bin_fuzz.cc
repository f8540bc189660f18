#include "tests/fuzz/model_fuzz.h"

using namespace colmap_seapoint;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  ReadAnyModel(WriteFuzzFiles(
                   "model", {"cameras.bin", "images.bin", "points3D.bin", "rigs.bin", "frames.bin"},
                   data, size),
               WriteSparseModelBinary);
  return 0;
}
