#include "densify/completeness/completeness_options.h"

namespace colmap_seapoint {

void CompletenessOptions::Bind(OptionTable* table) {
  table->Add("Completeness.spacing", &spacing,
             "units of the model between points that make a place covered; 0 = the survey's ground "
             "sampling distance times the step",
             "ours", 0, 1e9);
  table->Add("Completeness.step", &step,
             "pixels between samples of a picture, as the cloud was made; 0 = about 0.75 million "
             "samples a picture",
             "ours", 0, 64);
  table->Add("Completeness.min_confidence", &min_confidence,
             "points below it cover nothing; clouds without confidence have 1", "ours", 0, 1);
  table->Add("Completeness.min_parallax", &min_parallax_deg,
             "degrees that two pictures must see a place apart", "ours", 0.1, 45);
  table->Add("Completeness.forward_overlap", &forward_overlap,
             "of the passes that are proposed, with the next picture", "ours", 0.3, 0.95);
  table->Add("Completeness.side_overlap", &side_overlap,
             "of the passes that are proposed, with the next line", "ours", 0.1, 0.9);
}

}  // namespace colmap_seapoint
