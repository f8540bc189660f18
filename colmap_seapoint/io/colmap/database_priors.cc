#include "colmap_seapoint/io/colmap/database_priors.h"

#include <cstring>
#include <map>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/sqlite.h"

namespace colmap_seapoint {
namespace {

using System = PositionPrior::System;

System SystemOf(int64_t number) {
  if (number == static_cast<int64_t>(System::kGeographic)) return System::kGeographic;
  if (number == static_cast<int64_t>(System::kCartesian)) return System::kCartesian;
  return System::kUnknown;
}

// Whatever is not finite is COLMAP's way of saying that there is none.
void Add(int64_t image_id, const Eigen::Vector3d& position, System system,
         std::map<uint32_t, PositionPrior>* priors) {
  if (!position.allFinite()) return;
  const auto id = static_cast<uint32_t>(image_id);
  (*priors)[id] = {id, position, system};
}

// images.prior_tx and so on: COLMAP up to 3.9.
void ReadFromImages(const SqlConnection& db, std::map<uint32_t, PositionPrior>* priors) {
  for (const char* column : {"prior_tx", "prior_ty", "prior_tz"}) {
    if (!HasColumn(db, "images", column)) return;
  }
  SqlStatement rows(db,
                    "SELECT image_id, prior_tx, prior_ty, prior_tz FROM images WHERE prior_tx "
                    "IS NOT NULL AND prior_ty IS NOT NULL AND prior_tz IS NOT NULL");
  while (rows.Step()) {
    Add(rows[0].Int(), {rows[1].Real(), rows[2].Real(), rows[3].Real()}, System::kUnknown, priors);
  }
}

// pose_priors, by image or by the data of frames. Sensor type 0 is a camera, whose data are images.
void ReadFromPosePriors(const SqlConnection& db, std::map<uint32_t, PositionPrior>* priors) {
  for (const char* column : {"position", "coordinate_system"}) {
    if (!HasColumn(db, "pose_priors", column)) return;
  }
  const bool by_image = HasColumn(db, "pose_priors", "image_id");
  SqlStatement rows(db, by_image
                            ? "SELECT image_id, position, coordinate_system FROM pose_priors"
                            : "SELECT corr_data_id, position, coordinate_system FROM pose_priors "
                              "WHERE corr_sensor_type = 0");
  while (rows.Step()) {
    if (rows[1].IsNull()) continue;
    Eigen::Vector3d position;
    if (rows[1].Size() != sizeof(double) * 3) {
      throw Error(db.path,
                  "the pose prior of image " + std::to_string(rows[0].Int()) + " is damaged",
                  "restore a copy of the database, or give --SpatialMatching.positions_path");
    }
    std::memcpy(position.data(), rows[1].Blob(), sizeof(double) * 3);
    Add(rows[0].Int(), position, SystemOf(rows[2].Int()), priors);
  }
}

}  // namespace

std::vector<PositionPrior> ReadPositionPriors(const ColmapDatabase& database) {
  std::map<uint32_t, PositionPrior> priors;
  ReadFromImages(database.Connection(), &priors);
  ReadFromPosePriors(database.Connection(), &priors);  // wins over the former
  std::vector<PositionPrior> result;
  for (const auto& [image_id, prior] : priors) result.push_back(prior);
  return result;
}

}  // namespace colmap_seapoint
