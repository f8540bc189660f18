#include "densify/sequence/pair_selection.h"

#include <algorithm>
#include <cmath>

#include "densify/sequence/covisibility.h"

namespace colmap_seapoint {

namespace {

constexpr double kMinOverlap = 0.1;  // between `first` and the second picture of the next pair
constexpr int kMaxSecondTries = 4;   // pictures tried as the second one of a pair
constexpr double kMinParallaxDeg = 1;
constexpr double kMaxParallaxDeg = 30;   // a wider pair is not preferred: it sees two surfaces
constexpr double kMinSharedShare = 0.6;  // of the first picture, in the preferred second one

struct SecondCandidate {
  int position;
  double parallax_deg;  // median, of the points shared with the first picture
};

// In the order in which they are tried.
std::vector<SecondCandidate> SecondCandidates(const SparseModel& model, const Track& track,
                                              int first, bool prefer_wide) {
  std::vector<SecondCandidate> candidates;
  const int end = std::min(track.Length(), first + 1 + kMaxSecondTries);
  for (int second = first + 1; second < end; ++second) {
    candidates.push_back(
        {second, MedianParallaxDeg(model, track.Image(first), track.Image(second))});
  }
  if (!prefer_wide) return candidates;
  const auto wide = std::stable_partition(
      candidates.begin(), candidates.end(), [&](const SecondCandidate& candidate) {
        return candidate.parallax_deg <= kMaxParallaxDeg &&
               SharedShare(model, track.Image(first), track.ViewOf(candidate.position)) >=
                   kMinSharedShare;
      });
  std::stable_sort(candidates.begin(), wide,
                   [](const auto& a, const auto& b) { return a.parallax_deg > b.parallax_deg; });
  return candidates;
}

}  // namespace

SecondChoice SelectSecond(const SparseModel& model, const Track& track, int first,
                          const SecondRules& rules, PictureCache* pictures) {
  const int first_idx = track.ImageIdx(first), right = track.RightOf(first);
  if (right >= 0) pictures->Prefetch(track.ImageIdx(right));
  if (!pictures->Get(first_idx)) return {-1, "the picture cannot be read"};
  if (right >= 0 && pictures->Get(track.ImageIdx(right))) return {right, ""};
  std::string why_none = "no following picture matches it";
  for (const auto& [second, parallax] : SecondCandidates(model, track, first, rules.prefer_wide)) {
    const int second_idx = track.ImageIdx(second);
    if (!pictures->Get(second_idx)) continue;
    const auto matches = pictures->GetMatches(first_idx, second_idx);
    if (static_cast<int>(matches->size()) < rules.min_num_seeds) continue;
    const double motion =
        MeanMotion(pictures->GetSeaPoints(first_idx)->points,
                   pictures->GetSeaPoints(second_idx)->points, *matches, track.LongerSide(first));
    if (motion >= rules.min_mean_motion && parallax >= kMinParallaxDeg) return {second, ""};
    why_none = "the viewpoint hardly changes in the pictures that follow";
  }
  return {-1, why_none};
}

NextChoice SelectNext(const Track& track, int first, int second, double max_overlap,
                      const std::function<double(int)>& overlap) {
  const int length = track.Length();
  const bool is_simultaneous = second == track.RightOf(first);
  NextChoice next;
  if (is_simultaneous) {
    next.position = SelectNextStereoFirst(first, length, max_overlap, overlap);
  } else if (second == length - 1 && track.RightOf(second) >= 0) {
    next.position = second;  // the last picture of the track adds its own simultaneous pair
  } else {
    next.position = SelectNextFirst(second, length, max_overlap, overlap);
  }
  const int passed_over = (is_simultaneous ? first : second) + 1;
  for (int skipped = passed_over; skipped < std::min(next.position, length - 1); ++skipped) {
    next.passed_over.push_back(skipped);
  }
  return next;
}

double MeanMotion(const std::vector<SeaPoint>& points1, const std::vector<SeaPoint>& points2,
                  const FeatureMatches& matches, double longer_side) {
  if (matches.empty()) return 0;
  double sum = 0;
  for (const FeatureMatch& match : matches) {
    const SeaPoint& a = points1[match.idx1];
    const SeaPoint& b = points2[match.idx2];
    sum += std::hypot(static_cast<double>(b.x) - a.x, static_cast<double>(b.y) - a.y);
  }
  return sum / static_cast<double>(matches.size()) / longer_side;
}

int SelectNextFirst(int second, int num_pictures, double max_overlap,
                    const std::function<double(int)>& overlap) {
  const int last = num_pictures - 1;
  if (second >= last) return num_pictures;
  int candidate = second + 1;
  while (candidate < last && overlap(candidate) > max_overlap) ++candidate;
  // The last picture cannot start a pair: it completes the pair of the one before it.
  if (candidate == last) return last - 1;
  return overlap(candidate + 1) < kMinOverlap ? candidate - 1 : candidate;
}

int SelectNextStereoFirst(int first, int num_pictures, double max_overlap,
                          const std::function<double(int)>& overlap) {
  const int last = num_pictures - 1;
  for (int candidate = first + 1; candidate <= last; ++candidate) {
    const double rate = overlap(candidate);
    if (rate > max_overlap && candidate < last) continue;
    return rate < kMinOverlap && candidate > first + 1 ? candidate - 1 : candidate;
  }
  return num_pictures;
}

}  // namespace colmap_seapoint
