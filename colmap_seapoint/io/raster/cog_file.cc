#include "colmap_seapoint/io/raster/cog_file.h"

#include <gdal_utils.h>

#include <algorithm>
#include <string>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_file.h"

namespace colmap_seapoint {
namespace {

constexpr int kCogTile = 512;
// GDAL's own level, 6, takes 1.7 times (heights) and 5 times (colours) as long for 4 % less.
constexpr char kCogLevel[] = "LEVEL=1";

// GDAL makes overviews a few rows of the whole width at a time: a row of tiles must fit into its
// cache, or each is unpacked many times. A part of the layout's tiles, so that each is packed once.
int ScratchTile(int tile_size) {
  constexpr int kMost = 256;
  while (tile_size > kMost && tile_size % 32 == 0) tile_size /= 2;
  return tile_size;
}

// Labels and masks have no mean.
const char* Resampling(RasterBands bands) {
  return bands == RasterBands::kFloat32 || bands == RasterBands::kRgba8 ? "AVERAGE" : "NEAREST";
}

std::vector<int> OverviewFactors(const RasterLayout& layout) {
  std::vector<int> factors;
  for (int side = std::max(layout.width, layout.height); side > kCogTile; side = (side + 1) / 2) {
    factors.push_back(factors.empty() ? 2 : 2 * factors.back());
  }
  return factors;
}

// Parts of about equal length, of whole tiles.
int PartLength(int side, int max_side) {
  const int num_parts = (side - 1) / max_side + 1;
  const int length = (side - 1) / num_parts + 1;
  return std::min(max_side, (length + kCogTile - 1) / kCogTile * kCogTile);
}

// Into what its own name says.
void WriteBlock(GDALDatasetH scratch, const RasterWindow& window, const std::filesystem::path& path,
                RasterLayout layout) {
  layout.width = window.width;
  layout.height = window.height;
  const AtomicPath part(path);
  GdalStrings arguments = {"-of",
                           "GTiff",
                           "-srcwin",
                           std::to_string(window.x),
                           std::to_string(window.y),
                           std::to_string(window.width),
                           std::to_string(window.height)};
  GdalStrings creation = ScratchOptions(layout);
  for (char** option = creation.List(); *option != nullptr; ++option) {
    arguments.Add("-co");
    arguments.Add(*option);
  }
  GdalDataset copy;
  {
    const GdalSession session(path);
    GDALTranslateOptions* options = GDALTranslateOptionsNew(arguments.List(), nullptr);
    session.Check(options != nullptr);
    copy.reset(GDALTranslate(part.Temporary().c_str(), scratch, options, nullptr));
    GDALTranslateOptionsFree(options);
    session.Check(copy != nullptr, &part);
  }
  WriteCog(copy.get(), part, path, layout);
}

void WriteBlockIndex(const std::vector<std::filesystem::path>& blocks,
                     const std::filesystem::path& path) {
  AtomicPath index(path);
  {
    const GdalSession session(path);
    GdalStrings names = {};
    for (const auto& block : blocks) names.Add(block.string());
    GdalDataset joined(GDALBuildVRT(index.Temporary().c_str(), static_cast<int>(blocks.size()),
                                    nullptr, names.List(), nullptr, nullptr));
    session.Check(joined != nullptr, &index);
    joined.reset();
    session.Check(true, &index);
  }
  index.Commit();
}

// Each one's place and length, in the file's table of them.
bool HasAllBlocksOf(GDALRasterBandH band) {
  int side_x = 0, side_y = 0;
  GDALGetBlockSize(band, &side_x, &side_y);
  const int num_x = (GDALGetRasterBandXSize(band) - 1) / side_x + 1;
  const int num_y = (GDALGetRasterBandYSize(band) - 1) / side_y + 1;
  for (int i = 0; i < num_x * num_y; ++i) {
    const std::string block = std::to_string(i % num_x) + "_" + std::to_string(i / num_x);
    for (const char* what : {"BLOCK_OFFSET_", "BLOCK_SIZE_"}) {
      if (GDALGetMetadataItem(band, (what + block).c_str(), "TIFF") == nullptr) return false;
    }
  }
  return true;
}

// GDAL says nothing when the last that it writes of a file, the table of its blocks, fails.
bool IsWhole(const std::filesystem::path& cog) {
  const GdalDataset dataset(
      GDALOpenEx(cog.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, nullptr, nullptr, nullptr));
  if (dataset == nullptr) return false;
  GDALRasterBandH band = GDALGetRasterBand(dataset.get(), 1);
  bool is_whole = HasAllBlocksOf(band);
  for (int i = 0; i < GDALGetOverviewCount(band); ++i) {
    is_whole = is_whole && HasAllBlocksOf(GDALGetOverview(band, i));
  }
  return is_whole;
}

std::filesystem::path BlockFolder(const std::filesystem::path& path) {
  return path.parent_path() / (path.stem().string() + "_blocks");
}

}  // namespace

GdalStrings ScratchOptions(const RasterLayout& layout) {
  const std::string tile = std::to_string(ScratchTile(layout.tile_size));
  GdalStrings options = {"TILED=YES",      "BLOCKXSIZE=" + tile, "BLOCKYSIZE=" + tile,
                         "COMPRESS=ZSTD",  "ZSTD_LEVEL=1",       "BIGTIFF=IF_SAFER",
                         "SPARSE_OK=TRUE", "INTERLEAVE=PIXEL"};
  if (layout.bands == RasterBands::kRgba8) {
    options.Add("PHOTOMETRIC=RGB");
    options.Add("ALPHA=YES");
  }
  return options;
}

// The overviews go into the scratch file: made by the COG driver, they would lie in a file beside
// it that a killed run would leave.
void WriteCog(GDALDatasetH scratch, const AtomicPath& scratch_file,
              const std::filesystem::path& path, const RasterLayout& layout) {
  AtomicPath file(path);
  {
    const GdalSession session(path);
    std::vector<int> factors = OverviewFactors(layout);
    if (!factors.empty()) {
      const CPLErr built =
          GDALBuildOverviews(scratch, Resampling(layout.bands), static_cast<int>(factors.size()),
                             factors.data(), 0, nullptr, nullptr, nullptr);
      session.Check(built == CE_None, &scratch_file);
    }
    GdalStrings options = {"COMPRESS=DEFLATE", "PREDICTOR=YES",
                           kCogLevel,          "BLOCKSIZE=" + std::to_string(kCogTile),
                           "BIGTIFF=IF_SAFER", "OVERVIEWS=FORCE_USE_EXISTING"};
    GdalDataset copy(GDALCreateCopy(GdalDriver("COG"), file.Temporary().c_str(), scratch, TRUE,
                                    options.List(), nullptr, nullptr));
    session.Check(copy != nullptr, &file);
    copy.reset();
    session.Check(true, &file);
    if (!IsWhole(file.Temporary())) {
      throw Error(path.string(), "was not written as a whole",
                  "check the disk's space and health, then run it again");
    }
  }
  file.Commit();
}

std::vector<RasterWindow> Blocks(const RasterLayout& layout, int max_side) {
  const int width = PartLength(layout.width, max_side);
  const int height = PartLength(layout.height, max_side);
  std::vector<RasterWindow> blocks;
  for (int y = 0; y < layout.height; y += height) {
    for (int x = 0; x < layout.width; x += width) {
      blocks.push_back(
          {x, y, std::min(width, layout.width - x), std::min(height, layout.height - y)});
    }
  }
  return blocks;
}

std::vector<std::filesystem::path> BlockPaths(const std::filesystem::path& path,
                                              const RasterLayout& layout, int max_side) {
  std::vector<std::filesystem::path> paths;
  for (const RasterWindow& block : Blocks(layout, max_side)) {
    const int row = block.y / PartLength(layout.height, max_side);
    const int column = block.x / PartLength(layout.width, max_side);
    paths.push_back(BlockFolder(path) /
                    (std::to_string(row) + "_" + std::to_string(column) + ".tif"));
  }
  return paths;
}

std::filesystem::path BlockIndexPath(const std::filesystem::path& path) {
  return std::filesystem::path(path).replace_extension(".vrt");
}

void WriteBlocks(GDALDatasetH scratch, const std::filesystem::path& path,
                 const RasterLayout& layout, int max_side) {
  CheckWritableDir(BlockFolder(path));
  const std::vector<RasterWindow> blocks = Blocks(layout, max_side);
  const std::vector<std::filesystem::path> paths = BlockPaths(path, layout, max_side);
  for (size_t i = 0; i < blocks.size(); ++i) {
    WriteBlock(scratch, blocks[i], paths[i], layout);
  }
  WriteBlockIndex(paths, BlockIndexPath(path));
}

}  // namespace colmap_seapoint
