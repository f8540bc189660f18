#include "colmap_seapoint/io/files/map_projection.h"

#include <proj.h>

#include <cmath>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

constexpr char kRemedy[] = "give --crs a projected system in metres, e.g. EPSG:32755 (UTM)";

using Context = std::unique_ptr<PJ_CONTEXT, PJ_CONTEXT* (*)(PJ_CONTEXT*)>;
using Object = std::unique_ptr<PJ, PJ* (*)(PJ*)>;

Object Own(PJ* object) { return Object(object, &proj_destroy); }

// Says what is wrong with the coordinate axes of a projected system; "" when they are metres.
std::string AxesProblem(PJ_CONTEXT* context, const PJ* crs) {
  const PJ_TYPE type = proj_get_type(crs);
  if (type == PJ_TYPE_COMPOUND_CRS) {
    return AxesProblem(context, Own(proj_crs_get_sub_crs(context, crs, 0)).get());
  }
  if (type == PJ_TYPE_BOUND_CRS) {
    return AxesProblem(context, Own(proj_get_source_crs(context, crs)).get());
  }
  if (type != PJ_TYPE_PROJECTED_CRS) return "is no projected reference system";
  const Object axes = Own(proj_crs_get_coordinate_system(context, crs));
  for (int i = 0; axes && i < 2; ++i) {
    double metres = 0;
    const char* unit = "";
    if (!proj_cs_get_axis_info(context, axes.get(), i, nullptr, nullptr, nullptr, &metres, &unit,
                               nullptr, nullptr) ||
        metres != 1) {
      return std::string("has axes in ") + unit + ", not in metres";
    }
  }
  return axes ? "" : "has no coordinate axes";
}

}  // namespace

struct MapProjection::Impl {
  Context context{proj_context_create(), &proj_context_destroy};
  Object transformation{nullptr, &proj_destroy};
};

MapProjection::MapProjection(const std::string& crs) : impl_(std::make_unique<Impl>()), crs_(crs) {
  PJ_CONTEXT* context = impl_->context.get();
  proj_log_level(context, PJ_LOG_NONE);
  const Object system = Own(proj_create(context, crs.c_str()));
  if (!system) throw Error("--crs " + crs, "PROJ does not know it", kRemedy);
  const std::string problem = AxesProblem(context, system.get());
  if (!problem.empty()) throw Error("--crs " + crs, problem, kRemedy);
  name_ = proj_get_name(system.get());
  const Object raw = Own(proj_create_crs_to_crs(context, "EPSG:4326", crs.c_str(), nullptr));
  if (raw) {
    // Longitude before latitude, easting before northing, whatever the system's own order.
    impl_->transformation = Own(proj_normalize_for_visualization(context, raw.get()));
  }
  if (!impl_->transformation) {
    throw Error("--crs " + crs, "PROJ cannot convert WGS84 to it", kRemedy);
  }
}

MapProjection::~MapProjection() = default;

Eigen::Vector3d MapProjection::FromGeographic(const GeoPosition& position) const {
  const PJ_COORD from = proj_coord(position.longitude_deg, position.latitude_deg, 0, HUGE_VAL);
  const PJ_COORD to = proj_trans(impl_->transformation.get(), PJ_FWD, from);
  const Eigen::Vector3d result(to.xyz.x, to.xyz.y, position.altitude_m);
  if (result.allFinite()) return result;
  throw Error("--crs " + crs_,
              "does not reach latitude " + std::to_string(position.latitude_deg) + ", longitude " +
                  std::to_string(position.longitude_deg),
              "choose the system of that place, or correct the position");
}

std::string WellKnownText(const std::string& crs, const std::string& file) {
  const Context context(proj_context_create(), &proj_context_destroy);
  proj_log_level(context.get(), PJ_LOG_NONE);
  const Object system = Own(proj_create(context.get(), crs.c_str()));
  const char* text = nullptr;
  for (const PJ_WKT_TYPE type : {PJ_WKT1_GDAL, PJ_WKT2_2019}) {
    constexpr const char* kOneLine[] = {"MULTILINE=NO", nullptr};
    if (text != nullptr || !system || !proj_is_crs(system.get())) continue;
    text = proj_as_wkt(context.get(), system.get(), type, kOneLine);
  }
  if (text != nullptr) return text;
  throw Error(file, "its reference system '" + crs + "' is none that PROJ knows",
              "give one as EPSG:32755, or none");
}

GeoPosition MapProjection::ToGeographic(const Eigen::Vector3d& position) const {
  const PJ_COORD from = proj_coord(position.x(), position.y(), 0, HUGE_VAL);
  const PJ_COORD to = proj_trans(impl_->transformation.get(), PJ_INV, from);
  const GeoPosition result = {to.xyz.y, to.xyz.x, position.z()};
  if (IsLegal(result)) return result;
  throw Error("--crs " + crs_,
              "does not hold easting " + std::to_string(position.x()) + ", northing " +
                  std::to_string(position.y()),
              "check the offset in units.json");
}

}  // namespace colmap_seapoint
