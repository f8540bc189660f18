#include "colmap_seapoint/pairing/pair_options.h"

namespace colmap_seapoint {

void SequentialPairOptions::Bind(OptionTable* table) {
  table->Add("SequentialMatching.overlap", &overlap,
             "how many following pictures each one is matched with",
             "COLMAP (there 10, and powers of two)", 1, 10000);
  table->Add("SequentialMatching.loop_detection", &loop_detection,
             "also match each picture with those that look like it, wherever they are in the order",
             "COLMAP (there 0, and with a vocabulary to download)");
  table->Add("SequentialMatching.loop_detection_num_images", &loop_detection_num_images,
             "pictures that each one is looked for among, at most", "COLMAP (there 50)", 1, 1000);
}

void SpatialPairOptions::Bind(OptionTable* table) {
  const std::string group = "SpatialMatching.";
  table->Add(group + "max_num_neighbors", &max_num_neighbors,
             "nearest pictures that each one is matched with, at most", "COLMAP (there 50)", 1,
             10000);
  table->Add(group + "max_distance", &max_distance,
             "largest distance of two pictures, metres (or the unit of the positions)", "COLMAP",
             1e-6, 1e9);
  table->Add(group + "ignore_z", &ignore_z, "distances leave height and depth out of account",
             "COLMAP");
  table->Add(group + "is_gps", &is_gps,
             "positions of the database that do not say what they are: 1 = latitude, longitude, "
             "altitude; 0 = metres",
             "COLMAP 3.8");
  table->Add(group + "positions_path", &positions_path,
             "table of positions, with the header image,x,y,z (metres) or image,lat,lon,alt "
             "(degrees, metres); empty = EXIF, or the database",
             "ours");
}

}  // namespace colmap_seapoint
