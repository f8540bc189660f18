#include "densify/sequence/pair_selection.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "densify/sequence/covisibility.h"

namespace colmap_seapoint {

namespace {

constexpr double kMinOverlap = 0.1;  // between `first` and the second picture of the next pair
constexpr int kMaxSecondTries = 4;   // pictures tried as the second one of a pair
constexpr int kMaxWalk = 150;        // pictures from the same place that are passed on the way
constexpr double kMinParallaxDeg = 1;

// What needs no search: nothing without the first picture, and its simultaneous right one.
std::optional<SecondChoice> ChoiceWithoutSearch(const Track& track, int first,
                                                PictureCache* pictures) {
  const int right = track.RightOf(first);
  if (right >= 0) pictures->Prefetch(track.ImageIdx(right));
  if (!pictures->Get(track.ImageIdx(first))) return {{-1, "the picture cannot be read"}};
  if (right >= 0 && pictures->Get(track.ImageIdx(right))) return {{right, ""}};
  return std::nullopt;
}

enum class SecondFitness { kFits, kSamePlace, kNoMatch };

SecondFitness FitnessOf(const SparseModel& model, const Track& track, int first, int second,
                        const SecondRules& rules, PictureCache* pictures) {
  const int first_idx = track.ImageIdx(first), second_idx = track.ImageIdx(second);
  const auto parallax = MedianParallaxDeg(model, track.Image(first), track.Image(second));
  if (parallax && *parallax < kMinParallaxDeg) return SecondFitness::kSamePlace;
  if (!pictures->Get(second_idx)) return SecondFitness::kNoMatch;
  const auto matches = pictures->GetMatches(first_idx, second_idx);
  if (!parallax || static_cast<int>(matches->size()) < rules.min_num_seeds) {
    return SecondFitness::kNoMatch;
  }
  const double motion =
      MeanMotion(pictures->GetSeaPoints(first_idx)->points,
                 pictures->GetSeaPoints(second_idx)->points, *matches, track.LongerSide(first));
  return motion >= rules.min_mean_motion ? SecondFitness::kFits : SecondFitness::kSamePlace;
}

}  // namespace

SecondChoice SelectSecond(const SparseModel& model, const Track& track, int first,
                          const SecondRules& rules, PictureCache* pictures) {
  if (const auto choice = ChoiceWithoutSearch(track, first, pictures)) return *choice;
  std::string why_none = "no following picture matches it";
  int num_tries = 0;
  const int end = std::min(track.Length(), first + 1 + kMaxSecondTries + kMaxWalk);
  for (int second = first + 1; second < end && num_tries < kMaxSecondTries; ++second) {
    switch (FitnessOf(model, track, first, second, rules, pictures)) {
      case SecondFitness::kFits:
        return {second, ""};
      case SecondFitness::kSamePlace:
        why_none = "the viewpoint hardly changes in the pictures that follow";
        break;
      case SecondFitness::kNoMatch:
        ++num_tries;
    }
  }
  return {-1, why_none};
}

SecondChoice SelectBestSecond(const Track& track, int first, const std::vector<int>& ranked,
                              int min_num_seeds, PictureCache* pictures) {
  if (const auto choice = ChoiceWithoutSearch(track, first, pictures)) return *choice;
  std::string why_none = "no other picture sees what is new in it at an angle that measures depth";
  for (const int second : ranked) {
    if (!pictures->Get(track.ImageIdx(second))) continue;
    int num_seeds = NumSharedPoints(track.Image(first), track.Image(second));
    if (num_seeds < min_num_seeds) {
      num_seeds += static_cast<int>(
          pictures->GetMatches(track.ImageIdx(first), track.ImageIdx(second))->size());
    }
    if (num_seeds >= min_num_seeds) return {second, ""};
    why_none = "too few matches with the pictures that see what is new in it";
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

double MaxCoveredShare(bool between_last_pair, double max_overlap) {
  return between_last_pair ? 0.5 * max_overlap : max_overlap;
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
