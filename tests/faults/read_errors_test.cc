// A disk that fails to give a file: never the file's end, never the file's fault.
#include <exiv2/exiv2.hpp>

#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/faults/fault_injector.h"
#include "tests/faults/faults_fixture.h"

namespace colmap_seapoint {
namespace {

constexpr char kSaid[] = "Input/output error";

constexpr int kAlways = 1 << 30;

CliOptions FailingFrom(const std::string& path_end, int64_t offset = 0, int times = kAlways) {
  CliOptions options;
  options.fault.emplace();
  options.fault->path_end = path_end;
  options.fault->from_offset = offset;
  options.fault->max_hits = times;
  return options;
}

class ReadErrors : public Faults {
 protected:
  void SetUp() override {
    if (!CanInjectFaults()) GTEST_SKIP() << "this system answers no calls for others";
    Faults::SetUp();
  }

  // The command must fail, having met the failure, and say what the system said.
  void ExpectSaid(const Arguments& arguments, const std::string& path_end, int64_t offset = 0) {
    const CliResult result = Run(arguments, FailingFrom(path_end, offset));
    EXPECT_GT(result.faults.num_hits, 0) << path_end;
    ExpectFailure(result, kSaid);
    EXPECT_NE(result.LastErrorLine().find(path_end), std::string::npos) << result.Text();
  }
};

TEST_F(ReadErrors, ListsAndProjectFiles) {
  std::string names;
  while (names.size() < 100000) names += "# a comment that fills the list up\nimg1.png\n";
  WriteBytes(folder_ / "list.txt", "img1.png\nimg2.png\n" + names + "img3.png\n");
  const Arguments listed = {"feature_extractor", "--database_path", Path("d.db"),
                            "--image_path",      Path("images"),    "--image_list_path",
                            Path("list.txt")};
  ExpectSaid(listed, "/list.txt");
  ExpectSaid(listed, "/list.txt", 1);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "d.db"));
  std::string comments;
  while (comments.size() < 100000) comments += "# a comment that fills the file up\n";
  WriteBytes(folder_ / "p.ini", comments + "random_seed = 5\n");
  for (const int64_t offset : {0, 1}) {
    const CliResult result =
        Run(Extract(), FailingFrom("/p.ini", offset), {"--project_path", Path("p.ini")});
    EXPECT_GT(result.faults.num_hits, 0);
    ExpectFailure(result, kSaid);
  }
}

TEST_F(ReadErrors, CloudsAndWhatLiesBesideThem) {
  ASSERT_EQ(Run(Densify()).exit_code, 0);
  WriteBytes(folder_ / "positions.csv",
             "image,x,y,z\nimg1.png,0,0,0\nimg2.png,1,0,0\nimg3.png,2,0.1,0\n");
  const Arguments scale = {"model_scaler",          "--input_path",     Path("model"),
                           "--output_path",         Path("scaled"),     "--cloud_path",
                           Path("dense/fused.ply"), "--positions_path", Path("positions.csv")};
  const CliResult whole = Run(scale);
  ExpectSaid(scale, "/fused.ply.vis");
  ExpectSaid(scale, "/fused.ply.vis", 1);
  ExpectSaid(scale, "/fused.ply", 1);
  ExpectSaid(scale, "/positions.csv");
  ExpectSaid(scale, "/points3D.bin");
  ExpectSaid(scale, "/images.bin");
  ExpectSaid({"cloud_comparer", "--input_path", Path("dense/fused.ply"), "--reference_path",
              Path("dense/fused.ply"), "--output_path", Path("c.json")},
             "/fused.ply", 1);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "c.json"));
  EXPECT_EQ(whole.exit_code, 0) << whole.Text();
}

TEST_F(ReadErrors, TheFacesOfAMesh) {
  std::string mesh =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 20000\nproperty list uchar int vertex_indices\n"
      "end_header\n0 0 0\n1 0 0\n0 1 0\n";
  for (int i = 0; i < 20000; ++i) mesh += "3 0 1 2\n";
  WriteBytes(folder_ / "mesh.ply", mesh);
  WriteBytes(folder_ / "positions.csv",
             "image,x,y,z\nimg1.png,0,0,0\nimg2.png,1,0,0\nimg3.png,2,0.1,0\n");
  ExpectSaid({"model_scaler", "--input_path", Path("model"), "--output_path", Path("scaled"),
              "--cloud_path", Path("mesh.ply"), "--positions_path", Path("positions.csv")},
             "/mesh.ply", 100000);
}

TEST_F(ReadErrors, APictureIsNeitherEmptyNorDamaged) {
  for (const int64_t offset : {0, 1}) {
    const CliResult result =
        Run(Extract("d" + std::to_string(offset) + ".db"), FailingFrom("/img2.png", offset));
    EXPECT_GT(result.faults.num_hits, 0);
    EXPECT_EQ(result.exit_code, 3) << result.Text();
    EXPECT_NE(result.err.find(std::string("img2.png is left out: cannot be read (") + kSaid),
              std::string::npos)
        << result.Text();
  }
}

TEST_F(ReadErrors, AHealthyDatabaseIsNotToBeDeleted) {
  ASSERT_EQ(Run(Extract()).exit_code, 0);
  constexpr int64_t kPage = 4096;
  const auto num_pages = static_cast<int64_t>(std::filesystem::file_size(folder_ / "d.db")) / kPage;
  ASSERT_GT(num_pages, 30);
  for (const int times : {1, kAlways}) {
    for (int64_t page = 0; page < num_pages; page += 5) {
      const CliResult result = Run(Match(), FailingFrom("/d.db", page * kPage, times));
      EXPECT_GT(result.faults.num_hits, 0);
      ExpectFailure(result, "disk");
      EXPECT_EQ(result.err.find("delete"), std::string::npos) << page << ": " << result.Text();
    }
  }
  EXPECT_EQ(Run(Match()).exit_code, 0);
}

// It fails while the cloud is made, not before: the next run must not take that cloud for finished.
TEST_F(ReadErrors, ACloudWithoutAPictureIsNotFinished) {
  CliOptions options = FailingFrom("/img2.png", 0, 0);
  const CliResult whole = Run(Reconstruct("whole"), options);
  ASSERT_EQ(whole.exit_code, 0) << whole.Text();
  const std::string cloud = ReadBytes(Path("whole/dense/0/fused.ply"));
  options.fault->max_hits = kAlways;
  int num_failed_late = 0;
  for (const double share : {0.6, 0.75, 0.9}) {
    options.fault->num_calls_before = static_cast<int>(share * whole.faults.num_calls);
    const std::string name = "ws" + std::to_string(options.fault->num_calls_before);
    num_failed_late += Run(Reconstruct(name), options).exit_code != 0;
    const CliResult again = Run(Reconstruct(name));
    EXPECT_EQ(again.exit_code, 0) << again.Text();
    EXPECT_TRUE(ReadBytes(Path(name + "/dense/0/fused.ply")) == cloud) << share;
  }
  EXPECT_GT(num_failed_late, 0);
}

// Where the disk fails once, when the EXIF is read, the lens must not be another one afterwards.
TEST_F(ReadErrors, TheFocalLengthIsNotLost) {
  const std::string path = Path("images/img1.jpg");
  WriteImage(path, StripPicture(1));
  {
    const auto image = Exiv2::ImageFactory::open(path);
    Exiv2::ExifData exif;
    exif["Exif.Photo.FocalLengthIn35mmFilm"] = uint16_t{50};
    image->setExifData(exif);
    image->writeMetadata();
  }
  const double width = kStripWidth;
  for (int num_reads_before = 0; num_reads_before < 6; ++num_reads_before) {
    CliOptions options = FailingFrom("/img1.jpg", 0, 1);
    options.fault->num_calls_before = num_reads_before;
    const std::string database = "d" + std::to_string(num_reads_before) + ".db";
    const CliResult result = Run(Extract(database), options);
    EXPECT_EQ(result.faults.num_hits, 1) << num_reads_before;
    if (result.exit_code == 3) {
      EXPECT_NE(result.err.find("img1.jpg is left out: cannot be read"), std::string::npos);
      continue;
    }
    EXPECT_EQ(result.exit_code, 0) << result.Text();
    const ColmapDatabase read(folder_ / database, ColmapDatabase::Mode::kReadOnly);
    double focal = 0;
    for (const auto& [id, camera] : ReadCameras(read)) {
      if (camera.has_prior_focal_length) focal = camera.FocalX();
    }
    EXPECT_NEAR(focal, 50.0 / 35.0 * width, 1e-6) << num_reads_before;
  }
}

}  // namespace
}  // namespace colmap_seapoint
