// Pictures that nothing ties to the others, matched by views from above (ours; see
// feature/tilted_view.h).
#pragma once

#include <functional>
#include <map>
#include <string>

#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "feature/detector/seapoint_detector.h"
#include "feature/match_features.h"

namespace colmap_seapoint {

// Behind the fingerprint of a picture that has got SeaPoints of views, the others being as before.
inline constexpr char kTiltedMark[] = ":tilted views";
// Raise it whenever the same pictures and options give other ties than before.
inline constexpr char kTiltedPairsVersion[] = "1";
// The tilts that are worth trying: what a view is drawn wrong by, up to some 15 degrees, matches.
inline constexpr double kTiltsDeg[] = {40, 55};

struct MaskedPicture {
  GrayImage picture, mask;  // the mask may be empty
};

struct TiltedPairsJob {
  double tilt_deg = 0;
  // The pictures to be tried, by image_id, with the group that they are tied to by now.
  std::map<uint32_t, uint32_t> groups;
  std::function<MaskedPicture(const std::string& name)> read;  // from several threads at once
  SeaPointExtractionOptions extraction;
  SeaPointMatchingOptions matching;
  int num_threads = 1;
};

// Matches the views of the pairs that were tried and whose pictures are in different groups; where
// two groups are tied so, by 100 verified matches at least, the pictures that tie them are also
// matched with those of their own group, so that what ties them is triangulated. Only adds: the
// SeaPoints that are matched so stand behind the pictures' own, and their matches behind the pairs'
// own, which are verified again as a whole; a pair that would lose by that stays as it is. Returns
// the number of pairs that were tied. The caller holds the transaction. What `read` throws is
// thrown on: these pictures were read before, and a disk that fails must not lead to other ties.
// The same rows for any number of threads. Cost: 0.1 CPU s a picture, 0.02 a pair; memory: 0.5 MB a
// picture.
int64_t TieByTiltedViews(const TiltedPairsJob& job, ColmapDatabase* database);

}  // namespace colmap_seapoint
