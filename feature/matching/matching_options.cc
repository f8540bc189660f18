#include "feature/matching/matching_options.h"

#include <string>

namespace colmap_seapoint {

void HammingMatcherOptions::Bind(OptionTable* table) {
  table->Add("SeaPointMatching.max_distance", &max_distance,
             "largest Hamming distance of a match, of 256 bits", "ours", 0, 256);
  table->Add("SeaPointMatching.max_ratio", &max_ratio,
             "largest ratio of nearest to second nearest distance; 1 = no test", "ours", 0.1, 1);
}

void SiftMatcherOptions::Bind(OptionTable* table) {
  table->Add("SeaPointMatching.max_sift_distance", &max_distance,
             "largest angle between the SIFT descriptors of a match, radians", "ours", 0, 1.5);
  table->Add("SeaPointMatching.max_sift_ratio", &max_ratio,
             "largest ratio of nearest to second nearest angle; 1 = no test", "ours", 0.1, 1);
}

void FlowFilterOptions::Bind(OptionTable* table) {
  const std::string group = "SeaPointMatching.";
  table->Add(group + "flow_num_neighbors", &num_neighbors,
             "nearest matches that vote on a match's vector", "ours", 1, 200);
  table->Add(group + "flow_min_votes", &min_votes, "votes that a match needs", "ours", 0, 200);
  table->Add(group + "flow_max_angle_deg", &max_angle_deg,
             "largest difference of direction that still votes, degrees", "ours", 0, 180);
  table->Add(group + "flow_max_norm_difference", &max_norm_difference,
             "largest difference of norm that still votes, share of the larger norm", "ours", 0, 1);
  table->Add(group + "flow_max_slip", &max_slip,
             "largest deviation of a match from the flow around it, pixels", "ours", 0, 1000);
  table->Add(group + "flow_max_slip_ratio", &max_slip_ratio,
             "or, if that is more, times the median deviation of the matches around it", "ours", 0,
             1000);
  table->Add(group + "flow_min_tolerance", &min_tolerance,
             "vectors nearer to each other than this always vote, pixels", "ours", 0, 1000);
}

void GuidedMatcherOptions::Bind(OptionTable* table) {
  const std::string group = "SeaPointMatching.";
  table->Add(group + "guided", &enabled,
             "look for unmatched SeaPoints where the verified matches around them say they are",
             "ours");
  table->Add(group + "guided_max_distance", &max_distance,
             "largest Hamming distance of a guided match, of 256 bits", "ours", 0, 256);
  table->Add(group + "guided_max_slip", &max_slip,
             "largest distance of a guided match from where the flow says it is, pixels", "ours", 0,
             1000);
  table->Add(group + "guided_max_slip_ratio", &max_slip_ratio,
             "or, if that is more, times the median deviation of the matches around it", "ours", 0,
             1000);
  table->Add(group + "guided_max_error", &max_error,
             "largest distance of a guided match from its epipolar line, pixels", "ours", 0, 100);
}

void TwoViewVerificationOptions::Bind(OptionTable* table) {
  const std::string group = "TwoViewGeometry.";
  table->Add(group + "min_num_inliers", &min_num_inliers, "verified matches that a pair needs",
             "COLMAP", 8, 100000);
  table->Add(group + "max_error", &max_error, "largest epipolar or transfer error, pixels",
             "COLMAP", 0.1, 100);
  table->Add(group + "max_homography_ratio", &max_homography_ratio,
             "share of inliers that a homography must explain for a pair to count as planar",
             "COLMAP", 0, 1);
}

void SeaPointMatchingOptions::Bind(OptionTable* table) {
  hamming.Bind(table);
  sift.Bind(table);
  flow.Bind(table);
  guided.Bind(table);
  verification.Bind(table);
}

}  // namespace colmap_seapoint
