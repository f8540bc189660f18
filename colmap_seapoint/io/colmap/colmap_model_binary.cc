#include <cstring>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/colmap/colmap_model_internal.h"
#include "colmap_seapoint/io/colmap/colmap_rigs.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/input_stream.h"

namespace colmap_seapoint {
namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "COLMAP's files are little-endian");

constexpr size_t kMaxNameBytes = 4096;
constexpr size_t kFeatureBytes = 2 * sizeof(double) + sizeof(uint64_t);
constexpr int32_t kCameraSensor = 0;  // COLMAP's SensorType::CAMERA
constexpr size_t kTrackElementBytes = 2 * sizeof(uint32_t);

// Reads values one after the other and knows how many bytes are left.
class BinaryReader {
 public:
  explicit BinaryReader(const std::filesystem::path& path)
      : path_(path), stream_(path), size_(std::filesystem::file_size(path)) {}

  RecordPlace Place() const { return RecordPlace(path_, "byte", offset_); }

  void ReadBytes(void* data, size_t size) {
    const auto count = static_cast<std::streamsize>(size);
    if (size > size_ - offset_ ||
        stream_.rdbuf()->sgetn(static_cast<char*>(data), count) != count) {
      Place().Fail("the file ends in the middle of a record: it is truncated or damaged");
    }
    offset_ += size;
  }

  template <typename T>
  T Read() {
    T value;
    ReadBytes(&value, sizeof(T));
    return value;
  }

  // A count of records of at least `min_bytes` each, which must fit into the rest of the file.
  uint64_t ReadCount(size_t min_bytes, const char* what) {
    const RecordPlace place = Place();
    const uint64_t count = Read<uint64_t>();
    ExpectRoomFor(count, min_bytes, what, place);
    return count;
  }

  void ExpectRoomFor(uint64_t count, size_t min_bytes, const char* what,
                     const RecordPlace& place) const {
    if (count > (size_ - offset_) / min_bytes) {
      place.Fail("a count of " + std::to_string(count) + " " + what +
                 " is more than the file can hold: it is truncated or damaged");
    }
  }

  std::string ReadName() {
    std::string name;
    for (char c = Read<char>(); c != '\0'; c = Read<char>()) {
      name.push_back(c);
      if (name.size() > kMaxNameBytes) Place().Fail("an image name does not end");
    }
    return name;
  }

  void ExpectEnd() const {
    if (offset_ != size_) Place().Fail("bytes follow the last record: the file is damaged");
  }

 private:
  std::filesystem::path path_;
  InputStream stream_;
  uint64_t size_ = 0;
  uint64_t offset_ = 0;
};

void ReadCameras(const std::filesystem::path& path, ModelBeingRead* read) {
  BinaryReader reader(path);
  const uint64_t count = reader.ReadCount(24 + 2 * sizeof(double), "cameras");
  for (uint64_t i = 0; i < count; ++i) {
    const RecordPlace place = reader.Place();
    const auto camera_id = reader.Read<uint32_t>();
    const auto model_id = reader.Read<int32_t>();
    const auto width = reader.Read<uint64_t>();
    const auto height = reader.Read<uint64_t>();
    const CameraModelInfo* info = FindCameraModel(model_id);
    if (info == nullptr) {
      place.Fail("camera " + std::to_string(camera_id) + " has the unknown camera model " +
                 std::to_string(model_id) + " (known: " + CameraModelNames() + ")");
    }
    std::vector<double> params(static_cast<size_t>(info->num_params));
    reader.ReadBytes(params.data(), params.size() * sizeof(double));
    AddCamera(place, camera_id, model_id, width, height, std::move(params), read);
  }
  reader.ExpectEnd();
}

void ReadImages(const std::filesystem::path& path, ModelBeingRead* read) {
  BinaryReader reader(path);
  const uint64_t count = reader.ReadCount(4 + 7 * sizeof(double) + 4 + 1 + 8, "images");
  PosedImage image;
  for (uint64_t i = 0; i < count; ++i) {
    const RecordPlace place = reader.Place();
    image.points2D.clear();
    image.point3D_ids.clear();
    image.image_id = reader.Read<uint32_t>();
    Eigen::Vector4d qvec;
    reader.ReadBytes(qvec.data(), 4 * sizeof(double));
    reader.ReadBytes(image.cam_from_world.translation.data(), 3 * sizeof(double));
    image.camera_id = reader.Read<uint32_t>();
    image.name = reader.ReadName();
    const uint64_t num_features = reader.ReadCount(kFeatureBytes, "features");
    image.points2D.reserve(num_features);
    image.point3D_ids.reserve(num_features);
    for (uint64_t j = 0; j < num_features; ++j) {
      char record[kFeatureBytes];
      reader.ReadBytes(record, sizeof(record));
      Eigen::Vector2d point;
      uint64_t point3D_id;
      std::memcpy(point.data(), record, 2 * sizeof(double));
      std::memcpy(&point3D_id, record + 2 * sizeof(double), sizeof(point3D_id));
      image.points2D.push_back(point);
      image.point3D_ids.push_back(point3D_id);
    }
    AddImage(place, qvec, &image, read);
  }
  reader.ExpectEnd();
}

void ReadPoints(const std::filesystem::path& path, ModelBeingRead* read) {
  BinaryReader reader(path);
  const uint64_t count = reader.ReadCount(8 + 3 * sizeof(double) + 3 + 8 + 8, "points");
  for (uint64_t i = 0; i < count; ++i) {
    const RecordPlace place = reader.Place();
    const auto point3D_id = reader.Read<uint64_t>();
    SparsePoint point;
    reader.ReadBytes(point.xyz.data(), 3 * sizeof(double));
    reader.ReadBytes(point.rgb.data(), 3);
    point.error = reader.Read<double>();
    const uint64_t length = reader.ReadCount(kTrackElementBytes, "track elements");
    point.track.resize(length);
    for (SparsePoint::TrackElement& element : point.track) {
      element.image_id = reader.Read<uint32_t>();
      element.point2D_idx = reader.Read<uint32_t>();
    }
    AddPoint(place, point3D_id, std::move(point), read);
  }
  reader.ExpectEnd();
}

template <typename T>
void Put(AtomicFile* file, T value) {
  file->Write(&value, sizeof(T));
}

void WriteCameras(AtomicFile* file, const SparseModel& model) {
  Put<uint64_t>(file, model.cameras.size());
  for (const auto& [camera_id, camera] : model.cameras) {
    Put<uint32_t>(file, camera_id);
    Put<int32_t>(file, static_cast<int32_t>(camera.model));
    Put<uint64_t>(file, static_cast<uint64_t>(camera.width));
    Put<uint64_t>(file, static_cast<uint64_t>(camera.height));
    file->Write(camera.params.data(), camera.params.size() * sizeof(double));
  }
}

void WriteImages(AtomicFile* file, const SparseModel& model) {
  Put<uint64_t>(file, model.images.size());
  for (const PosedImage& image : model.images) {
    Put<uint32_t>(file, image.image_id);
    const Eigen::Quaterniond& rotation = image.cam_from_world.rotation;
    for (const double q : {rotation.w(), rotation.x(), rotation.y(), rotation.z()}) Put(file, q);
    file->Write(image.cam_from_world.translation.data(), 3 * sizeof(double));
    Put<uint32_t>(file, image.camera_id);
    file->Write(image.name.c_str(), image.name.size() + 1);
    Put<uint64_t>(file, image.points2D.size());
    SEAPOINT_CHECK(image.points2D.size() == image.point3D_ids.size());
    for (size_t i = 0; i < image.points2D.size(); ++i) {
      file->Write(image.points2D[i].data(), 2 * sizeof(double));
      Put<uint64_t>(file, image.point3D_ids[i]);
    }
  }
}

void WritePoints(AtomicFile* file, const SparseModel& model) {
  Put<uint64_t>(file, model.points3D.size());
  for (const auto& [point3D_id, point] : model.points3D) {
    Put<uint64_t>(file, point3D_id);
    file->Write(point.xyz.data(), 3 * sizeof(double));
    file->Write(point.rgb.data(), 3);
    Put<double>(file, point.error);
    Put<uint64_t>(file, point.track.size());
    for (const SparsePoint::TrackElement& element : point.track) {
      Put<uint32_t>(file, element.image_id);
      Put<uint32_t>(file, element.point2D_idx);
    }
  }
}

}  // namespace

void ReadModelBinary(const std::filesystem::path& dir, ModelBeingRead* read) {
  ReadCameras(dir / "cameras.bin", read);
  ReadImages(dir / "images.bin", read);
  ReadPoints(dir / "points3D.bin", read);
}

std::vector<std::vector<uint64_t>> ReadFramesBinary(const std::filesystem::path& path) {
  constexpr size_t kIdsAndPoseBytes = 2 * sizeof(uint32_t) + 7 * sizeof(double);
  constexpr size_t kDataBytes = 4 + 4 + 8;
  BinaryReader reader(path);
  const uint64_t count = reader.ReadCount(kIdsAndPoseBytes + 4, "frames");
  std::vector<std::vector<uint64_t>> frames(count);
  for (std::vector<uint64_t>& frame : frames) {
    char ids_and_pose[kIdsAndPoseBytes];
    reader.ReadBytes(ids_and_pose, sizeof(ids_and_pose));
    const RecordPlace place = reader.Place();
    const auto num_data = reader.Read<uint32_t>();
    reader.ExpectRoomFor(num_data, kDataBytes, "pictures of a frame", place);
    for (uint32_t i = 0; i < num_data; ++i) {
      const auto sensor_type = reader.Read<int32_t>();
      reader.Read<uint32_t>();  // sensor_id
      const auto data_id = reader.Read<uint64_t>();
      if (sensor_type == kCameraSensor) frame.push_back(data_id);
    }
  }
  reader.ExpectEnd();
  return frames;
}

void WriteSparseModelBinary(const std::filesystem::path& dir, const SparseModel& model) {
  CheckWritableDir(dir);
  AtomicFile cameras(dir / "cameras.bin");
  AtomicFile images(dir / "images.bin");
  AtomicFile points(dir / "points3D.bin");
  WriteCameras(&cameras, model);
  WriteImages(&images, model);
  WritePoints(&points, model);
  RemoveRigFiles(dir);
  cameras.Commit();
  images.Commit();
  points.Commit();
}

}  // namespace colmap_seapoint
