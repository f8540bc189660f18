#include "colmap_seapoint/io/raster/raster_writer.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/io/raster/raster_reader.h"
#include "colmap_seapoint/io/raster/world_file.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr double kNoHeight = -9999;

RasterLayout SmallLayout(RasterBands bands, int width = 1300, int height = 700) {
  RasterLayout layout;
  layout.bands = bands;
  layout.width = width;
  layout.height = height;
  layout.tile_size = 256;
  layout.min_x = 500000.25;
  layout.max_y = 7800000.5;
  layout.pixel_size = 0.01;
  layout.crs = "EPSG:32755";
  return layout;
}

// Exact in a float.
float HeightAt(int x, int y) { return 0.125f * static_cast<float>((x * 7 + y * 3) % 4096) - 100; }

FloatImage HeightTile(const RasterWindow& window) {
  FloatImage tile(window.width, window.height);
  for (int y = 0; y < window.height; ++y) {
    for (int x = 0; x < window.width; ++x) tile.At(x, y) = HeightAt(window.x + x, window.y + y);
  }
  return tile;
}

std::vector<int> TileOrder(const RasterLayout& layout, uint32_t seed) {
  std::vector<int> order(static_cast<size_t>(NumTileColumns(layout) * NumTileRows(layout)));
  for (size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  if (seed > 0) std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  return order;
}

void WriteHeights(const fs::path& path, const RasterLayout& layout, uint32_t seed = 0,
                  const RasterWriterOptions& options = {}, int num_threads = 1) {
  RasterWriter writer(path, layout, options);
  const std::vector<int> order = TileOrder(layout, seed);
  ParallelFor(num_threads, static_cast<int64_t>(order.size()), [&](int64_t i) {
    const int tile = order[static_cast<size_t>(i)];
    const int column = tile % NumTileColumns(layout), row = tile / NumTileColumns(layout);
    writer.WriteTile(column, row, HeightTile(TileWindow(layout, column, row)));
  });
  writer.Finish();
}

void ExpectHeights(const fs::path& path, const RasterLayout& layout) {
  const RasterReader reader(path);
  ASSERT_EQ(reader.Layout().width, layout.width);
  ASSERT_EQ(reader.Layout().height, layout.height);
  const FloatImage heights = reader.ReadHeights(0, layout.height);
  int num_wrong = 0;
  for (int y = 0; y < layout.height; ++y) {
    for (int x = 0; x < layout.width; ++x) num_wrong += heights.At(x, y) == HeightAt(x, y) ? 0 : 1;
  }
  EXPECT_EQ(num_wrong, 0);
}

std::vector<std::string> FilesIn(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_directory()) names.push_back(fs::relative(entry.path(), folder).generic_string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> Sorted(std::vector<std::string> names) {
  std::sort(names.begin(), names.end());
  return names;
}

// What GDAL's own program says of the file; "" when it is not installed.
std::string GdalInfo(const fs::path& path) {
  if (std::system("command -v gdalinfo >/dev/null 2>&1") != 0) return "";
  const std::string out = path.string() + ".info";
  EXPECT_EQ(std::system(("gdalinfo " + path.string() + " >" + out + " 2>&1").c_str()), 0);
  const std::string text = ReadBytes(out);
  fs::remove(out);
  return text;
}

TEST(RasterWriter, HeightsComeBackExactlyWithTheirPlace) {
  const TempDir dir;
  RasterLayout layout = SmallLayout(RasterBands::kFloat32);
  layout.nodata = kNoHeight;
  layout.unit = "metre";
  layout.metadata = {{"HEIGHT_OFFSET", "-12.5"}};
  WriteHeights(dir / "dem.tif", layout);
  ExpectHeights(dir / "dem.tif", layout);
  const RasterReader reader(dir / "dem.tif");
  EXPECT_EQ(reader.Layout().bands, RasterBands::kFloat32);
  EXPECT_DOUBLE_EQ(reader.Layout().min_x, layout.min_x);
  EXPECT_DOUBLE_EQ(reader.Layout().max_y, layout.max_y);
  EXPECT_DOUBLE_EQ(reader.Layout().pixel_size, layout.pixel_size);
  EXPECT_EQ(reader.Layout().unit, "metre");
  EXPECT_NE(reader.Layout().crs.find("32755"), std::string::npos);
  EXPECT_EQ(reader.Layout().nodata, kNoHeight);
  EXPECT_EQ(FilesIn(dir.Path()), std::vector<std::string>{"dem.tif"});
}

// The validator that GDAL's authors publish, where it is installed (python3-gdal).
void ExpectValidCog(const fs::path& path) {
  const std::string validator =
      "/usr/bin/python3 -m osgeo_utils.samples.validate_cloud_optimized_geotiff ";
  if (std::system((validator + "--help >/dev/null 2>&1").c_str()) != 0) return;
  EXPECT_EQ(std::system((validator + path.string() + " >/dev/null 2>&1").c_str()), 0) << path;
}

TEST(RasterWriter, ForeignProgramSeesCogCrsOverviewsAndMetadata) {
  const TempDir dir;
  RasterLayout layout = SmallLayout(RasterBands::kFloat32);
  layout.nodata = kNoHeight;
  layout.metadata = {{"HEIGHT_OFFSET", "-12.5"}};
  WriteHeights(dir / "dem.tif", layout);
  ExpectValidCog(dir / "dem.tif");
  const std::string info = GdalInfo(dir / "dem.tif");
  if (info.empty()) GTEST_SKIP() << "gdalinfo is not installed";
  for (const char* part : {"LAYOUT=COG", "COMPRESSION=DEFLATE", "32755", "HEIGHT_OFFSET=-12.5",
                           "NoData Value=-9999", "Overviews: 650x350, 325x175", "Block=512x512",
                           "Origin = (500000.25", "Pixel Size = (0.01"}) {
    EXPECT_NE(info.find(part), std::string::npos) << part << "\n" << info;
  }
}

TEST(RasterWriter, ColorsAreFourBandsWithAlphaAndAveragedWithoutTheTransparent) {
  const TempDir dir;
  const RasterLayout layout = SmallLayout(RasterBands::kRgba8, 1024, 1024);
  RasterWriter writer(dir / "map.tif", layout);
  // Every second column is transparent black, the rest opaque: averages must stay 200, 100, 50.
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      Image<uint8_t> tile(256, 256, 4);
      for (int y = 0; y < 256; ++y) {
        for (int x = 0; x < 256; x += 2) {
          const uint8_t color[] = {200, 100, 50, 255};
          std::copy_n(color, 4, &tile.At(x, y, 0));
        }
      }
      if (column == 3) tile = Image<uint8_t>(256, 256, 4);
      writer.WriteTile(column, row, tile);
    }
  }
  writer.Finish();
  const RasterReader reader(dir / "map.tif");
  EXPECT_EQ(reader.Layout().bands, RasterBands::kRgba8);
  const Image<uint8_t> half = reader.ReadColors(512, 512);
  EXPECT_EQ(half.At(10, 10, 0), 200);
  EXPECT_EQ(half.At(10, 10, 1), 100);
  EXPECT_EQ(half.At(10, 10, 2), 50);
  EXPECT_EQ(half.At(10, 10, 3), 255);  // where anything is, an overview shows it
  EXPECT_EQ(half.At(500, 10, 3), 0);
  const std::string info = GdalInfo(dir / "map.tif");
  if (info.empty()) return;
  EXPECT_NE(info.find("ColorInterp=Alpha"), std::string::npos) << info;
  EXPECT_NE(info.find("INTERLEAVE=PIXEL"), std::string::npos) << info;
}

TEST(RasterWriter, LabelsAreNeverMixedInOverviews) {
  const TempDir dir;
  const RasterLayout layout = SmallLayout(RasterBands::kUint32, 1024, 600);
  RasterWriter writer(dir / "source.tif", layout);
  for (int row = 0; row < NumTileRows(layout); ++row) {
    for (int column = 0; column < NumTileColumns(layout); ++column) {
      const RasterWindow window = TileWindow(layout, column, row);
      Image<uint32_t> tile(window.width, window.height);
      for (int y = 0; y < window.height; ++y) {
        for (int x = 0; x < window.width; ++x) tile.At(x, y) = x % 2 == 0 ? 70000 : 90000;
      }
      writer.WriteTile(column, row, tile);
    }
  }
  writer.Finish();
  for (const int max_side : {0, 512}) {
    const RasterReader reader(dir / "source.tif", max_side);
    EXPECT_EQ(reader.Layout().bands, RasterBands::kUint32);
    EXPECT_EQ(reader.Layout().width, max_side == 0 ? 1024 : 512);
    for (const float label : reader.ReadHeights(0, 300).data) {
      EXPECT_TRUE(label == 70000 || label == 90000) << label;
    }
  }
}

TEST(RasterWriter, TilesThatAreNeverWrittenAreNone) {
  const TempDir dir;
  RasterLayout layout = SmallLayout(RasterBands::kFloat32, 600, 600);
  for (const double nodata : {kNoHeight, std::numeric_limits<double>::quiet_NaN()}) {
    layout.nodata = nodata;
    RasterWriter writer(dir / "dem.tif", layout);
    writer.WriteTile(1, 1, HeightTile(TileWindow(layout, 1, 1)));
    writer.Finish();
    const FloatImage heights = RasterReader(dir / "dem.tif").ReadHeights(0, 600);
    EXPECT_TRUE(std::isnan(heights.At(0, 0)));
    EXPECT_TRUE(std::isnan(heights.At(599, 599)));
    EXPECT_EQ(heights.At(300, 300), HeightAt(300, 300));
  }
}

TEST(RasterWriter, SameBytesForAnyOrderAndAnyNumberOfThreads) {
  const TempDir dir;
  const RasterLayout layout = SmallLayout(RasterBands::kFloat32, 2100, 1500);
  WriteHeights(dir / "a.tif", layout, 0);
  WriteHeights(dir / "b.tif", layout, 7, {}, 4);
  EXPECT_EQ(ReadBytes(dir / "a.tif"), ReadBytes(dir / "b.tif"));
}

// Finished at the same time as well.
TEST(RasterWriter, SameBytesOfColorsToo) {
  const TempDir dir;
  const RasterLayout layout = SmallLayout(RasterBands::kRgba8, 1500, 1100);
  const auto write = [&](int64_t i) {
    RasterWriter writer(dir / (std::to_string(i) + ".tif"), layout);
    for (const int tile : TileOrder(layout, static_cast<uint32_t>(i))) {
      const int column = tile % NumTileColumns(layout), row = tile / NumTileColumns(layout);
      const RasterWindow window = TileWindow(layout, column, row);
      Image<uint8_t> colors(window.width, window.height, 4);
      std::mt19937 random(static_cast<uint32_t>(tile));
      for (uint8_t& value : colors.data) value = static_cast<uint8_t>(random());
      writer.WriteTile(column, row, colors);
    }
    writer.Finish();
  };
  write(0);
  ParallelFor(3, 3, [&](int64_t i) { write(i + 1); });
  for (const char* other : {"1.tif", "2.tif", "3.tif"}) {
    EXPECT_EQ(ReadBytes(dir / "0.tif"), ReadBytes(dir / other)) << other;
  }
}

TEST(RasterWriter, WorldFileWithoutCrsIsOfThePixelCentre) {
  const TempDir dir;
  RasterLayout layout = SmallLayout(RasterBands::kFloat32, 300, 200);
  layout.crs = "";
  WriteHeights(dir / "dem.tif", layout);
  EXPECT_EQ(ReadBytes(dir / "dem.tfw"), "0.01\n0\n0\n-0.01\n500000.255\n7800000.495\n");
  EXPECT_EQ(FilesIn(dir.Path()), Sorted(RasterFiles("dem.tif", layout)));
}

TEST(RasterWriter, LargeRastersAreWrittenInBlocksToo) {
  const TempDir dir;
  RasterLayout layout = SmallLayout(RasterBands::kFloat32, 1500, 700);
  layout.crs = "";
  layout.nodata = kNoHeight;
  RasterWriterOptions options;
  options.max_block_side = 600;
  WriteHeights(dir / "dem.tif", layout, 3, options);
  EXPECT_EQ(FilesIn(dir.Path()), Sorted(RasterFiles("dem.tif", layout, options)));
  ExpectHeights(dir / "dem.tif", layout);
  // 3 x 2 blocks of 512 or less, each with its own place.
  const RasterReader block(dir / "dem_blocks/1_2.tif");
  EXPECT_EQ(block.Layout().width, 1500 - 2 * 512);
  EXPECT_EQ(block.Layout().height, 700 - 512);
  EXPECT_DOUBLE_EQ(block.Layout().min_x, layout.min_x + 0.01 * 1024);
  EXPECT_DOUBLE_EQ(block.Layout().max_y, layout.max_y - 0.01 * 512);
  EXPECT_EQ(block.ReadHeights(5, 1).At(6, 0), HeightAt(1030, 517));
  EXPECT_EQ(block.Layout().nodata, kNoHeight);
  const std::string vrt = ReadBytes(dir / "dem.vrt");
  EXPECT_NE(vrt.find("relativeToVRT=\"1\">dem_blocks/1_2.tif"), std::string::npos) << vrt;
  EXPECT_NE(vrt.find("rasterXSize=\"1500\" rasterYSize=\"700\""), std::string::npos) << vrt;
  const std::string info = GdalInfo(dir / "dem_blocks/0_0.tif");
  if (info.empty()) return;
  EXPECT_NE(info.find("LAYOUT=COG"), std::string::npos) << info;
}

TEST(RasterWriter, BlocksOfTheLargestMapsFitTagLab) {
  RasterLayout layout = SmallLayout(RasterBands::kRgba8, 40000, 32768);
  EXPECT_EQ(RasterFiles("map.tif", layout).size(), 1u + 4u + 1u);
  layout.width = layout.height = kMaxBlockSide;
  EXPECT_EQ(RasterFiles("map.tif", layout).size(), 1u);
}

TEST(RasterWriter, UnfinishedLeavesNothing) {
  const TempDir dir;
  const RasterLayout layout = SmallLayout(RasterBands::kFloat32);
  {
    RasterWriter writer(dir / "dem.tif", layout);
    writer.WriteTile(0, 0, HeightTile(TileWindow(layout, 0, 0)));
  }
  EXPECT_TRUE(FilesIn(dir.Path()).empty());
}

TEST(RasterWriter, BadInputIsOneLine) {
  const TempDir dir;
  RasterLayout layout = SmallLayout(RasterBands::kFloat32);
  layout.crs = "EPSG:99999999";
  EXPECT_ERROR(RasterWriter(dir / "dem.tif", layout), "dem.tif: its reference system");
  layout.crs = "/etc/passwd";
  EXPECT_ERROR(RasterWriter(dir / "dem.tif", layout), "'/etc/passwd' is none that PROJ knows");
  layout.crs = "";
  EXPECT_ERROR(RasterWriter(dir / "none/dem.tif", layout), "create the folder first");
  layout.pixel_size = 0;
  EXPECT_ERROR(RasterWriter(dir / "dem.tif", layout), "pixels have no size");
  layout.pixel_size = std::numeric_limits<double>::quiet_NaN();
  EXPECT_ERROR(RasterWriter(dir / "dem.tif", layout), "pixels have no size");
  layout = SmallLayout(RasterBands::kFloat32, 0, 5);
  EXPECT_ERROR(RasterWriter(dir / "dem.tif", layout), "has no pixels");
  EXPECT_TRUE(FilesIn(dir.Path()).empty());
}

TEST(RasterWriter, WrongTilesAreOurOwnBugs) {
  const TempDir dir;
  const RasterLayout layout = SmallLayout(RasterBands::kFloat32);
  RasterWriter writer(dir / "dem.tif", layout);
  EXPECT_THROW(writer.WriteTile(0, 0, FloatImage(255, 256)), std::logic_error);
  EXPECT_THROW(writer.WriteTile(0, 0, Image<uint8_t>(256, 256)), std::logic_error);
  EXPECT_THROW(writer.WriteTile(6, 0, FloatImage(256, 256)), std::logic_error);
}

TEST(RasterReader, OthersFilesAreRefusedByName) {
  const TempDir dir;
  EXPECT_ERROR(RasterReader(dir / "none.tif"), "none.tif: cannot be read");
  WriteBytes(dir / "text.tif", "no raster");
  EXPECT_ERROR(RasterReader(dir / "text.tif"), "text.tif: cannot be read");
}

TEST(RasterReader, DamageIsOneLine) {
  const TempDir dir;
  const RasterLayout layout = SmallLayout(RasterBands::kFloat32);
  WriteHeights(dir / "dem.tif", layout);
  std::string bytes = ReadBytes(dir / "dem.tif");
  WriteBytes(dir / "cut.tif", bytes.substr(0, bytes.size() / 2));
  EXPECT_ERROR(RasterReader(dir / "cut.tif").ReadHeights(0, layout.height),
               "cut.tif: cannot be read");
}

// Files may grow to `bytes` while it lives: a disk that is full.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit = {bytes, before_.rlim_max};
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int) = nullptr;
};

TEST(RasterWriter, FullDiskIsSaidAndLeavesNothing) {
  const TempDir dir;
  const RasterLayout layout = SmallLayout(RasterBands::kFloat32, 3000, 2000);
  uint64_t whole = 0;
  {
    WriteHeights(dir / "dem.tif", layout);
    whole = fs::file_size(dir / "dem.tif");
    fs::remove(dir / "dem.tif");
  }
  // In the temporary file, among its overviews, and in the finished one.
  for (const double share : {0.05, 0.3, 0.6, 0.8, 0.9, 0.97, 0.999}) {
    const FullDisk full(static_cast<rlim_t>(share * static_cast<double>(whole)));
    const std::string text = ErrorOf([&] { WriteHeights(dir / "dem.tif", layout); });
    EXPECT_NE(text.find("dem.tif: cannot be written"), std::string::npos) << text;
    EXPECT_NE(text.find("free some space"), std::string::npos) << share << " " << text;
    EXPECT_TRUE(FilesIn(dir.Path()).empty()) << share;
  }
}

}  // namespace
}  // namespace colmap_seapoint
