// render_cloud: a cloud as a picture that a person looks at.
#pragma once

#include <string>

#include "colmap_seapoint/base/options.h"
#include "colmap_seapoint/base/run_options.h"

namespace colmap_seapoint {

struct CloudRendererOptions {
  std::string input_path;   // PLY
  std::string output_path;  // PNG or JPEG, which must not be there yet
  std::string model_path;   // COLMAP model: where up is; empty = where the normals point to
  std::string image_name;   // of the model: the cloud as this picture saw it; empty = from above
  double max_range = 0;     // from the nearest camera of the model; 0 = no limit
  int point_size = 3;       // pixels, as a picture saw it
  int width = 1000;         // pixels, from above
  RunOptions run;

  void Bind(OptionTable* table);
};

// From above: along the cloud's smallest axis, in its colours and, below, by height. As a picture
// saw it: in its colours and, below, by distance. With a scale bar and the values of the colours.
// What lies far outside of 98 % of the points is not shown, so that it does not make the rest tiny.
CommandResult RunCloudRenderer(const CloudRendererOptions& options);

}  // namespace colmap_seapoint
