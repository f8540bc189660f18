#include "tests/fuzz/model_fuzz.h"

using namespace colmap_seapoint;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  ReadAnyModel(WriteFuzzFiles(
                   "model", {"cameras.txt", "images.txt", "points3D.txt", "rigs.txt", "frames.txt"},
                   data, size),
               WriteSparseModelText);
  return 0;
}
