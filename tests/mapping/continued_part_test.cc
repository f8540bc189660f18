// A part of a model grows; the whole takes in what is new and nothing else.
#include "colmap_seapoint/mapping/continued_part.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "tests/io/test_files.h"
#include "tests/mapping/exact_survey.h"

namespace colmap_seapoint {
namespace {

using Track = std::vector<SparsePoint::TrackElement>;

// The pictures of these ids, with points that two of them see.
SparseModel Only(const SparseModel& survey, uint32_t first, uint32_t last) {
  ImageIds ids;
  for (uint32_t id = first; id <= last; ++id) ids.insert(id);
  return PartOf(survey, ids);
}

bool IsSame(const SparsePoint& a, const SparsePoint& b) {
  return a.xyz == b.xyz && a.error == b.error &&
         std::equal(a.track.begin(), a.track.end(), b.track.begin(), b.track.end(),
                    [](const auto& x, const auto& y) {
                      return x.image_id == y.image_id && x.point2D_idx == y.point2D_idx;
                    });
}

class ContinuedPart : public testing::Test {
 protected:
  // Throws what a reader of ours throws for a model that contradicts itself.
  void Check(const SparseModel& model) const {
    WriteSparseModelBinary(dir_ / "model", model);
    EXPECT_NO_THROW(ReadSparseModel(dir_ / "model"));
    for (const auto& [id, point] : model.points3D) {
      EXPECT_GE(point.track.size(), 2u);
      for (const auto& element : point.track) {
        const auto image =
            std::find_if(model.images.begin(), model.images.end(),
                         [&](const auto& i) { return i.image_id == element.image_id; });
        EXPECT_EQ(image->point3D_ids[element.point2D_idx], id);
      }
    }
  }

  TempDir dir_;
  const SparseModel survey_ = ExactSurvey(ExactLens(), 5);
  const SparseModel whole_ = Only(survey_, 1, 8);
  const SparseModel part_ = Only(whole_, 4, 8);
  const SparseModel grown_ = Only(survey_, 4, 10);
};

TEST_F(ContinuedPart, ThePartHoldsWhatTwoOfItsPicturesSee) {
  EXPECT_EQ(IdsOf(part_), (ImageIds{4, 5, 6, 7, 8}));
  EXPECT_LT(part_.points3D.size(), whole_.points3D.size());
  Check(part_);
}

TEST_F(ContinuedPart, NewPicturesAndTheirPointsComeIn) {
  SparseModel whole = whole_;
  SparseModel grown = grown_;
  for (auto& [id, point] : grown.points3D) point.xyz.z() += 0.5;
  PutPartBack(part_, grown, &whole);
  Check(whole);
  EXPECT_EQ(IdsOf(whole), IdsOf(survey_));
  size_t num_grown = 0, num_new = 0;
  for (const auto& [id, point] : whole.points3D) {
    const auto num_of_new = std::count_if(point.track.begin(), point.track.end(),
                                          [](const auto& e) { return e.image_id > 8; });
    const auto before = whole_.points3D.find(id);
    if (before == whole_.points3D.end()) {
      ++num_new;
      EXPECT_GT(id, whole_.points3D.rbegin()->first);
    } else if (num_of_new == 0) {
      EXPECT_TRUE(IsSame(before->second, point)) << id;  // though the mapper had moved it
    } else {
      ++num_grown;
      EXPECT_EQ(point.track.size(), before->second.track.size() + static_cast<size_t>(num_of_new));
    }
  }
  EXPECT_GT(num_grown, 10u);
  EXPECT_GT(num_new, 0u);
  // Every observation that the two have in the grown part, they have in the whole.
  for (size_t i = 8; i < 10; ++i) {
    const auto count = [](const PosedImage& image) {
      return image.point3D_ids.size() -
             static_cast<size_t>(
                 std::count(image.point3D_ids.begin(), image.point3D_ids.end(), kNoPoint3D));
    };
    EXPECT_EQ(count(whole.images[i]), count(grown.images[i - 3]));
  }
}

// The mapper knows nothing of the whole's ids, nor of the points that one picture of the part sees.
TEST_F(ContinuedPart, APointOfTheWholeIsThatPointAndIdsDoNotClash) {
  SparseModel grown = grown_;
  const uint64_t next = part_.points3D.rbegin()->first + 1;
  SparseModel renamed = grown;
  renamed.points3D.clear();
  std::map<uint64_t, uint64_t> names;
  uint64_t fresh = next;
  for (const auto& [id, point] : grown.points3D) {
    names[id] = part_.points3D.count(id) > 0 ? id : fresh++;
    renamed.points3D[names[id]] = point;
  }
  for (PosedImage& image : renamed.images) {
    for (uint64_t& id : image.point3D_ids) {
      if (id != kNoPoint3D) id = names.at(id);
    }
  }
  SparseModel whole = whole_;
  PutPartBack(part_, renamed, &whole);
  Check(whole);
  for (const auto& [id, point] : whole_.points3D) {
    ASSERT_EQ(whole.points3D.count(id), 1u);
    const SparsePoint& now = whole.points3D.at(id);
    EXPECT_GE(now.track.size(), point.track.size());
    EXPECT_TRUE(now.track.size() > point.track.size() || IsSame(now, point));
  }
}

TEST_F(ContinuedPart, WhatTheMapperDroppedStays) {
  SparseModel grown = part_;
  grown.points3D.clear();
  for (PosedImage& image : grown.images)
    image.point3D_ids.assign(image.points2D.size(), kNoPoint3D);
  SparseModel whole = whole_;
  PutPartBack(part_, grown, &whole);
  EXPECT_EQ(whole.points3D.size(), whole_.points3D.size());
  for (const auto& [id, point] : whole_.points3D) {
    EXPECT_TRUE(IsSame(point, whole.points3D.at(id)));
  }
}

// A picture got SI-SeaPoints behind its own, and a new picture shows one of them.
TEST_F(ContinuedPart, SeaPointsThatCameBehindCanBeSeen) {
  constexpr size_t kMore = 3;
  const auto with_more = [](SparseModel model) {
    for (PosedImage& image : model.images) {
      if (image.image_id > 8) continue;
      for (size_t k = 0; k < kMore; ++k) {
        image.points2D.emplace_back(10.5 + static_cast<double>(k), 20.5);
        image.point3D_ids.push_back(kNoPoint3D);
      }
    }
    return model;
  };
  const SparseModel part = with_more(part_);
  SparseModel grown = with_more(grown_);
  PosedImage& old_one = grown.images[4];
  PosedImage& new_one = grown.images[5];
  ASSERT_EQ(new_one.image_id, 9u);
  const auto idx = static_cast<uint32_t>(old_one.points2D.size() - 2);
  const auto free = static_cast<uint32_t>(
      std::find(new_one.point3D_ids.begin(), new_one.point3D_ids.end(), kNoPoint3D) -
      new_one.point3D_ids.begin());
  if (free == new_one.points2D.size()) {
    new_one.points2D.emplace_back(1.5, 1.5);
    new_one.point3D_ids.push_back(kNoPoint3D);
  }
  const uint64_t id = grown.points3D.rbegin()->first + 1;
  old_one.point3D_ids[idx] = new_one.point3D_ids[free] = id;
  grown.points3D[id].track = {{8, idx}, {9, free}};
  SparseModel whole = whole_;
  PutPartBack(part, grown, &whole);
  Check(whole);
  for (size_t i = 0; i < 8; ++i) {
    const size_t were = whole_.images[i].points2D.size();
    EXPECT_EQ(whole.images[i].points2D.size(), i < 3 ? were : were + kMore) << i;
  }
  const uint64_t taken = whole.images[7].point3D_ids[idx];
  ASSERT_NE(taken, kNoPoint3D);
  EXPECT_EQ(whole.points3D.at(taken).track.size(), 2u);
}

}  // namespace
}  // namespace colmap_seapoint
