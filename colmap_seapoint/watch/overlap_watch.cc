#include "colmap_seapoint/watch/overlap_watch.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace colmap_seapoint {
namespace {

// One of them may be blurred, or show a fish.
constexpr size_t kNumLast = 3;

std::string Percent(double share) { return std::to_string(std::lround(100 * share)) + " %"; }

std::string WarningOf(const std::string& name, double overlap, const std::string& last_name) {
  if (overlap >= kLeastOverlap) return "";
  if (overlap > 0) {
    return name + " overlaps the last pictures by " + Percent(overlap) + " only, of " +
           Percent(kLeastOverlap) + " that are needed: slow down, or take the strips closer";
  }
  return name + " shows nothing of the last pictures: go back to what " + last_name +
         " shows, and go on from there more slowly";
}

}  // namespace

NewOverlap OverlapWatch::Add(const std::string& name, const GrayImage& picture) {
  NewOverlap found;
  FrameView view = ViewOf(picture);
  found.is_first = last_.empty();
  for (const Seen& seen : last_) {
    found.overlap = std::max(found.overlap, OverlapOf(seen.view, view));
  }
  if (!found.is_first) found.warning = WarningOf(name, found.overlap, last_.back().name);
  last_.push_back({name, std::move(view)});
  if (last_.size() > kNumLast) last_.pop_front();
  return found;
}

}  // namespace colmap_seapoint
