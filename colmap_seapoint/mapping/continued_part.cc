#include "colmap_seapoint/mapping/continued_part.h"

#include <algorithm>
#include <map>
#include <utility>

#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"

namespace colmap_seapoint {
namespace {

using Track = std::vector<SparsePoint::TrackElement>;

bool Holds(const Track& track, uint32_t image_id) {
  return std::any_of(track.begin(), track.end(),
                     [&](const auto& element) { return element.image_id == image_id; });
}

class PartReturn {
 public:
  PartReturn(const SparseModel& part, const SparseModel& grown, SparseModel* whole)
      : part_(part), grown_(grown), whole_(*whole), were_there_(IdsOf(*whole)) {
    if (!whole->points3D.empty()) next_id_ = whole->points3D.rbegin()->first + 1;
    AddImages();
    AddLaterSeaPoints();
  }

  void Run() {
    for (const auto& [id, point] : grown_.points3D) {
      if (IsSeenByNewOnes(point)) Put(id, point);
    }
  }

 private:
  void AddImages() {
    for (const PosedImage& image : grown_.images) {
      if (were_there_.count(image.image_id) > 0) continue;
      whole_.images.push_back(image);
      auto& ids = whole_.images.back().point3D_ids;
      std::fill(ids.begin(), ids.end(), kNoPoint3D);
    }
    for (PosedImage& image : whole_.images) images_[image.image_id] = &image;
  }

  void AddLaterSeaPoints() {
    for (const PosedImage& image : part_.images) {
      const auto in_whole = images_.find(image.image_id);
      if (in_whole == images_.end()) continue;
      auto& points2D = in_whole->second->points2D;
      for (size_t k = points2D.size(); k < image.points2D.size(); ++k) {
        points2D.push_back(image.points2D[k]);
        in_whole->second->point3D_ids.push_back(kNoPoint3D);
      }
    }
  }

  bool IsSeenByNewOnes(const SparsePoint& point) const {
    return std::any_of(point.track.begin(), point.track.end(), [&](const auto& element) {
      return were_there_.count(element.image_id) == 0;
    });
  }

  uint64_t& IdAt(const SparsePoint::TrackElement& element) {
    return images_.at(element.image_id)->point3D_ids.at(element.point2D_idx);
  }

  // The point of the whole that a point of the grown part is.
  uint64_t TargetOf(uint64_t id, const SparsePoint& point) {
    if (part_.points3D.count(id) > 0) return id;
    for (const auto& element : point.track) {
      if (IdAt(element) != kNoPoint3D) return IdAt(element);
    }
    return next_id_++;
  }

  void Put(uint64_t id, const SparsePoint& point) {
    const uint64_t target = TargetOf(id, point);
    const auto [place, is_new] = whole_.points3D.try_emplace(target);
    SparsePoint& in_whole = place->second;
    if (is_new || part_.points3D.count(id) > 0) {
      in_whole.xyz = point.xyz;
      in_whole.rgb = point.rgb;
      in_whole.error = point.error;
    }
    for (const auto& element : point.track) {
      if (IdAt(element) != kNoPoint3D || Holds(in_whole.track, element.image_id)) continue;
      IdAt(element) = target;
      in_whole.track.push_back(element);
    }
    if (in_whole.track.size() < 2) Remove(target);
  }

  void Remove(uint64_t id) {
    for (const auto& element : whole_.points3D.at(id).track) IdAt(element) = kNoPoint3D;
    whole_.points3D.erase(id);
  }

  const SparseModel& part_;
  const SparseModel& grown_;
  SparseModel& whole_;
  ImageIds were_there_;
  std::map<uint32_t, PosedImage*> images_;
  uint64_t next_id_ = 1;
};

// Those that the model was not made of yet.
void AddLaterSeaPoints(const ColmapDatabase& database, SparseModel* model) {
  for (PosedImage& image : model->images) {
    const auto places = ReadKeypointPlaces(database, image.image_id);
    for (size_t k = image.points2D.size(); k < places.size(); ++k) {
      image.points2D.push_back(places[k].cast<double>());
      image.point3D_ids.push_back(kNoPoint3D);
    }
  }
}

}  // namespace

ImageIds IdsOf(const SparseModel& model) {
  ImageIds ids;
  for (const PosedImage& image : model.images) ids.insert(image.image_id);
  return ids;
}

SparseModel PartOf(const SparseModel& whole, const ImageIds& images) {
  SparseModel part;
  part.cameras = whole.cameras;
  for (const auto& [id, point] : whole.points3D) {
    Track within;
    for (const auto& element : point.track) {
      if (images.count(element.image_id) > 0) within.push_back(element);
    }
    if (within.size() < 2) continue;
    part.points3D[id] = point;
    part.points3D[id].track = std::move(within);
  }
  for (const PosedImage& image : whole.images) {
    if (images.count(image.image_id) == 0) continue;
    part.images.push_back(image);
    for (uint64_t& id : part.images.back().point3D_ids) {
      if (part.points3D.count(id) == 0) id = kNoPoint3D;
    }
  }
  return part;
}

PicturesToAdd FindPicturesToAdd(const std::filesystem::path& database_path,
                                const std::filesystem::path& model_path) {
  const ColmapDatabase database(database_path, ColmapDatabase::Mode::kReadOnly,
                                ColmapDatabase::Check::kNone);
  const SparseModel whole = ReadSparseModel(model_path);
  const ImageIds posed = IdsOf(whole);
  ImageIds added, neighbours;
  for (const ImagePair& pair : ReadVerifiedPairs(database)) {
    for (const auto& [one, other] : {pair, ImagePair(pair.second, pair.first)}) {
      if (posed.count(one) > 0) continue;
      added.insert(one);
      if (posed.count(other) > 0) neighbours.insert(other);
    }
  }
  PicturesToAdd pictures;
  if (neighbours.empty()) return pictures;
  for (const DatabaseImage& image : ReadImages(database)) {
    const bool is_wanted = added.count(image.image_id) + neighbours.count(image.image_id) > 0;
    if (is_wanted) pictures.names.push_back(image.name);
  }
  pictures.part = PartOf(whole, neighbours);
  AddLaterSeaPoints(database, &pictures.part);
  return pictures;
}

void PutPartBack(const SparseModel& part, const SparseModel& grown, SparseModel* whole) {
  PartReturn(part, grown, whole).Run();
}

}  // namespace colmap_seapoint
