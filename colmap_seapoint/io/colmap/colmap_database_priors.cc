#include <cstring>
#include <map>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/files/sqlite.h"

namespace colmap_seapoint {
namespace {

using System = PositionPrior::System;

System SystemOf(int64_t number) {
  if (number == static_cast<int64_t>(System::kGeographic)) return System::kGeographic;
  if (number == static_cast<int64_t>(System::kCartesian)) return System::kCartesian;
  return System::kUnknown;
}

}  // namespace

std::vector<PositionPrior> ColmapDatabase::ReadPositionPriors() const {
  std::map<uint32_t, PositionPrior> priors;
  const auto add = [&](int64_t image_id, const Eigen::Vector3d& position, System system) {
    if (!position.allFinite()) return;  // COLMAP's way of saying that there is none
    const auto id = static_cast<uint32_t>(image_id);
    priors[id] = {id, position, system};
  };
  if (HasColumn("images", "prior_tx") && HasColumn("images", "prior_ty") &&
      HasColumn("images", "prior_tz")) {
    SqlStatement rows(path_, db_,
                      "SELECT image_id, prior_tx, prior_ty, prior_tz FROM images WHERE prior_tx "
                      "IS NOT NULL AND prior_ty IS NOT NULL AND prior_tz IS NOT NULL");
    while (rows.Step()) {
      add(rows.Int(0), {rows.Real(1), rows.Real(2), rows.Real(3)}, System::kUnknown);
    }
  }
  if (HasColumn("pose_priors", "position") && HasColumn("pose_priors", "coordinate_system")) {
    // Sensor type 0 is a camera, whose data are images.
    const bool by_image = HasColumn("pose_priors", "image_id");
    SqlStatement rows(path_, db_,
                      by_image
                          ? "SELECT image_id, position, coordinate_system FROM pose_priors"
                          : "SELECT corr_data_id, position, coordinate_system FROM pose_priors "
                            "WHERE corr_sensor_type = 0");
    while (rows.Step()) {
      if (rows.IsNull(1)) continue;
      Eigen::Vector3d position;
      if (rows.BlobSize(1) != sizeof(double) * 3) {
        throw Error(path_, "the pose prior of image " + std::to_string(rows.Int(0)) + " is damaged",
                    "restore a copy of the database, or give --SpatialMatching.positions_path");
      }
      std::memcpy(position.data(), rows.Blob(1), sizeof(double) * 3);
      add(rows.Int(0), position, SystemOf(rows.Int(2)));
    }
  }
  std::vector<PositionPrior> result;
  for (const auto& [image_id, prior] : priors) result.push_back(prior);
  return result;
}

}  // namespace colmap_seapoint
