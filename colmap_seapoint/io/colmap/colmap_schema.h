// The tables of COLMAP's database: what a new one is made of, and whether one that is there has the
// shape that we know. That is found out by its columns, never by its version number. For this room
// only.
#pragma once

#include <cstdint>

namespace colmap_seapoint {

struct SqlConnection;  // io/files/sqlite.h

// COLMAP 3.8's schema, with the one column of 4.x that older versions do not mind.
extern const char* const kColmapSchema;

// A pair of images is one number: kMaxImageId * smaller id + larger id.
inline constexpr int64_t kMaxImageId = 2147483647;

// What a database has beyond the tables and columns that all of them have.
struct SchemaExtras {
  bool has_descriptor_type = false;  // descriptors.type, 4.0 and later
  bool has_frames = false;           // rigs, rig_sensors, frames and frame_data, 3.12 and later
  bool has_poses = false;            // two_view_geometries.qvec and tvec
};

// Throws Error for what is no COLMAP database: a table or column is missing, or is of another kind.
// When it is `to_be_written`, also for what we cannot fill: columns unknown to us that must have a
// value, some but not all of the tables of rigs and frames, tables that are named like ours and are
// not. Only reads.
SchemaExtras CheckSchema(const SqlConnection& connection, bool to_be_written);

}  // namespace colmap_seapoint
