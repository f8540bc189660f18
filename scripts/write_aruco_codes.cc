// Run by the build, once: the bits of ArUco's predefined dictionaries, as OpenCV has them, as a
// header of numbers. So the program itself needs no part of opencv_contrib.
//   write_aruco_codes OUTPUT.h
#include <cstdint>
#include <fstream>
#include <iostream>
#include <opencv2/aruco.hpp>

namespace {

// Row by row from the upper left bit, which is the highest; white is 1.
uint64_t CodeOf(const cv::aruco::Dictionary& dictionary, int id) {
  const cv::Mat bits = cv::aruco::Dictionary::getBitsFromByteList(
      dictionary.bytesList.rowRange(id, id + 1), dictionary.markerSize);
  uint64_t code = 0;
  for (int row = 0; row < bits.rows; ++row) {
    for (int column = 0; column < bits.cols; ++column) {
      code = code << 1 | bits.at<uint8_t>(row, column);
    }
  }
  return code;
}

void Write(const char* name, int dictionary_id, std::ostream* out) {
  const auto dictionary = cv::aruco::getPredefinedDictionary(dictionary_id);
  *out << "inline constexpr uint64_t " << name << "[] = {";
  for (int id = 0; id < dictionary->bytesList.rows; ++id) {
    *out << (id % 8 == 0 ? "\n    " : " ") << CodeOf(*dictionary, id) << "u,";
  }
  *out << "};\n";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  std::ofstream out(argv[1]);
  out << "// Made by scripts/write_aruco_codes.cc from OpenCV's dictionaries.\n"
         "#pragma once\n\n#include <cstdint>\n\nnamespace colmap_seapoint {\n\n";
  Write("kAruco4x4Codes", cv::aruco::DICT_4X4_1000, &out);
  Write("kAruco5x5Codes", cv::aruco::DICT_5X5_1000, &out);
  Write("kAruco6x6Codes", cv::aruco::DICT_6X6_1000, &out);
  out << "\n}  // namespace colmap_seapoint\n";
  out.close();
  if (out) return 0;
  std::cerr << argv[1] << ": cannot be written\n";
  return 1;
}
