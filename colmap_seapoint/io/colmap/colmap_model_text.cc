#include <charconv>
#include <string_view>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/colmap/colmap_model_internal.h"
#include "colmap_seapoint/io/colmap/colmap_rigs.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/input_stream.h"

namespace colmap_seapoint {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";

std::string_view Trim(std::string_view text) {
  const size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

// The lines of a file, with their numbers.
class LineReader {
 public:
  explicit LineReader(const std::filesystem::path& path) : path_(path), stream_(path) {}

  bool Next() {
    if (!std::getline(stream_, line_)) {
      line_.clear();
      return false;
    }
    ++number_;
    return true;
  }

  // Next line that is neither blank nor a comment.
  bool NextRecord() {
    while (Next()) {
      const std::string_view text = Trim(line_);
      if (!text.empty() && text.front() != '#') return true;
    }
    return false;
  }

  std::string_view Line() const { return Trim(line_); }
  RecordPlace Place() const { return RecordPlace(path_, "line", number_); }

 private:
  std::filesystem::path path_;
  InputStream stream_;
  std::string line_;
  uint64_t number_ = 0;
};

// The words of a line, as numbers and text.
class WordReader {
 public:
  WordReader(const RecordPlace& place, std::string_view line) : place_(place), rest_(line) {}

  bool AtEnd() {
    rest_ = Trim(rest_);
    return rest_.empty();
  }

  std::string_view Word(const char* what) {
    if (AtEnd()) place_.Fail(std::string("the line ends before ") + what);
    const std::string_view word = rest_.substr(0, rest_.find_first_of(kBlanks));
    rest_.remove_prefix(word.size());
    return word;
  }

  template <typename T>
  T Number(const char* what) {
    const std::string_view word = Word(what);
    T value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) {
      place_.Fail("'" + std::string(word.substr(0, 40)) + "' is no legal value of " + what);
    }
    return value;
  }

  std::string_view Rest() { return Trim(rest_); }

 private:
  const RecordPlace& place_;
  std::string_view rest_;
};

void ReadCameras(const std::filesystem::path& path, ModelBeingRead* read) {
  LineReader lines(path);
  while (lines.NextRecord()) {
    const RecordPlace place = lines.Place();
    WordReader words(place, lines.Line());
    const auto camera_id = words.Number<uint32_t>("CAMERA_ID");
    const std::string name(words.Word("MODEL"));
    const auto width = words.Number<uint64_t>("WIDTH");
    const auto height = words.Number<uint64_t>("HEIGHT");
    const CameraModelInfo* info = FindCameraModel(name);
    if (info == nullptr) {
      place.Fail("camera " + std::to_string(camera_id) + " has the unknown camera model '" + name +
                 "' (known: " + CameraModelNames() + ")");
    }
    std::vector<double> params;
    while (!words.AtEnd()) params.push_back(words.Number<double>("PARAMS[]"));
    if (params.size() != static_cast<size_t>(info->num_params)) {
      place.Fail("camera " + std::to_string(camera_id) + " has " + std::to_string(params.size()) +
                 " parameters, but " + name + " has " + std::to_string(info->num_params));
    }
    AddCamera(place, camera_id, static_cast<int>(info->model), width, height, std::move(params),
              read);
  }
}

// The second line of an image: X Y POINT3D_ID ..., or empty.
void ReadFeatures(const RecordPlace& place, std::string_view line, PosedImage* image) {
  WordReader words(place, line);
  while (!words.AtEnd()) {
    const auto x = words.Number<double>("X");
    const auto y = words.Number<double>("Y");
    const auto point3D_id = words.Number<int64_t>("POINT3D_ID");
    if (point3D_id < -1) place.Fail("POINT3D_ID " + std::to_string(point3D_id) + " is negative");
    image->points2D.emplace_back(x, y);
    image->point3D_ids.push_back(point3D_id == -1 ? kNoPoint3D : static_cast<uint64_t>(point3D_id));
  }
}

void ReadImages(const std::filesystem::path& path, ModelBeingRead* read) {
  LineReader lines(path);
  PosedImage image;
  while (lines.NextRecord()) {
    const RecordPlace place = lines.Place();
    WordReader words(place, lines.Line());
    image.points2D.clear();
    image.point3D_ids.clear();
    image.image_id = words.Number<uint32_t>("IMAGE_ID");
    Eigen::Vector4d qvec;
    for (int i = 0; i < 4; ++i) qvec[i] = words.Number<double>("QW, QX, QY, QZ");
    for (int i = 0; i < 3; ++i) {
      image.cam_from_world.translation[i] = words.Number<double>("TX, TY, TZ");
    }
    image.camera_id = words.Number<uint32_t>("CAMERA_ID");
    image.name = std::string(words.Rest());
    if (lines.Next()) ReadFeatures(lines.Place(), lines.Line(), &image);
    AddImage(place, qvec, &image, read);
  }
}

void ReadPoints(const std::filesystem::path& path, ModelBeingRead* read) {
  LineReader lines(path);
  while (lines.NextRecord()) {
    const RecordPlace place = lines.Place();
    WordReader words(place, lines.Line());
    const auto point3D_id = words.Number<uint64_t>("POINT3D_ID");
    SparsePoint point;
    for (int i = 0; i < 3; ++i) point.xyz[i] = words.Number<double>("X, Y, Z");
    for (uint8_t& value : point.rgb) value = words.Number<uint8_t>("R, G, B");
    point.error = words.Number<double>("ERROR");
    while (!words.AtEnd()) {
      const auto image_id = words.Number<uint32_t>("TRACK[] IMAGE_ID");
      const auto point2D_idx = words.Number<uint32_t>("TRACK[] POINT2D_IDX");
      point.track.push_back({image_id, point2D_idx});
    }
    AddPoint(place, point3D_id, std::move(point), read);
  }
}

// 17 digits, never a decimal comma.
std::string Text(double value) {
  char buffer[40];
  const auto result =
      std::to_chars(buffer, buffer + sizeof(buffer), value, std::chars_format::general, 17);
  return std::string(buffer, result.ptr);
}

void WriteCameras(AtomicFile* file, const SparseModel& model) {
  file->Write("# Camera list with one line of data per camera:\n" +
              std::string("#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n") +
              "# Number of cameras: " + std::to_string(model.cameras.size()) + "\n");
  for (const auto& [camera_id, camera] : model.cameras) {
    const CameraModelInfo* info = FindCameraModel(static_cast<int>(camera.model));
    SEAPOINT_CHECK(info != nullptr);
    std::string line = std::to_string(camera_id) + " " + info->name + " " +
                       std::to_string(camera.width) + " " + std::to_string(camera.height);
    for (const double param : camera.params) line += " " + Text(param);
    file->Write(line + "\n");
  }
}

void WriteImages(AtomicFile* file, const SparseModel& model) {
  file->Write("# Image list with two lines of data per image:\n" +
              std::string("#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n") +
              "#   POINTS2D[] as (X, Y, POINT3D_ID)\n" +
              "# Number of images: " + std::to_string(model.images.size()) + "\n");
  for (const PosedImage& image : model.images) {
    const Eigen::Quaterniond& rotation = image.cam_from_world.rotation;
    std::string text = std::to_string(image.image_id);
    for (const double q : {rotation.w(), rotation.x(), rotation.y(), rotation.z()}) {
      text += " " + Text(q);
    }
    for (const double t : image.cam_from_world.translation) text += " " + Text(t);
    text += " " + std::to_string(image.camera_id) + " " + image.name + "\n";
    SEAPOINT_CHECK(image.points2D.size() == image.point3D_ids.size());
    for (size_t i = 0; i < image.points2D.size(); ++i) {
      if (i > 0) text += " ";
      text += Text(image.points2D[i].x()) + " " + Text(image.points2D[i].y()) + " ";
      text += image.point3D_ids[i] == kNoPoint3D ? "-1" : std::to_string(image.point3D_ids[i]);
    }
    file->Write(text + "\n");
  }
}

void WritePoints(AtomicFile* file, const SparseModel& model) {
  file->Write("# 3D point list with one line of data per point:\n" +
              std::string("#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, ") +
              "TRACK[] as (IMAGE_ID, POINT2D_IDX)\n" +
              "# Number of points: " + std::to_string(model.points3D.size()) + "\n");
  for (const auto& [point3D_id, point] : model.points3D) {
    std::string text = std::to_string(point3D_id);
    for (const double x : point.xyz) text += " " + Text(x);
    for (const uint8_t value : point.rgb) text += " " + std::to_string(value);
    text += " " + Text(point.error);
    for (const SparsePoint::TrackElement& element : point.track) {
      text += " " + std::to_string(element.image_id) + " " + std::to_string(element.point2D_idx);
    }
    file->Write(text + "\n");
  }
}

}  // namespace

void ReadModelText(const std::filesystem::path& dir, ModelBeingRead* read) {
  ReadCameras(dir / "cameras.txt", read);
  ReadImages(dir / "images.txt", read);
  ReadPoints(dir / "points3D.txt", read);
}

std::vector<std::vector<uint64_t>> ReadFramesText(const std::filesystem::path& path) {
  std::vector<std::vector<uint64_t>> frames;
  LineReader lines(path);
  while (lines.NextRecord()) {
    const RecordPlace place = lines.Place();
    WordReader words(place, lines.Line());
    words.Number<uint32_t>("FRAME_ID");
    words.Number<uint32_t>("RIG_ID");
    for (int i = 0; i < 7; ++i) words.Number<double>("RIG_FROM_WORLD");
    const auto num_data = words.Number<uint32_t>("NUM_DATA_IDS");
    frames.emplace_back();
    for (uint32_t i = 0; i < num_data; ++i) {
      const bool is_camera = words.Word("SENSOR_TYPE") == "CAMERA";
      words.Number<uint32_t>("SENSOR_ID");
      const auto data_id = words.Number<uint64_t>("DATA_ID");
      if (is_camera) frames.back().push_back(data_id);
    }
  }
  return frames;
}

void WriteSparseModelText(const std::filesystem::path& dir, const SparseModel& model) {
  CheckWritableDir(dir);
  AtomicFile cameras(dir / "cameras.txt");
  AtomicFile images(dir / "images.txt");
  AtomicFile points(dir / "points3D.txt");
  WriteCameras(&cameras, model);
  WriteImages(&images, model);
  WritePoints(&points, model);
  RemoveRigFiles(dir);
  cameras.Commit();
  images.Commit();
  points.Commit();
}

}  // namespace colmap_seapoint
