// Any values in the rows of a database. The input is a list of changes: a byte that chooses the
// column, one for the type, one for the row (even: all), one for the length, and the bytes.
#include <sqlite3.h>

#include <cstring>

#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_loops.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "colmap_seapoint/io/colmap/database_priors.h"
#include "tests/fuzz/fuzz_files.h"

using namespace colmap_seapoint;

namespace {

constexpr std::pair<const char*, const char*> kColumns[] = {
    {"cameras", "camera_id"},
    {"cameras", "model"},
    {"cameras", "width"},
    {"cameras", "height"},
    {"cameras", "params"},
    {"cameras", "prior_focal_length"},
    {"images", "image_id"},
    {"images", "name"},
    {"images", "camera_id"},
    {"images", "prior_tx"},
    {"keypoints", "image_id"},
    {"keypoints", "rows"},
    {"keypoints", "cols"},
    {"keypoints", "data"},
    {"descriptors", "rows"},
    {"descriptors", "cols"},
    {"descriptors", "data"},
    {"matches", "pair_id"},
    {"matches", "rows"},
    {"matches", "cols"},
    {"matches", "data"},
    {"two_view_geometries", "pair_id"},
    {"two_view_geometries", "rows"},
    {"two_view_geometries", "cols"},
    {"two_view_geometries", "data"},
    {"two_view_geometries", "config"},
    {"two_view_geometries", "F"},
    {"two_view_geometries", "qvec"},
    {"two_view_geometries", "tvec"},
    {"seapoint_descriptors", "rows"},
    {"seapoint_descriptors", "cols"},
    {"seapoint_descriptors", "data"},
    {"seapoint_descriptors", "data_hash"},
    {"seapoint_descriptors", "fingerprint"},
    {"seapoint_descriptors", "keypoints_hash"},
    {"seapoint_loop_pairs", "data"},
    {"seapoint_loop_pairs", "data_hash"},
};

// Three pictures with five SeaPoints each, and matches of the first two.
std::string MakeDatabase() {
  const std::filesystem::path path = FuzzFolder() / "whole.db";
  {
    ColmapDatabase database(path, ColmapDatabase::Mode::kCreateIfMissing);
    const uint32_t camera_id =
        AddCamera(&database, MakeCamera(CameraModel::kOpenCV, 500, 640, 480));
    Features features;
    for (int i = 0; i < 5; ++i) {
      features.points.push_back({20.5f + 30.f * static_cast<float>(i), 40.5f, 1, 0.1f});
      features.descriptors.push_back({static_cast<uint8_t>(i)});
    }
    for (const char* name : {"a.jpg", "b/c.jpg", "d.png"}) {
      const uint32_t image_id = AddImage(&database, name, camera_id);
      WriteFeatures(&database, image_id, features, "fingerprint");
    }
    TwoViewGeometry geometry;
    geometry.config = TwoViewConfig::kCalibrated;
    geometry.inliers = {{0, 0}, {1, 1}, {2, 2}};
    geometry.F = geometry.E = Eigen::Matrix3d::Identity();
    geometry.cam2_from_cam1 = Rigid3d();
    geometry.cam2_from_cam1->translation = {1, 0, 0};
    WriteMatches(&database, 1, 2, {{0, 0}, {1, 1}, {2, 2}, {3, 4}}, geometry);
    WriteLoopPairs(&database, "fingerprint", {{1, 3}});
    database.Finish();
  }
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void BindValue(sqlite3_stmt* statement, int type, const uint8_t* bytes, size_t size) {
  uint8_t number[8] = {};
  std::memcpy(number, bytes, std::min<size_t>(size, sizeof(number)));
  int64_t integer;
  double real;
  std::memcpy(&integer, number, sizeof(integer));
  std::memcpy(&real, number, sizeof(real));
  const int length = static_cast<int>(size);
  switch (type) {
    case 0:
      sqlite3_bind_null(statement, 1);
      break;
    case 1:
      sqlite3_bind_int64(statement, 1, integer);
      break;
    case 2:
      sqlite3_bind_double(statement, 1, real);
      break;
    case 3:
      sqlite3_bind_text(statement, 1, reinterpret_cast<const char*>(bytes), length, SQLITE_STATIC);
      break;
    default:
      sqlite3_bind_blob(statement, 1, bytes, length, SQLITE_STATIC);
  }
}

void ChangeRows(const std::filesystem::path& path, const uint8_t* data, size_t size) {
  sqlite3* handle = nullptr;
  FUZZ_REQUIRE(sqlite3_open(path.c_str(), &handle) == SQLITE_OK);
  sqlite3_exec(handle, "PRAGMA ignore_check_constraints = 1; PRAGMA synchronous = OFF; BEGIN",
               nullptr, nullptr, nullptr);
  constexpr size_t kHead = 4;
  while (size > kHead) {
    const auto& [table, column] = kColumns[data[0] % std::size(kColumns)];
    const size_t length = std::min<size_t>(data[3], size - kHead);
    std::string sql = std::string("UPDATE OR IGNORE ") + table + " SET " + column + " = ?";
    if (data[2] % 2 == 1)
      sql += std::string(" WHERE rowid = (SELECT min(rowid) FROM ") + table + ")";
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(handle, sql.c_str(), -1, &statement, nullptr) == SQLITE_OK) {
      BindValue(statement, data[1] % 5, data + kHead, length);
      sqlite3_step(statement);
      sqlite3_finalize(statement);
    }
    data += kHead + length;
    size -= kHead + length;
  }
  sqlite3_exec(handle, "COMMIT", nullptr, nullptr, nullptr);
  sqlite3_close(handle);
}

void ReadAll(const ColmapDatabase& database) {
  Accepts([&] { ReadCameras(database); });
  std::vector<DatabaseImage> images;
  Accepts([&] { images = ReadImages(database); });
  for (const DatabaseImage& image : images) {
    Accepts([&] { FeaturesFingerprint(database, image.image_id); });
    Accepts([&] {
      const auto features = ReadFeatures(database, image.image_id);
      FUZZ_REQUIRE(!features || features->points.size() == features->descriptors.size());
    });
  }
  std::vector<ImagePair> pairs;
  Accepts([&] { pairs = ReadVerifiedPairs(database); });
  for (const ImagePair& pair : pairs) {
    Accepts([&] { ReadMatches(database, pair); });
    Accepts([&] { ReadTwoViewGeometry(database, pair); });
    Accepts([&] { HasMatches(database, pair); });
  }
  Accepts([&] { ReadPositionPriors(database); });
  Accepts([&] { ReadLoopPairs(database); });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const std::string whole = MakeDatabase();
  for (const char* suffix : {"-wal", "-shm", "-journal"}) {
    std::filesystem::remove(FuzzFolder() / (std::string("changed.db") + suffix));
  }
  const std::filesystem::path path = WriteFuzzFile("changed.db", whole);
  ChangeRows(path, data, size);
  Accepts([&] { ReadAll(ColmapDatabase(path, ColmapDatabase::Mode::kReadOnly)); });
  Accepts([&] {
    ColmapDatabase database(path, ColmapDatabase::Mode::kReadWrite);
    AddImage(&database, "new.jpg", 1);
    WriteFeatures(&database, 1, Features(), "new");
  });
  return 0;
}
