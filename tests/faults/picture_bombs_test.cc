// Small files that promise, or unfold into, far more than they are: left out at once, each with
// its reason, while the pictures beside them are taken.
#include <zlib.h>

#include "tests/faults/faults_fixture.h"

namespace colmap_seapoint {
namespace {

std::string BigEndian(uint64_t value, int num_bytes) {
  std::string bytes;
  for (int i = num_bytes - 1; i >= 0; --i) bytes += static_cast<char>(value >> (8 * i) & 255);
  return bytes;
}

std::string LittleEndian(uint64_t value, int num_bytes) {
  const std::string bytes = BigEndian(value, num_bytes);
  return {bytes.rbegin(), bytes.rend()};
}

// One component, each of whose blocks has one bit or none.
std::string Jpeg(uint8_t frame_marker, int width, int height, int num_more_scans,
                 size_t data_bytes) {
  std::string jpeg = "\xff\xd8\xff\xdb" + BigEndian(67, 2) + '\0' + std::string(64, '\1');
  jpeg += std::string("\xff") + static_cast<char>(frame_marker) + BigEndian(11, 2) + '\x08' +
          BigEndian(static_cast<uint64_t>(height), 2) + BigEndian(static_cast<uint64_t>(width), 2) +
          std::string("\1\1\x11\0", 4);
  for (const char table : {'\x00', '\x10'}) {
    jpeg += "\xff\xc4" + BigEndian(20, 2) + table + '\1' + std::string(16, '\0');
  }
  const bool is_progressive = frame_marker == 0xc2;
  jpeg += "\xff\xda" + BigEndian(8, 2) + std::string("\1\1\0\0", 4) +
          (is_progressive ? '\0' : '\x3f') + '\0' + std::string(data_bytes, '\0');
  for (int i = 0; i < num_more_scans; ++i) {
    jpeg += "\xff\xda" + BigEndian(8, 2) + std::string("\1\1\0\1\x3f\0\0\0", 8);
  }
  return jpeg + "\xff\xd9";
}

std::string Tiff(int side, int compression, const std::string& data) {
  std::string entries;
  const auto add = [&](int tag, int type, uint64_t value) {
    entries += LittleEndian(static_cast<uint64_t>(tag), 2) +
               LittleEndian(static_cast<uint64_t>(type), 2) + LittleEndian(1, 4) +
               LittleEndian(value, 4);
  };
  constexpr int kShort = 3, kLong = 4, kNumEntries = 9;
  const auto length = static_cast<uint64_t>(side);
  add(256, kLong, length);
  add(257, kLong, length);
  add(258, kShort, 8);
  add(259, kShort, static_cast<uint64_t>(compression));
  add(262, kShort, 1);
  add(273, kLong, 8 + 2 + 12 * kNumEntries + 4);
  add(277, kShort, 1);
  add(278, kLong, length);
  add(279, kLong, data.size());
  return std::string("II*\0", 4) + LittleEndian(8, 4) + LittleEndian(kNumEntries, 2) + entries +
         LittleEndian(0, 4) + data;
}

std::string Deflated(size_t num_zeros) {
  const std::string zeros(num_zeros, '\0');
  uLongf size = compressBound(num_zeros);
  std::string packed(size, '\0');
  compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
            reinterpret_cast<const Bytef*>(zeros.data()), num_zeros, 9);
  return packed.substr(0, size);
}

std::string PngChunk(const std::string& type, const std::string& data) {
  const std::string body = type + data;
  const auto checksum =
      crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  return BigEndian(data.size(), 4) + body + BigEndian(checksum, 4);
}

std::string Png(uint64_t side, size_t num_zeros) {
  return "\x89PNG\r\n\x1a\n" +
         PngChunk("IHDR",
                  BigEndian(side, 4) + BigEndian(side, 4) + std::string("\x08\2\0\0\0", 5)) +
         PngChunk("IDAT", Deflated(num_zeros)) + PngChunk("IEND", "");
}

std::string Webp(uint64_t side) {
  const std::string data = '\x2f' + LittleEndian((side - 1) | (side - 1) << 14, 4) +
                           "\x88\x88\x08" + std::string(60, '\0');
  return "RIFF" + LittleEndian(12 + data.size(), 4) + "WEBPVP8L" + LittleEndian(data.size(), 4) +
         data;
}

std::string Bmp(uint64_t side) {
  return "BM" + LittleEndian(0, 8) + LittleEndian(54, 4) + LittleEndian(40, 4) +
         LittleEndian(side, 4) + LittleEndian(side, 4) + LittleEndian(1, 2) + LittleEndian(24, 2) +
         std::string(24, '\0') + std::string(500, '\0');
}

class Bombs : public Faults {
 protected:
  void Plant(const std::string& name, const std::string& bytes) {
    WriteBytes(folder_ / "images" / name, bytes);
    names_.push_back(name);
  }

  // Every bomb is left out with this word; the pictures beside it are not.
  void ExpectDefused(const std::string& word, const Arguments& more = {}) {
    const CliResult result = Run(Extract(), {}, more);
    EXPECT_EQ(result.exit_code, 3) << result.Text();
    for (const std::string& name : names_) {
      const size_t line = result.err.find(name + " is left out: ");
      ASSERT_NE(line, std::string::npos) << result.Text();
      const std::string reason = result.err.substr(line, result.err.find('\n', line) - line);
      EXPECT_NE(reason.find(word), std::string::npos) << reason;
    }
    EXPECT_EQ(result.err.find("img1.png is left out"), std::string::npos) << result.Text();
    EXPECT_LT(result.peak_rss_bytes, 400u << 20) << "as much as the pictures beside them take";
  }

  std::vector<std::string> names_;
};

TEST_F(Bombs, HeadersThatPromiseTooMuch) {
  Plant("base.jpg", Jpeg(0xc0, 65500, 16390, 0, 400));
  Plant("progressive.jpg", Jpeg(0xc2, 65500, 16390, 0, 400));
  Plant("none.tif", Tiff(32767, 1, std::string(100, '\0')));
  Plant("lzw.tif", Tiff(32767, 5, std::string("\x80\0\x20\x50", 4) + std::string(100, '\0')));
  Plant("packbits.tif", Tiff(32767, 32773, std::string(100, '\x81')));
  Plant("deflate.tif", Tiff(32767, 8, Deflated(300000)));
  Plant("fax.tif", Tiff(32767, 4, std::string(100, '\x10')));
  Plant("a.png", Png(32000, 100000));
  Plant("a.webp", Webp(16383));
  Plant("a.bmp", Bmp(32767));
  Plant("a.pgm", "P2\n30000 30000\n255\n1 1");
  ExpectDefused("do not fit");
}

TEST_F(Bombs, ScansWithoutEnd) {
  Plant("scans.jpg", Jpeg(0xc2, 2048, 2048, 1500, 20000));
  ExpectDefused("more than 64 scans");
}

TEST_F(Bombs, WhatNoCameraWrites) {
  Plant("box.jp2", std::string("\0\0\0\x0cjP  \r\n\x87\n", 12) + std::string(200, '\0'));
  Plant("named_otherwise.jpg", "\xff\x4f\xff\x51" + std::string(200, '\0'));
  ExpectDefused("JPEG 2000");
}

// 49 megapixels from 150 KB of a legal file: whether they are worth their memory is the user's.
TEST_F(Bombs, TheBudgetIsTheUsers) {
  Plant("black.png", Png(7000, 7000 * 21001));
  ExpectDefused("--max_memory is 100 MB", {"--max_memory", "100M"});
  for (const char* wrong : {"much", "0", "-1", "4X", "1e400"}) {
    const CliResult result = Run(Extract(), {}, {"--max_memory", wrong});
    EXPECT_EQ(result.exit_code, 2) << result.Text();
    EXPECT_NE(result.LastErrorLine().find("--max_memory"), std::string::npos) << result.Text();
  }
}

}  // namespace
}  // namespace colmap_seapoint
