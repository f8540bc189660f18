// The calls of a database that tests make, all topics.
#pragma once

#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_loops.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
