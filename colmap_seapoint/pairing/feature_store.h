// SeaPoints out of a database for many threads: one connection, the most recent pictures in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <mutex>

#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"

namespace colmap_seapoint {

class FeatureStore {
 public:
  // `database` outlives the store. Whoever else uses the connection meanwhile holds Mutex().
  explicit FeatureStore(ColmapDatabase* database) : database_(database) {}

  // nullptr when the image has no SeaPoints of ours. From any thread.
  std::shared_ptr<const Features> Read(uint32_t image_id);

  std::mutex& Mutex() { return mutex_; }

 private:
  struct Entry {
    uint32_t image_id;
    std::shared_ptr<const Features> features;
  };

  std::mutex mutex_;
  ColmapDatabase* database_;
  std::list<Entry> recent_;  // most recent first
  std::map<uint32_t, std::list<Entry>::iterator> entries_;
  size_t bytes_ = 0;
};

}  // namespace colmap_seapoint
