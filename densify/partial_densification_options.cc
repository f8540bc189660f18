#include "densify/partial_densification_options.h"

namespace colmap_seapoint {

void PartialDensificationOptions::Bind(OptionTable* table) {
  const std::string group = "PartialDensification.";
  table->Add(group + "mode", &mode,
             "partial: only what is new; complete: the same pairs, each in full", "paper 3",
             {"partial", "complete"});
  table->Add(group + "redundancy", &redundancy,
             "against the previous pair only, or against every earlier view of the same place",
             "paper 2.5 (sequential), ours (all)", {"sequential", "all"});
  table->Add(group + "max_overlap", &max_overlap,
             "overlap with the previous pair above which a picture is passed over, share of it",
             "paper 2.5", 0, 1);
  table->Add(group + "step", &step,
             "a sample every so many pixels; 0 = about 0.75 million samples a picture", "ours", 0,
             64);
  table->Add(group + "window_size", &window_size, "correlation window, pixels, odd", "ours", 5, 15);
  table->Add(group + "min_zncc", &min_zncc, "smallest correlation of a match", "ours", 0, 1);
  table->Add("min_confidence", &min_confidence,
             "smallest confidence of a point, the probability that it lies within two ground "
             "sampling distances of the surface; less is not written",
             "ours", 0, 1);
  table->Add(group + "influence_radius", &influence_radius,
             "radius of a SeaPoint's influence area, share of the picture's longer side",
             "paper 2.5", 0.001, 0.5);
  table->Add(group + "max_expansion", &max_expansion,
             "how far matches spread from a seed, share of the picture's longer side", "paper 2.6",
             0.001, 1);
  table->Add(group + "min_mean_motion", &min_mean_motion,
             "smallest mean norm of the match vectors of a pair, share of the longer side",
             "paper 2.6", 0, 1);
  table->Add(group + "min_num_seeds", &min_num_seeds, "matches that a pair needs", "ours", 1,
             100000);
  table->Add(group + "completion", &completion,
             "after the sequence, densify what two pictures see and no pair has covered", "ours");
  table->Add(group + "write_debug", &write_debug,
             "draw every pair's figures (paper, Figures 10, 11, 13, 15, 17) into "
             "OUTPUT_PATH/debug",
             "ours");
  table->Add(group + "write_maps", &write_maps,
             "make OUTPUT_PATH a dense workspace of COLMAP: undistorted pictures, their model, and "
             "the cloud as every picture's depth and normal map",
             "ours");
}

std::string PartialDensificationOptions::Check() const {
  if (window_size % 2 == 0) {
    return "PartialDensification.window_size is " + std::to_string(window_size) +
           ", it must be odd";
  }
  return "";
}

DensificationMode PartialDensificationOptions::Mode() const {
  return mode == "complete" ? DensificationMode::kComplete : DensificationMode::kPartial;
}

Redundancy PartialDensificationOptions::AgainstWhat() const {
  return redundancy == "all" ? Redundancy::kAll : Redundancy::kSequential;
}

}  // namespace colmap_seapoint
