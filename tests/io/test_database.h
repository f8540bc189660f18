// A look at a database past our own code, and the contents that the tests write.
#pragma once

#include <sqlite3.h>

#include <random>
#include <string>
#include <vector>

#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "test_files.h"

namespace colmap_seapoint {

// Every row of a query, its columns joined with '|', blobs in hex.
inline std::vector<std::string> Query(const std::filesystem::path& path, const std::string& sql) {
  sqlite3* db = nullptr;
  EXPECT_EQ(sqlite3_open(path.c_str(), &db), SQLITE_OK);
  sqlite3_stmt* statement = nullptr;
  EXPECT_EQ(sqlite3_prepare_v2(db, sql.c_str(), -1, &statement, nullptr), SQLITE_OK)
      << sqlite3_errmsg(db);
  std::vector<std::string> rows;
  while (sqlite3_step(statement) == SQLITE_ROW) {
    std::string row;
    for (int i = 0; i < sqlite3_column_count(statement); ++i) {
      if (i > 0) row += "|";
      if (sqlite3_column_type(statement, i) == SQLITE_NULL) {
        row += "NULL";
      } else if (sqlite3_column_type(statement, i) == SQLITE_BLOB) {
        const auto* bytes = static_cast<const unsigned char*>(sqlite3_column_blob(statement, i));
        char hex[3];
        for (int k = 0; k < sqlite3_column_bytes(statement, i); ++k) {
          std::snprintf(hex, sizeof(hex), "%02x", bytes[k]);
          row += hex;
        }
      } else {
        row += reinterpret_cast<const char*>(sqlite3_column_text(statement, i));
      }
    }
    rows.push_back(row);
  }
  sqlite3_finalize(statement);
  sqlite3_close(db);
  return rows;
}

inline std::string QueryOne(const std::filesystem::path& path, const std::string& sql) {
  const auto rows = Query(path, sql);
  return rows.empty() ? "" : rows.front();
}

inline void Execute(const std::filesystem::path& path, const std::string& sql) {
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &db), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(db, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
      << sqlite3_errmsg(db);
  sqlite3_close(db);
}

inline void ExpectSound(const std::filesystem::path& path) {
  EXPECT_EQ(QueryOne(path, "PRAGMA integrity_check"), "ok");
  EXPECT_TRUE(Query(path, "PRAGMA foreign_key_check").empty());
}

inline Features MakeFeatures(int count, unsigned seed) {
  std::mt19937 random(seed);
  Features features;
  for (int i = 0; i < count; ++i) {
    SeaPoint point;
    point.x = static_cast<float>(random() % 640) + 0.5f;
    point.y = static_cast<float>(random() % 480) + 0.25f;
    point.scale = 1.5f;
    point.orientation = 0.125f * static_cast<float>(i);
    features.points.push_back(point);
    Descriptor descriptor;
    for (uint8_t& byte : descriptor) byte = static_cast<uint8_t>(random());
    features.descriptors.push_back(descriptor);
  }
  return features;
}

inline Features MakeFeaturesWithSift(int count, unsigned seed) {
  Features features = MakeFeatures(count, seed);
  std::mt19937 random(seed + 1000);
  features.sift_descriptors.resize(features.points.size());
  for (SiftDescriptor& descriptor : features.sift_descriptors) {
    descriptor.fill(0);
    for (size_t group = 0; group < 8; ++group) {
      descriptor[16 * group + random() % 16] = 181;  // a length of 512
    }
  }
  return features;
}

inline void ExpectSameFeatures(const std::optional<Features>& a, const Features& b) {
  ASSERT_TRUE(a.has_value());
  ASSERT_EQ(a->points.size(), b.points.size());
  for (size_t i = 0; i < b.points.size(); ++i) {
    EXPECT_EQ(a->points[i].x, b.points[i].x);
    EXPECT_EQ(a->points[i].y, b.points[i].y);
    EXPECT_EQ(a->points[i].scale, b.points[i].scale);
    EXPECT_EQ(a->points[i].orientation, b.points[i].orientation);
  }
  EXPECT_EQ(a->descriptors, b.descriptors);
  EXPECT_EQ(a->sift_descriptors, b.sift_descriptors);
}

inline TwoViewGeometry MakeGeometry(FeatureMatches inliers) {
  TwoViewGeometry geometry;
  geometry.config = TwoViewConfig::kCalibrated;
  geometry.inliers = std::move(inliers);
  geometry.F = (Eigen::Matrix3d() << 1, 2, 3, 4, 5, 6, 7, 8, 10).finished();
  geometry.E = (Eigen::Matrix3d() << 0, -1, 2, 1, 0, -3, -2, 3, 0).finished();
  geometry.H = (Eigen::Matrix3d() << 1, 0.1, 5, -0.1, 1, 7, 1e-4, 2e-4, 1).finished();
  Rigid3d pose;
  pose.rotation = Eigen::Quaterniond(0.9, 0.1, -0.3, 0.2).normalized();
  pose.translation = Eigen::Vector3d(0.6, 0, 0.8);
  geometry.cam2_from_cam1 = pose;
  return geometry;
}

}  // namespace colmap_seapoint
