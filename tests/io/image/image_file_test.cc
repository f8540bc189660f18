#include "colmap_seapoint/io/image/image_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <exiv2/exiv2.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "colmap_seapoint/io/files/content_hash.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

ColorImage MakeColor(int width, int height) {
  ColorImage image(width, height, 3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.At(x, y, 0) = static_cast<uint8_t>(x * 255 / width);
      image.At(x, y, 1) = static_cast<uint8_t>(y * 255 / height);
      image.At(x, y, 2) = static_cast<uint8_t>((x + y) % 64 * 3);
    }
  }
  return image;
}

void AddExif(const std::filesystem::path& path,
             const std::vector<std::pair<std::string, std::string>>& tags) {
  const auto image = Exiv2::ImageFactory::open(path.string());
  image->readMetadata();
  for (const auto& [key, value] : tags) image->exifData()[key] = value;
  image->writeMetadata();
}

// In the namespace that a maker of drones uses.
void AddXmp(const std::filesystem::path& path,
            const std::vector<std::pair<std::string, std::string>>& properties) {
  Exiv2::XmpParser::initialize();
  Exiv2::XmpProperties::registerNs("http://www.dji.com/drone-dji/1.0/", "drone-dji");
  const auto image = Exiv2::ImageFactory::open(path.string());
  image->readMetadata();
  for (const auto& [name, value] : properties) image->xmpData()["Xmp.drone-dji." + name] = value;
  image->writeMetadata();
}

// Of XMP's own namespace for EXIF's tags.
void AddXmpGps(const std::filesystem::path& path, const std::string& latitude,
               const std::string& longitude) {
  Exiv2::XmpParser::initialize();
  const auto image = Exiv2::ImageFactory::open(path.string());
  image->readMetadata();
  image->xmpData()["Xmp.exif.GPSLatitude"] = latitude;
  image->xmpData()["Xmp.exif.GPSLongitude"] = longitude;
  image->xmpData()["Xmp.exif.GPSAltitude"] = "25/2";
  image->xmpData()["Xmp.exif.GPSAltitudeRef"] = "1";
  image->writeMetadata();
}

TEST(PictureFile, HashAndPixelsComeFromTheSameBytes) {
  const TempDir dir;
  const auto path = dir / "a.png";
  WriteImage(path, MakeColor(60, 40));
  const PictureFile file(path);
  const std::string hash = HashFile(path);
  WriteBytes(path, "replaced meanwhile");
  EXPECT_EQ(file.Hash(), hash);
  EXPECT_NE(HashFile(path), hash);
  EXPECT_EQ(file.DecodeColor().data, MakeColor(60, 40).data);
}

TEST(PictureFile, EveryFormatDecodesAgainAndAgain) {
  const TempDir dir;
  for (const char* name : {"a.jpg", "a.png", "a.tif", "a.bmp", "a.ppm", "a.webp"}) {
    WriteImage(dir / name, MakeColor(60, 40));
    const PictureFile file(dir / name);
    EXPECT_EQ(file.Size(), std::filesystem::file_size(dir / name)) << name;
    EXPECT_EQ(file.Hash(), HashFile(dir / name)) << name;
    const GrayImage gray = file.DecodeGray();
    EXPECT_EQ(gray.width, 60) << name;
    EXPECT_EQ(gray.data, file.Decode().luma.data) << name;
    EXPECT_EQ(gray.data, ReadGrayImage(dir / name).data) << name;
    EXPECT_EQ(file.DecodeColor().data, ReadColorImage(dir / name).data) << name;
  }
}

TEST(IsSafeImageName, Table) {
  for (const char* good : {"a.jpg", "dive/a b.jpg", "a..b.jpg", "..a/b.jpg", "ü.png"}) {
    EXPECT_TRUE(IsSafeImageName(good)) << good;
  }
  for (const char* bad :
       {"", "/a.jpg", "../a.jpg", "a/../b.jpg", "a/..", "a//b.jpg", "a/", "a\\b.jpg", "a\nb.jpg"}) {
    EXPECT_FALSE(IsSafeImageName(bad)) << bad;
  }
  EXPECT_FALSE(IsSafeImageName(std::string("a\0b", 3)));
}

TEST(ListImages, SortedBelowAndWithoutHidden) {
  const TempDir dir;
  for (const char* folder : {"b", ".hidden", "b/c"}) {
    std::filesystem::create_directory(dir / folder);
  }
  for (const char* name : {"z.JPG", "b/c/2.tiff", "b/1.png", ".hidden/a.png", "b/.a.png", "a.txt",
                           "a.Jp2", "B.webp"}) {
    WriteBytes(dir / name, "x");
  }
  EXPECT_EQ(ListImages(dir.Path()),
            (std::vector<std::string>{"B.webp", "a.Jp2", "b/1.png", "b/c/2.tiff", "z.JPG"}));
}

TEST(ListImages, FollowsLinksToFoldersOnce) {
  namespace fs = std::filesystem;
  const TempDir dir, other;
  fs::create_directories(dir / "dive/a");
  fs::create_directories(other / "deep");
  WriteBytes(dir / "dive/a/1.png", "x");
  WriteBytes(other / "2.png", "x");
  WriteBytes(other / "deep/3.png", "x");
  fs::create_directory_symlink(other.Path(), dir / "dive/linked");
  fs::create_directory_symlink(other / "deep", dir / "dive/twice");  // read already
  fs::create_directory_symlink(dir / "dive/a", dir / "dive/b");      // inside
  fs::create_directory_symlink("..", dir / "dive/a/up");             // in a circle
  fs::create_directory_symlink(dir.Path(), other / "deep/back");     // in a large one
  fs::create_directory_symlink(dir / "gone", dir / "dive/broken");
  EXPECT_EQ(ListImages(dir / "dive"),
            (std::vector<std::string>{"a/1.png", "linked/2.png", "linked/deep/3.png"}));
}

TEST(ListImages, Errors) {
  const TempDir dir;
  EXPECT_ERROR(ListImages(dir / "missing"), "there is no such folder");
  EXPECT_ERROR(ListImages(dir.Path()), "holds no picture");
  WriteBytes(dir / "a\\b.jpg", "x");
  EXPECT_EQ(ListImages(dir.Path()), std::vector<std::string>{"a\\b.jpg"});  // named by the caller
}

TEST(ReadImageList, SkipsBlanksAndComments) {
  const TempDir dir;
  WriteBytes(dir / "list.txt", "# pictures\n\nb.jpg\r\ndive/a.jpg  \n");
  EXPECT_EQ(ReadImageList(dir / "list.txt"), (std::vector<std::string>{"b.jpg", "dive/a.jpg"}));
  WriteBytes(dir / "bad.txt", "a.jpg\n../b.jpg\n");
  EXPECT_ERROR(ReadImageList(dir / "bad.txt"), "line 2");
  WriteBytes(dir / "empty.txt", "#\n");
  EXPECT_ERROR(ReadImageList(dir / "empty.txt"), "names no picture");
  EXPECT_ERROR(ReadImageList(dir / "missing.txt"), "cannot be read");
}

TEST(Images, LosslessFormatsKeepEveryPixel) {
  const TempDir dir;
  const ColorImage color = MakeColor(37, 23);
  for (const char* name : {"a.png", "a.tif", "a.tiff", "a.bmp", "a.ppm"}) {
    WriteImage(dir / name, color);
    const ColorImage read = ReadColorImage(dir / name);
    EXPECT_EQ(read.width, 37) << name;
    EXPECT_EQ(read.height, 23) << name;
    EXPECT_EQ(read.data, color.data) << name;
    const GrayImage gray = ReadGrayImage(dir / name);
    ASSERT_EQ(gray.channels, 1);
    for (size_t i = 0; i < gray.data.size(); ++i) {
      const double expected =
          0.299 * color.data[3 * i] + 0.587 * color.data[3 * i + 1] + 0.114 * color.data[3 * i + 2];
      ASSERT_NEAR(gray.data[i], expected, 0.51) << name;
    }
  }
  const GrayImage gray = ReadGrayImage(dir / "a.png");
  for (const char* name : {"g.png", "g.tif", "g.bmp", "g.pgm"}) {
    WriteImage(dir / name, gray);
    EXPECT_EQ(ReadGrayImage(dir / name).data, gray.data) << name;
    EXPECT_EQ(ReadColorImage(dir / name).data.size(), color.data.size()) << name;
  }
}

TEST(Images, LossyFormatsAreClose) {
  const TempDir dir;
  const ColorImage color = MakeColor(64, 48);
  for (const char* name : {"a.jpg", "a.webp"}) {
    WriteImage(dir / name, color);
    const ColorImage read = ReadColorImage(dir / name);
    ASSERT_EQ(read.data.size(), color.data.size());
    double sum = 0;
    for (size_t i = 0; i < read.data.size(); ++i) sum += std::abs(read.data[i] - color.data[i]);
    EXPECT_LT(sum / static_cast<double>(read.data.size()), 8) << name;
    const ImageInfo info = ReadImageInfo(dir / name);
    EXPECT_EQ(info.width, 64) << name;
    EXPECT_EQ(info.height, 48) << name;
  }
  // The luma of a JPEG is the grey of its colours, rounding apart.
  const ColorImage jpeg = ReadColorImage(dir / "a.jpg");
  const GrayImage gray = ReadGrayImage(dir / "a.jpg");
  double sum = 0;
  for (size_t i = 0; i < gray.data.size(); ++i) {
    sum += std::abs(gray.data[i] - (0.299 * jpeg.data[3 * i] + 0.587 * jpeg.data[3 * i + 1] +
                                    0.114 * jpeg.data[3 * i + 2]));
  }
  EXPECT_LT(sum / static_cast<double>(gray.data.size()), 1.0);
}

TEST(Images, SixteenBitsAndAlpha) {
  const TempDir dir;
  cv::Mat deep(2, 3, CV_16UC1);
  for (int i = 0; i < 6; ++i) deep.at<uint16_t>(i / 3, i % 3) = static_cast<uint16_t>(i * 257 * 50);
  for (const char* name : {"deep.png", "deep.tif", "deep.pgm"}) {
    ASSERT_TRUE(cv::imwrite((dir / name).string(), deep));
    const GrayImage gray = ReadGrayImage(dir / name);
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(gray.At(i % 3, i / 3), i * 50, 1) << name;
  }
  const cv::Mat alpha(2, 3, CV_8UC4, cv::Scalar(10, 20, 30, 255));
  for (const char* name : {"alpha.png", "alpha.tif"}) {
    ASSERT_TRUE(cv::imwrite((dir / name).string(), alpha));
    const ColorImage color = ReadColorImage(dir / name);
    ASSERT_EQ(color.channels, 3);
    EXPECT_EQ(color.At(2, 1, 0), 30);
    EXPECT_EQ(color.At(2, 1, 2), 10);
  }
}

TEST(ImageInfo, CameraAsExifHasIt) {
  const TempDir dir;
  WriteImage(dir / "a.jpg", MakeColor(400, 300));
  const ImageInfo plain = ReadImageInfo(dir / "a.jpg");
  EXPECT_EQ(plain.width, 400);
  EXPECT_EQ(plain.height, 300);
  EXPECT_EQ(plain.exif_orientation, 1);
  EXPECT_EQ(plain.camera.maker, "");
  EXPECT_EQ(plain.camera.focal_mm, 0);

  AddExif(dir / "a.jpg", {{"Exif.Image.Make", "Sea "},
                          {"Exif.Image.Model", "Eye"},
                          {"Exif.Photo.LensModel", "17 mm"},
                          {"Exif.Photo.BodySerialNumber", "A1234"},
                          {"Exif.Photo.FocalLength", "80/10"},
                          {"Exif.Photo.FocalLengthIn35mmFilm", "28"},
                          {"Exif.Photo.DigitalZoomRatio", "3/2"},
                          {"Exif.Photo.PixelXDimension", "4000"},
                          {"Exif.Photo.PixelYDimension", "3000"},
                          {"Exif.Photo.FocalPlaneXResolution", "4000/8"},
                          {"Exif.Photo.FocalPlaneResolutionUnit", "3"}});
  const ExifCamera camera = ReadImageInfo(dir / "a.jpg").camera;
  EXPECT_EQ(camera.maker, "Sea");
  EXPECT_EQ(camera.model, "Eye");
  EXPECT_EQ(camera.lens, "17 mm");
  EXPECT_EQ(camera.serial, "A1234");
  EXPECT_EQ(camera.focal_mm, 8);
  EXPECT_EQ(camera.focal_35mm, 28);
  EXPECT_EQ(camera.digital_zoom, 1.5);
  EXPECT_EQ(camera.taken_width, 4000);
  EXPECT_EQ(camera.taken_height, 3000);
  EXPECT_EQ(camera.pixels_per_mm, 50);
}

TEST(ImageInfo, WhatExifCannotMeanIsNothing) {
  const TempDir dir;
  WriteImage(dir / "a.jpg", MakeColor(400, 300));
  AddExif(dir / "a.jpg", {{"Exif.Photo.FocalLength", "8/0"},
                          {"Exif.Photo.FocalLengthIn35mmFilm", "0"},
                          {"Exif.Photo.DigitalZoomRatio", "0/0"},
                          {"Exif.Photo.PixelXDimension", "0"},
                          {"Exif.Photo.FocalPlaneXResolution", "4000/8"},
                          {"Exif.Photo.FocalPlaneResolutionUnit", "1"}});
  const ExifCamera camera = ReadImageInfo(dir / "a.jpg").camera;
  EXPECT_EQ(camera.focal_mm, 0);
  EXPECT_EQ(camera.focal_35mm, 0);
  EXPECT_EQ(camera.digital_zoom, 0);
  EXPECT_EQ(camera.taken_width, 0);
  EXPECT_EQ(camera.pixels_per_mm, 0);
}

TEST(ImageInfo, GpsPosition) {
  const TempDir dir;
  WriteImage(dir / "a.jpg", MakeColor(40, 30));
  EXPECT_FALSE(ReadImageInfo(dir / "a.jpg").gps);
  AddExif(dir / "a.jpg", {{"Exif.GPSInfo.GPSLatitude", "43/1 30/1 3600/100"},
                          {"Exif.GPSInfo.GPSLatitudeRef", "N"}});
  EXPECT_FALSE(ReadImageInfo(dir / "a.jpg").gps);
  AddExif(dir / "a.jpg",
          {{"Exif.GPSInfo.GPSLongitude", "5/1 15/1 0/1"}, {"Exif.GPSInfo.GPSLongitudeRef", "E"}});
  auto gps = ReadImageInfo(dir / "a.jpg").gps;
  ASSERT_TRUE(gps);
  EXPECT_NEAR(gps->latitude_deg, 43.51, 1e-9);
  EXPECT_NEAR(gps->longitude_deg, 5.25, 1e-9);
  EXPECT_EQ(gps->altitude_m, 0);
  AddExif(dir / "a.jpg", {{"Exif.GPSInfo.GPSLatitudeRef", "S"},
                          {"Exif.GPSInfo.GPSLongitudeRef", "W"},
                          {"Exif.GPSInfo.GPSAltitude", "125/10"},
                          {"Exif.GPSInfo.GPSAltitudeRef", "1"}});
  gps = ReadImageInfo(dir / "a.jpg").gps;
  ASSERT_TRUE(gps);
  EXPECT_NEAR(gps->latitude_deg, -43.51, 1e-9);
  EXPECT_NEAR(gps->longitude_deg, -5.25, 1e-9);
  EXPECT_NEAR(gps->altitude_m, -12.5, 1e-9);
  AddExif(dir / "a.jpg", {{"Exif.GPSInfo.GPSLatitude", "95/1 0/1 0/1"}});
  EXPECT_FALSE(ReadImageInfo(dir / "a.jpg").gps);
}

TEST(ImageInfo, HeightsAndTime) {
  const TempDir dir;
  WriteImage(dir / "a.jpg", MakeColor(40, 30));
  ImageInfo info = ReadImageInfo(dir / "a.jpg");
  EXPECT_FALSE(info.heights.depth || info.heights.altitude || info.heights.above_start);
  EXPECT_EQ(info.taken, "");
  AddXmp(dir / "a.jpg", {{"AbsoluteAltitude", "+198.31"}, {"RelativeAltitude", "+39.80 m"}});
  info = ReadImageInfo(dir / "a.jpg");
  EXPECT_EQ(info.heights.altitude, 198.31);
  EXPECT_EQ(info.heights.above_start, 39.8);
  EXPECT_FALSE(info.heights.depth);
  AddXmp(dir / "a.jpg", {{"Depth", "25/2"}});
  AddExif(dir / "a.jpg", {{"Exif.GPSInfo.GPSAltitude", "125/10"},
                          {"Exif.GPSInfo.GPSAltitudeRef", "1"},
                          {"Exif.Photo.DateTimeOriginal", "2024:05:01 12:00:00"}});
  info = ReadImageInfo(dir / "a.jpg");
  EXPECT_EQ(info.heights.depth, 12.5);
  EXPECT_EQ(info.heights.altitude, -12.5);
  EXPECT_EQ(info.taken, "2024:05:01 12:00:00");
  AddExif(dir / "a.jpg", {{"Exif.Photo.SubSecTimeOriginal", "25"}});
  EXPECT_EQ(ReadImageInfo(dir / "a.jpg").taken, "2024:05:01 12:00:00.25");
}

TEST(ImageInfo, APositionInXmpAlone) {
  const TempDir dir;
  WriteImage(dir / "a.jpg", MakeColor(40, 30));
  AddXmpGps(dir / "a.jpg", "43,30.6S", "5,15,0W");
  auto gps = ReadImageInfo(dir / "a.jpg").gps;
  ASSERT_TRUE(gps);
  EXPECT_NEAR(gps->latitude_deg, -43.51, 1e-9);
  EXPECT_NEAR(gps->longitude_deg, -5.25, 1e-9);
  EXPECT_NEAR(gps->altitude_m, -12.5, 1e-9);
  AddXmpGps(dir / "a.jpg", "43,30,36N", "5,15.3E");
  gps = ReadImageInfo(dir / "a.jpg").gps;
  EXPECT_NEAR(gps->latitude_deg, 43.51, 1e-9);
  EXPECT_NEAR(gps->longitude_deg, 5.255, 1e-9);
  AddXmpGps(dir / "a.jpg", "95,0,0N", "5,15,0E");
  EXPECT_FALSE(ReadImageInfo(dir / "a.jpg").gps);
  AddXmpGps(dir / "a.jpg", "north", "");
  EXPECT_FALSE(ReadImageInfo(dir / "a.jpg").gps);
  WriteImage(dir / "b.jpg", MakeColor(40, 30));
  AddXmp(dir / "b.jpg",
         {{"GpsLatitude", "+43.51"}, {"GpsLongtitude", "-5.25"}, {"WaterDepth", "12.5"}});
  const ImageInfo info = ReadImageInfo(dir / "b.jpg");
  ASSERT_TRUE(info.gps);
  EXPECT_NEAR(info.gps->latitude_deg, 43.51, 1e-9);
  EXPECT_NEAR(info.gps->longitude_deg, -5.25, 1e-9);
  EXPECT_EQ(info.heights.depth, 12.5);
  // EXIF's own comes first.
  AddExif(dir / "b.jpg", {{"Exif.GPSInfo.GPSLatitude", "10/1 0/1 0/1"},
                          {"Exif.GPSInfo.GPSLongitude", "20/1 0/1 0/1"}});
  EXPECT_NEAR(ReadImageInfo(dir / "b.jpg").gps->latitude_deg, 10, 1e-9);
}

TEST(ImageInfo, OrientationIsToldButNotApplied) {
  const TempDir dir;
  for (const char* name : {"a.jpg", "a.tif", "a.png"}) {
    WriteImage(dir / name, MakeColor(40, 20));
    const auto before = ReadColorImage(dir / name).data;
    AddExif(dir / name, {{"Exif.Image.Orientation", "6"}});
    const ImageInfo info = ReadImageInfo(dir / name);
    EXPECT_EQ(info.exif_orientation, 6) << name;
    EXPECT_EQ(info.width, 40) << name;
    const ColorImage after = ReadColorImage(dir / name);
    EXPECT_EQ(after.width, 40) << name;
    EXPECT_EQ(after.data, before) << name;
    EXPECT_EQ(ReadGrayImage(dir / name).width, 40) << name;
  }
}

TEST(WriteImage, Errors) {
  const TempDir dir;
  EXPECT_ERROR(WriteImage(dir / "a.xyz", MakeColor(4, 4)), "use png, jpg or tif");
  EXPECT_ERROR(WriteImage(dir / "missing/a.png", MakeColor(4, 4)), "cannot be created");
}

TEST(Images, RealPicturesDecodeWhole) {
  const auto data = DataDir();
  if (!std::filesystem::is_directory(data)) GTEST_SKIP() << "no folder " << data;
  int num_pictures = 0;
  for (const char* folder : {"auv_strips/t1/images", "skerki28/images", "haltbrekken11/images",
                             "banana/images", "temple16/images"}) {
    if (!std::filesystem::is_directory(data / folder)) continue;
    const auto names = ListImages(data / folder);
    for (const std::string& name : {names.front(), names.back()}) {
      const ImageInfo info = ReadImageInfo(data / folder / name);
      const GrayImage gray = ReadGrayImage(data / folder / name);
      EXPECT_EQ(info.width, gray.width) << name;
      EXPECT_EQ(info.height, gray.height) << name;
      const cv::Mat oracle = cv::imread((data / folder / name).string(),
                                        cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
      ASSERT_EQ(oracle.total(), gray.data.size());
      const cv::Mat ours(gray.height, gray.width, CV_8UC1, const_cast<uint8_t*>(gray.Row(0)));
      EXPECT_LE(cv::norm(oracle, ours, cv::NORM_INF), 2) << name;
      ++num_pictures;
    }
  }
  EXPECT_GT(num_pictures, 0);
}

}  // namespace
}  // namespace colmap_seapoint
