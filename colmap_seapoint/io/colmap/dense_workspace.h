// COLMAP's dense workspace, as its image_undistorter and patch_match_stereo leave it: images/,
// sparse/, stereo/{depth_maps,normal_maps,consistency_graphs}/, stereo/patch-match.cfg and
// stereo/fusion.cfg. The only place that knows its names and the form of its maps.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {

// image_name: one that IsSafeImageName accepts, sub-folders included. The maps are those that
// `stereo_fusion` takes by default (--input_type geometric).
std::filesystem::path UndistortedImagePath(const std::filesystem::path& workspace,
                                           const std::string& image_name);
std::filesystem::path DepthMapPath(const std::filesystem::path& workspace,
                                   const std::string& image_name);
std::filesystem::path NormalMapPath(const std::filesystem::path& workspace,
                                    const std::string& image_name);

// The folders that these pictures' files lie in. Throws Error.
void CreateDenseWorkspaceFolders(const std::filesystem::path& workspace,
                                 const std::vector<std::string>& image_names);

// Removes what an earlier run left: without fusion.cfg a workspace is not fused before it is whole
// again.
void RemoveStereoConfigs(const std::filesystem::path& workspace);
// fusion.cfg: which pictures are fused; patch-match.cfg: the same, each with its 20 best partners,
// for who wants COLMAP's own maps as well. Atomic.
void WriteStereoConfigs(const std::filesystem::path& workspace,
                        const std::vector<std::string>& image_names);

// "width&height&channels&", then float32, one channel after the other. Atomic; throws Error.
void WriteDenseMap(const std::filesystem::path& path, const FloatImage& map);
// Throws Error for a file that is no such map, truncated or too long.
FloatImage ReadDenseMap(const std::filesystem::path& path);

}  // namespace colmap_seapoint
