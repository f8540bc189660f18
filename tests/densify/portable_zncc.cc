#include "tests/densify/portable_zncc.h"

#include "colmap_seapoint/base/vector_clones.h"

#undef SEAPOINT_VECTOR_CLONES
#define SEAPOINT_VECTOR_CLONES
#define ZnccReference ClonelessZnccReference
#include "densify/zncc.cc"  // NOLINT(bugprone-suspicious-include)

namespace colmap_seapoint {

float PortableZncc(const GrayImage& picture1, int x1, int y1, const GrayImage& picture2, int x2,
                   int y2, int size) {
  return ClonelessZnccReference(picture1, x1, y1, size).Score(picture2, x2, y2);
}

}  // namespace colmap_seapoint
