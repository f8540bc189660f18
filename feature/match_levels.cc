#include "feature/match_levels.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "feature/feature_levels.h"
#include "feature/matching/overlap_share.h"
#include "feature/matching/two_view_verification.h"

namespace colmap_seapoint {
namespace {

// Part of a picture's SeaPoints, as a picture of its own.
struct Part {
  Camera camera;
  Features features;
  uint32_t begin = 0;    // index of its first SeaPoint in the whole picture
  double reduction = 1;  // pixels of the whole picture a pixel of its own
};

Part FinestPart(const Camera& camera, const Features& features) {
  return {camera, Slice(features, 0, NumFinest(features)), 0, 1};
}

// In pixels of its own finest level: SeaPoints lie right to a share of those.
Part CoarsePart(const Camera& camera, const Features& features) {
  const size_t begin = CoarsestRunBegin(features);
  Part part = {camera, Slice(features, begin, features.points.size()), static_cast<uint32_t>(begin),
               features.points[begin].scale};
  if (part.reduction == 1) return part;
  const auto reduced = [&](int size) {
    return std::max(1, static_cast<int>(std::lround(size / part.reduction)));
  };
  part.camera = ScaledCamera(camera, reduced(camera.width), reduced(camera.height));
  for (SeaPoint& point : part.features.points) {
    point.x *= static_cast<float>(part.camera.width) / static_cast<float>(camera.width);
    point.y *= static_cast<float>(part.camera.height) / static_cast<float>(camera.height);
  }
  return part;
}

MatchedPair MatchOneLevel(const Camera& camera1, const Features& features1, const Camera& camera2,
                          const Features& features2, const SeaPointMatchingOptions& options,
                          double min_overlap_share) {
  MatchedPair pair = MatchFeatures(camera1, features1, camera2, features2, options);
  if (min_overlap_share > 0 &&
      OverlapShare(features1.points, features2.points, pair.geometry.inliers) < min_overlap_share) {
    pair.geometry = TwoViewGeometry();
    pair.geometry.config = TwoViewConfig::kDegenerate;
  }
  return pair;
}

MatchedPair MatchParts(const Part& part1, const Part& part2, const SeaPointMatchingOptions& options,
                       double min_overlap_share) {
  MatchedPair pair = MatchOneLevel(part1.camera, part1.features, part2.camera, part2.features,
                                   options, min_overlap_share);
  for (FeatureMatches* matches : {&pair.matches, &pair.geometry.inliers}) {
    for (FeatureMatch& match : *matches) {
      match.idx1 += part1.begin;
      match.idx2 += part2.begin;
    }
  }
  return pair;
}

// One-to-one: where two contradict each other, the one of `first` stands. Sorted by idx1.
FeatureMatches Union(const FeatureMatches& first, const FeatureMatches& second, size_t num_points1,
                     size_t num_points2) {
  std::vector<bool> taken1(num_points1), taken2(num_points2);
  FeatureMatches all;
  for (const FeatureMatches* matches : {&first, &second}) {
    for (const FeatureMatch& match : *matches) {
      if (taken1[match.idx1] || taken2[match.idx2]) continue;
      taken1[match.idx1] = taken2[match.idx2] = true;
      all.push_back(match);
    }
  }
  std::sort(all.begin(), all.end(),
            [](const FeatureMatch& a, const FeatureMatch& b) { return a.idx1 < b.idx1; });
  return all;
}

bool HasLevels(const Features& features) { return NumFinest(features) < features.points.size(); }

}  // namespace

MatchedPair MatchLevels(const Camera& camera1, const Features& features1, const Camera& camera2,
                        const Features& features2, const SeaPointMatchingOptions& options,
                        double min_overlap_share) {
  if (!HasLevels(features1) && !HasLevels(features2)) {  // nearly all pairs: nothing is copied
    return MatchOneLevel(camera1, features1, camera2, features2, options, min_overlap_share);
  }
  MatchedPair pair = MatchParts(FinestPart(camera1, features1), FinestPart(camera2, features2),
                                options, min_overlap_share);
  if (!HasLevels(features1) || !HasLevels(features2)) return pair;
  const Part part1 = CoarsePart(camera1, features1), part2 = CoarsePart(camera2, features2);
  const MatchedPair coarse = MatchParts(part1, part2, options, min_overlap_share);
  const auto united = [&](const FeatureMatches& first, const FeatureMatches& second) {
    return Union(first, second, features1.points.size(), features2.points.size());
  };
  pair.matches = united(pair.matches, coarse.matches);
  if (coarse.geometry.inliers.empty()) return pair;

  TwoViewVerificationOptions verification = options.verification;
  verification.max_error *= std::max(part1.reduction, part2.reduction);
  TwoViewGeometry together =
      VerifyTwoViews(camera1, features1.points, camera2, features2.points,
                     united(pair.geometry.inliers, coarse.geometry.inliers), verification);
  if (together.inliers.size() > pair.geometry.inliers.size()) pair.geometry = std::move(together);
  return pair;
}

}  // namespace colmap_seapoint
