#include "colmap_seapoint/io/colmap/colmap_rigs.h"

#include <charconv>
#include <cstring>
#include <functional>
#include <iterator>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/input_stream.h"

namespace colmap_seapoint {
namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "COLMAP's files are little-endian");

constexpr char kRemedy[] =
    "write the model again with COLMAP (e.g. colmap model_converter) or restore a copy";

using Move = std::function<Rigid3d(const Rigid3d&)>;

bool IsFile(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

std::string ReadWhole(const std::filesystem::path& path) {
  InputStream stream(path);
  return {std::istreambuf_iterator<char>(stream), {}};
}

Rigid3d FromNumbers(const double* qwxyz_t) {
  Rigid3d pose;
  pose.rotation = Eigen::Quaterniond(qwxyz_t[0], qwxyz_t[1], qwxyz_t[2], qwxyz_t[3]);
  pose.translation = {qwxyz_t[4], qwxyz_t[5], qwxyz_t[6]};
  return pose;
}

void ToNumbers(const Rigid3d& pose, double* qwxyz_t) {
  const Eigen::Quaterniond& q = pose.rotation;
  const Eigen::Vector3d& t = pose.translation;
  const double numbers[7] = {q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z()};
  std::copy(numbers, numbers + 7, qwxyz_t);
}

// Walks over a file's bytes, and changes the poses in their places.
class PosePatcher {
 public:
  PosePatcher(const std::filesystem::path& path, std::string* bytes)
      : path_(path), bytes_(*bytes) {}

  template <typename T>
  T Read() {
    T value;
    std::memcpy(&value, At(sizeof(T)), sizeof(T));
    return value;
  }
  void Skip(uint64_t size) { At(size); }
  void PatchPose(const Move& move) {
    double numbers[7];
    char* place = At(sizeof(numbers));
    std::memcpy(numbers, place, sizeof(numbers));
    ToNumbers(move(FromNumbers(numbers)), numbers);
    std::memcpy(place, numbers, sizeof(numbers));
  }
  void ExpectEnd() const {
    if (offset_ != bytes_.size()) Fail("bytes follow the last record");
  }

 private:
  char* At(uint64_t size) {
    if (size > bytes_.size() - offset_) Fail("the file ends in the middle of a record");
    char* place = bytes_.data() + offset_;
    offset_ += size;
    return place;
  }
  [[noreturn]] void Fail(const std::string& finding) const {
    throw Error(path_.string(), "byte " + std::to_string(offset_) + ": " + finding, kRemedy);
  }

  const std::filesystem::path& path_;
  std::string& bytes_;
  uint64_t offset_ = 0;
};

constexpr uint64_t kSensorBytes = 4 + 4;    // type, id
constexpr uint64_t kDataBytes = 4 + 4 + 8;  // sensor, data id

void PatchRigs(PosePatcher* file, const Move& move) {
  const auto num_rigs = file->Read<uint64_t>();
  for (uint64_t i = 0; i < num_rigs; ++i) {
    file->Skip(sizeof(uint32_t));  // rig_id
    const auto num_sensors = file->Read<uint32_t>();
    if (num_sensors > 0) file->Skip(kSensorBytes);  // the reference sensor is the rig's frame
    for (uint32_t j = 1; j < num_sensors; ++j) {
      file->Skip(kSensorBytes);
      if (file->Read<uint8_t>() != 0) file->PatchPose(move);
    }
  }
  file->ExpectEnd();
}

void PatchFrames(PosePatcher* file, const Move& move) {
  const auto num_frames = file->Read<uint64_t>();
  for (uint64_t i = 0; i < num_frames; ++i) {
    file->Skip(2 * sizeof(uint32_t));  // frame_id, rig_id
    file->PatchPose(move);
    file->Skip(kDataBytes * file->Read<uint32_t>());
  }
  file->ExpectEnd();
}

std::string Text(double value) {
  char buffer[40];
  const auto result =
      std::to_chars(buffer, buffer + sizeof(buffer), value, std::chars_format::general, 17);
  return std::string(buffer, result.ptr);
}

// The words of one line, whose poses are changed in their places.
class WordPatcher {
 public:
  WordPatcher(const std::string& where, const std::string& line) : where_(where) {
    std::istringstream stream(line);
    std::string word;
    while (stream >> word) words_.push_back(word);
  }

  const std::string& Next() {
    if (next_ == words_.size()) {
      throw Error(where_, "the line ends in the middle of a record", kRemedy);
    }
    return words_[next_++];
  }
  double NextNumber() {
    const std::string& word = Next();
    double value = 0;
    const auto parsed = std::from_chars(word.data(), word.data() + word.size(), value);
    if (parsed.ec == std::errc() && parsed.ptr == word.data() + word.size()) return value;
    throw Error(where_, "'" + word + "' is no number", kRemedy);
  }
  void PatchPose(const Move& move) {
    const size_t first = next_;
    double numbers[7];
    for (double& number : numbers) number = NextNumber();
    ToNumbers(move(FromNumbers(numbers)), numbers);
    for (size_t i = 0; i < 7; ++i) words_[first + i] = Text(numbers[i]);
  }
  std::string Line() const {
    std::string line;
    for (const std::string& word : words_) line += (line.empty() ? "" : " ") + word;
    return line;
  }

 private:
  std::string where_;
  std::vector<std::string> words_;
  size_t next_ = 0;
};

void PatchRig(WordPatcher* line, const Move& move) {
  line->Next();  // RIG_ID
  const double num_sensors = line->NextNumber();
  if (num_sensors > 0) {
    line->Next();  // REF_SENSOR_TYPE
    line->Next();  // REF_SENSOR_ID
  }
  for (double j = 1; j < num_sensors; ++j) {
    line->Next();  // SENSOR_TYPE
    line->Next();  // SENSOR_ID
    if (line->Next() == "1") line->PatchPose(move);
  }
}

void PatchFrame(WordPatcher* line, const Move& move) {
  line->Next();  // FRAME_ID
  line->Next();  // RIG_ID
  line->PatchPose(move);
}

std::string PatchText(const std::filesystem::path& path,
                      const std::function<void(WordPatcher*)>& patch) {
  std::istringstream stream(ReadWhole(path));
  std::string line, text;
  for (int number = 1; std::getline(stream, line); ++number) {
    const size_t first = line.find_first_not_of(" \t\r");
    if (first != std::string::npos && line[first] != '#') {
      WordPatcher words(path.string() + ": line " + std::to_string(number), line);
      patch(&words);
      line = words.Line();
    }
    text += line + "\n";
  }
  return text;
}

}  // namespace

bool IsBinaryModel(const std::filesystem::path& dir) {
  return IsFile(dir / "cameras.bin") && IsFile(dir / "images.bin") && IsFile(dir / "points3D.bin");
}

void RemoveRigFiles(const std::filesystem::path& dir) {
  for (const char* name : {"rigs.bin", "frames.bin", "rigs.txt", "frames.txt"}) {
    std::error_code error;
    std::filesystem::remove(dir / name, error);
    if (!error) continue;
    throw Error((dir / name).string(), "cannot be removed (" + error.message() + ")",
                "check the folder's permissions");
  }
}

void TransformRigFiles(const std::filesystem::path& from, const std::filesystem::path& to,
                       const Similarity3d& new_from_old) {
  const Move of_rig = [&](const Rigid3d& sensor_from_rig) {
    Rigid3d result = sensor_from_rig;
    result.translation *= new_from_old.scale;
    return result;
  };
  const Move of_frame = [&](const Rigid3d& rig_from_world) {
    return TransformedPose(rig_from_world, new_from_old);
  };
  const bool is_binary = IsBinaryModel(from);
  for (const bool is_frames : {false, true}) {
    const Move& move = is_frames ? of_frame : of_rig;
    const std::string name =
        std::string(is_frames ? "frames" : "rigs") + (is_binary ? ".bin" : ".txt");
    const std::filesystem::path path = from / name;
    if (!IsFile(path)) continue;
    std::string bytes;
    if (is_binary) {
      bytes = ReadWhole(path);
      PosePatcher patcher(path, &bytes);
      is_frames ? PatchFrames(&patcher, move) : PatchRigs(&patcher, move);
    } else {
      bytes = PatchText(path, [&](WordPatcher* line) {
        is_frames ? PatchFrame(line, move) : PatchRig(line, move);
      });
    }
    WriteTextFile(to / name, bytes);
  }
}

}  // namespace colmap_seapoint
