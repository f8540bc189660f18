#include "colmap_seapoint/io/las/las_format.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/version.h"
#include "colmap_seapoint/io/las/export_cloud.h"

namespace colmap_seapoint {
namespace {

constexpr uint8_t kPointFormat = 7;
constexpr uint16_t kCrsIsWkt = 1 << 4;  // what format 7 demands, also where there is none
constexpr uint8_t kOnlyReturn = 1 | 1 << 4;
constexpr uint8_t kExtraFloat = 9;  // the type of an extra byte

struct Extra {
  const char* name;  // as PDAL and CloudCompare know them
  const char* description;
};
constexpr Extra kNormals[] = {{"NormalX", "unit normal of the surface"},
                              {"NormalY", "unit normal of the surface"},
                              {"NormalZ", "unit normal of the surface"}};
constexpr Extra kConfidence = {"Confidence", "0 to 1"};

void AppendBytes(const void* data, size_t size, std::vector<char>* bytes) {
  if (size == 0) return;
  const size_t end = bytes->size();
  bytes->resize(end + size);
  std::memcpy(bytes->data() + end, data, size);
}

// Little-endian, which every machine is that we run on.
template <typename T>
void Append(T value, std::vector<char>* bytes) {
  AppendBytes(&value, sizeof(T), bytes);
}

// Padded with zeros, or cut.
void AppendText(const std::string& text, size_t size, std::vector<char>* bytes) {
  AppendBytes(text.data(), std::min(text.size(), size), bytes);
  bytes->resize(bytes->size() + size - std::min(text.size(), size));
}

void AppendZeros(size_t size, std::vector<char>* bytes) { bytes->resize(bytes->size() + size); }

void AppendExtra(const Extra& extra, std::vector<char>* bytes) {
  AppendZeros(2, bytes);
  Append(kExtraFloat, bytes);
  Append(uint8_t{0}, bytes);  // neither nodata nor range nor scale follow
  AppendText(extra.name, 32, bytes);
  AppendZeros(4 + 5 * 24, bytes);
  AppendText(extra.description, 32, bytes);
}

LasRecord CrsRecord(const std::string& wkt) {
  LasRecord record = {"LASF_Projection", 2112, "OGC WKT", {wkt.begin(), wkt.end()}};
  record.bytes.push_back('\0');
  return record;
}

LasRecord ExtraRecord(const LasHeader& header) {
  LasRecord record = {"LASF_Spec", 4, "Extra bytes", {}};
  for (const Extra& normal : kNormals) {
    if (header.has_normals) AppendExtra(normal, &record.bytes);
  }
  if (header.has_confidence) AppendExtra(kConfidence, &record.bytes);
  return record;
}

void AppendFrame(const LasHeader& header, std::vector<char>* bytes) {
  for (int i = 0; i < 3; ++i) Append(header.scale, bytes);
  for (int i = 0; i < 3; ++i) Append(header.offset[i], bytes);
  for (int i = 0; i < 3; ++i) {
    Append(header.max[i], bytes);
    Append(header.min[i], bytes);
  }
}

}  // namespace

std::vector<LasRecord> RecordsOf(const LasHeader& header) {
  std::vector<LasRecord> records;
  if (!header.crs_wkt.empty()) records.push_back(CrsRecord(header.crs_wkt));
  if (ExtraBytes(header) > 0) records.push_back(ExtraRecord(header));
  return records;
}

size_t ExtraBytes(const LasHeader& header) {
  return sizeof(float) * ((header.has_normals ? 3 : 0) + (header.has_confidence ? 1 : 0));
}

// No date stands in it: the same cloud gives the same bytes.
std::vector<char> HeaderBytes(const LasHeader& header) {
  std::vector<char> records;
  for (const LasRecord& record : RecordsOf(header)) {
    AppendZeros(2, &records);
    AppendText(record.user, 16, &records);
    Append(record.id, &records);
    Append(static_cast<uint16_t>(record.bytes.size()), &records);
    AppendText(record.description, 32, &records);
    AppendBytes(record.bytes.data(), record.bytes.size(), &records);
  }
  std::vector<char> bytes;
  AppendText("LASF", 4, &bytes);
  Append(uint16_t{0}, &bytes);  // source
  Append(kCrsIsWkt, &bytes);
  AppendZeros(16, &bytes);  // GUID
  Append(uint8_t{1}, &bytes);
  Append(uint8_t{4}, &bytes);
  AppendText(kLasWords, 32, &bytes);
  AppendText("colmap_seapoint " + std::string(Version()), 32, &bytes);
  AppendZeros(4, &bytes);  // day and year
  Append(static_cast<uint16_t>(kLasHeaderBytes), &bytes);
  Append(static_cast<uint32_t>(kLasHeaderBytes + records.size()), &bytes);
  Append(static_cast<uint32_t>(RecordsOf(header).size()), &bytes);
  Append(kPointFormat, &bytes);
  Append(static_cast<uint16_t>(kLasPointBytes + ExtraBytes(header)), &bytes);
  AppendZeros(4 + 5 * 4, &bytes);  // the counts of versions before 1.4
  AppendFrame(header, &bytes);
  AppendZeros(8 + 8 + 4, &bytes);  // waveforms and extended records: none
  Append(header.num_points, &bytes);
  Append(header.num_points, &bytes);  // all are first returns
  AppendZeros(14 * 8, &bytes);
  SEAPOINT_CHECK(bytes.size() == kLasHeaderBytes);
  AppendBytes(records.data(), records.size(), &bytes);
  return bytes;
}

std::array<int32_t, 3> Quantized(const LasHeader& header, const Eigen::Vector3d& xyz) {
  std::array<int32_t, 3> integers{};
  for (int i = 0; i < 3; ++i) {
    integers[static_cast<size_t>(i)] =
        static_cast<int32_t>(std::llround((xyz[i] - header.offset[i]) / header.scale));
  }
  return integers;
}

std::array<uint16_t, 3> WideColor(const std::array<uint8_t, 3>& rgb) {
  const auto wide = [](uint8_t value) { return static_cast<uint16_t>(value * 257); };
  return {wide(rgb[0]), wide(rgb[1]), wide(rgb[2])};
}

void AppendPoint(const LasHeader& header, const CloudVertex& vertex, const Eigen::Vector3d& xyz,
                 std::vector<char>* bytes) {
  for (const int32_t integer : Quantized(header, xyz)) Append(integer, bytes);
  AppendZeros(2, bytes);  // intensity
  Append(kOnlyReturn, bytes);
  AppendZeros(1 + 1 + 1 + 2 + 2 + 8, bytes);  // flags, class, user's, angle, source, time
  for (const uint16_t channel : WideColor(vertex.rgb)) Append(channel, bytes);
  AppendExtraBytes(header, vertex, bytes);
}

void AppendExtraBytes(const LasHeader& header, const CloudVertex& vertex,
                      std::vector<char>* bytes) {
  for (int i = 0; header.has_normals && i < 3; ++i) Append(vertex.normal[i], bytes);
  if (header.has_confidence) Append(vertex.confidence, bytes);
}

}  // namespace colmap_seapoint
