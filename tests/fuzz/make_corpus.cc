// Makes the inputs that the fuzz targets of parsers begin with: make_corpus FOLDER
// A folder a target, small files of every form that it reads; all of it synthetic.
#include <cstdio>
#include <exiv2/exiv2.hpp>

#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/model_units.h"
#include "colmap_seapoint/io/files/run_report_json.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/workspace/stage_runner.h"
#include "tests/fuzz/fuzz_files.h"

using namespace colmap_seapoint;
namespace fs = std::filesystem;

namespace {

std::string Read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void Write(const fs::path& path, const std::string& bytes) {
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << bytes;
}

void MakePictures(const fs::path& folder) {
  fs::create_directories(folder);
  for (const int num_channels : {1, 3}) {
    ColorImage picture(19, 13, num_channels);
    for (size_t i = 0; i < picture.data.size(); ++i) {
      picture.data[i] = static_cast<uint8_t>(i * 37 % 251);
    }
    for (const char* extension :
         {"jpg", "png", "tif", "bmp", "webp", num_channels == 1 ? "pgm" : "ppm"}) {
      WriteImage(folder / ("picture" + std::to_string(num_channels) + "." + extension), picture);
    }
  }
}

void MakeExif(const fs::path& folder) {
  Exiv2::ExifData exif;
  exif["Exif.Image.Make"] = "Maker";
  exif["Exif.Image.Model"] = "Camera 7";
  exif["Exif.Image.Orientation"] = uint16_t{6};
  exif["Exif.Photo.FocalLength"] = Exiv2::Rational(35, 10);
  exif["Exif.Photo.FocalLengthIn35mmFilm"] = uint16_t{28};
  exif["Exif.Photo.FocalPlaneXResolution"] = Exiv2::Rational(4000, 1);
  exif["Exif.Photo.FocalPlaneResolutionUnit"] = uint16_t{2};
  exif["Exif.GPSInfo.GPSLatitudeRef"] = "S";
  exif["Exif.GPSInfo.GPSLatitude"] = "33/1 51/1 3000/100";
  exif["Exif.GPSInfo.GPSLongitudeRef"] = "E";
  exif["Exif.GPSInfo.GPSLongitude"] = "151/1 12/1 1000/100";
  exif["Exif.GPSInfo.GPSAltitude"] = Exiv2::Rational(125, 10);
  for (const auto order : {Exiv2::littleEndian, Exiv2::bigEndian}) {
    Exiv2::Blob blob;
    Exiv2::ExifParser::encode(blob, order, exif);
    Write(folder / (order == Exiv2::littleEndian ? "little" : "big"),
          {reinterpret_cast<const char*>(blob.data()), blob.size()});
  }
}

SparseModel SmallModel() {
  SparseModel model;
  for (const uint32_t id : {1u, 2u}) {
    Camera camera =
        MakeCamera(id == 1 ? CameraModel::kOpenCV : CameraModel::kPinhole, 500, 640, 480);
    camera.camera_id = id;
    model.cameras[id] = camera;
    PosedImage image;
    image.image_id = id;
    image.camera_id = id;
    image.name = id == 1 ? "a.jpg" : "left/b c.png";
    image.cam_from_world.translation = {0.5 * id, 0, 0};
    model.images.push_back(image);
  }
  for (uint64_t id = 1; id <= 3; ++id) {
    SparsePoint point;
    point.xyz = {0.1 * static_cast<double>(id), 0.2, 3};
    for (PosedImage& image : model.images) {
      point.track.push_back({image.image_id, static_cast<uint32_t>(image.points2D.size())});
      image.points2D.emplace_back(320.5, 100.25 + static_cast<double>(id));
      image.point3D_ids.push_back(id);
    }
    model.points3D[id] = point;
  }
  return model;
}

std::string Joined(const fs::path& folder, const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names)
    text += (text.empty() ? "" : kNextFile) + Read(folder / name);
  return text;
}

void MakeModels(const fs::path& corpus) {
  const fs::path folder = FuzzFolder() / "model";
  WriteSparseModelBinary(folder, SmallModel());
  WriteSparseModelText(folder, SmallModel());
  Write(corpus / "model_bin/model", Joined(folder, {"cameras.bin", "images.bin", "points3D.bin"}));
  const std::string rigs =
      "# RIG_ID NUM_SENSORS REF_SENSOR ... SENSORS\n1 2 CAMERA 1 CAMERA 2 1 1 0 0 0 0.1 0 0\n";
  const std::string frames = "1 1 1 0 0 0 0 0 0 2 CAMERA 1 1 CAMERA 2 2\n";
  const std::string text = Joined(folder, {"cameras.txt", "images.txt", "points3D.txt"});
  Write(corpus / "model_txt/model", text);
  Write(corpus / "model_txt/rig", text + kNextFile + rigs + kNextFile + frames);
}

void MakeClouds(const fs::path& folder) {
  const fs::path cloud = FuzzFolder() / "cloud.ply";
  CloudWriter writer(cloud);
  const uint32_t seen_by[] = {0, 1};
  for (int i = 0; i < 5; ++i) writer.Add({{0.5f * static_cast<float>(i), 1, 2}}, seen_by, 2);
  writer.Finish();
  Write(folder / "colmap", Read(cloud));
  Write(folder / "ascii",
        "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 3\nproperty double x\n"
        "property double y\nproperty double z\nproperty uchar red\nelement face 1\n"
        "property list uchar int vertex_indices\nend_header\n0 0 0 1\n1 0 1e3 2\n0 -1 .5 255\n3 0 "
        "1 2\n");
  Write(folder / "big_endian",
        "ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
        "property float z\nproperty list uchar ushort more\nend_header\n" +
            std::string("\x3f\x80\0\0\x40\0\0\0\x40\x40\0\0\x02\0\x01\0\x02", 17));
}

void MakeTables(const fs::path& folder) {
  Write(folder / "positions", "image,x,y,z,sigma\na.jpg,0,0,0,1\n\"b, c.jpg\",1.5,-2,1e2,0.5\n");
  Write(folder / "geographic", "# log\nimage,lat,lon,depth\r\na.jpg,-33.85,151.2,12.5\r\n");
  Write(folder / "bars", "name1,name2,length_m,sigma_m\nA,B,0.5,0.001\npoint:7,point:12,1,0.01\n");
  Write(folder / "targets", "target,image,x,y\nA,a.jpg,10.5,20\nA,left/b.jpg,11,21.25\n");
  Write(folder / "list", "# pictures\na.jpg\n\nleft/b c.png\n");
}

void MakeStates(const fs::path& corpus) {
  Write(corpus / "ini/project",
        "image_path = pictures\nworkspace_path=ws\nrandom_seed = 5\n\n[SeaPointExtraction]\n"
        "max_num_features=400 # few\n[Mapper]\nmin_model_size=3\n[PartialDensification]\n"
        "mode=partial\nmax_overlap = 0.5\n");
  const fs::path folder = FuzzFolder() / "workspace";
  {
    WorkspaceState state(folder, {"output"});
    Write(folder / "output", "12345");
    RunReport report;
    report.version = "1";
    report.command = "partial_densifier";
    report.left_out = {{"a.jpg", "is empty"}};
    report.stages = {{"dense", 1.5, 2}};
    report.inputs = {{"b.jpg", 100, "00ff"}};
    FinishStage({"stage", "1", "inputs", ""}, report, {folder / "output"}, &state);
  }
  ModelUnits units;
  units.is_metric = true;
  units.frame = "east-north-up";
  units.origin = GeoPosition{43.1, 5.9, 0};
  WriteModelUnits(folder, units);
  Write(corpus / "state/stage",
        Joined(folder, {"state/stage.json", "units.json", ".colmap_seapoint"}));
}

// A change a file: see database_fuzz.cc.
void MakeChanges(const fs::path& folder) {
  const auto change = [&](const std::string& name, int column, int type, const std::string& bytes) {
    Write(folder / name, std::string{static_cast<char>(column), static_cast<char>(type), '\1',
                                     static_cast<char>(bytes.size())} +
                             bytes);
  };
  change("camera_model", 1, 1, std::string("\x63\0\0\0\0\0\0\0", 8));
  change("camera_params", 4, 4, std::string(24, '\x7f'));
  change("image_name", 7, 3, "../../outside.jpg");
  change("keypoints_rows", 11, 1, std::string("\xff\xff\xff\x7f\0\0\0\0", 8));
  change("keypoints_data", 13, 4, std::string(80, '\x7f'));
  change("matches_data", 20, 4, std::string(32, '\x40'));
  change("pair_id", 17, 1, std::string(8, '\xff'));
  change("geometry_F", 26, 4, std::string(72, '\x7f'));
  change("geometry_config", 25, 0, "");
  change("descriptors", 31, 4, std::string(160, 'd'));
  change("loop_pairs", 35, 4, std::string(7, 'l'));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
    return 2;
  }
  const fs::path corpus = argv[1];
  MakePictures(corpus / "picture");
  MakeExif(corpus / "exif");
  MakeModels(corpus);
  MakeClouds(corpus / "ply");
  MakeTables(corpus / "csv");
  MakeStates(corpus);
  MakeChanges(corpus / "database");
  return 0;
}
