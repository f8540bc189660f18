#include "colmap_seapoint/base/natural_order.h"

#include <cstddef>

namespace colmap_seapoint {
namespace {

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

// The end of the run of digits that starts at `begin`.
size_t EndOfDigits(const std::string& text, size_t begin) {
  while (begin < text.size() && IsDigit(text[begin])) ++begin;
  return begin;
}

// Compares the numbers text1[begin1, end1) and text2[begin2, end2), of any length: < 0, 0, > 0.
int CompareNumbers(const std::string& text1, size_t begin1, size_t end1, const std::string& text2,
                   size_t begin2, size_t end2) {
  while (begin1 < end1 && text1[begin1] == '0') ++begin1;
  while (begin2 < end2 && text2[begin2] == '0') ++begin2;
  const size_t length1 = end1 - begin1, length2 = end2 - begin2;
  if (length1 != length2) return length1 < length2 ? -1 : 1;
  return text1.compare(begin1, length1, text2, begin2, length2);
}

}  // namespace

bool NaturalLess(const std::string& a, const std::string& b) {
  size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (IsDigit(a[i]) && IsDigit(b[j])) {
      const size_t end_i = EndOfDigits(a, i), end_j = EndOfDigits(b, j);
      const int order = CompareNumbers(a, i, end_i, b, j, end_j);
      if (order != 0) return order < 0;
      i = end_i;
      j = end_j;
    } else {
      if (a[i] != b[j]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
      ++i;
      ++j;
    }
  }
  if (i < a.size() || j < b.size()) return i == a.size();
  return a < b;
}

}  // namespace colmap_seapoint
