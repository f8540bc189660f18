// The tables of COLMAP's database: what a new one is made of, and whether one that is there has the
// shape that we know. Found out by its columns, never by its version number. For
// colmap_database*.cc only.
#pragma once

#include <string>

struct sqlite3;

namespace colmap_seapoint {

// COLMAP 3.8's schema, with the one column of 4.x that older versions do not mind.
extern const char* const kColmapSchema;

// What a database has beyond the tables and columns that all of them have.
struct SchemaExtras {
  bool has_descriptor_type = false;  // descriptors.type, 4.0 and later
  bool has_frames = false;           // rigs, rig_sensors, frames and frame_data, 3.12 and later
  bool has_poses = false;            // two_view_geometries.qvec and tvec
};

// Throws Error for what is no COLMAP database: a table or column is missing, or is of another kind.
// When it is `to_be_written`, also for what we cannot fill: columns unknown to us that must have a
// value, a part of the tables of rigs and frames, tables named like ours that are not. Reads only.
SchemaExtras CheckSchema(const std::string& path, sqlite3* db, bool to_be_written);

}  // namespace colmap_seapoint
