// What a scaling says of itself: on stdout, in scale.json and as a table.
#pragma once

#include <filesystem>
#include <string>

#include "colmap_seapoint/georeference/estimate_similarity.h"
#include "colmap_seapoint/georeference/scale_measurements.h"

namespace colmap_seapoint {

// Scale with its standard deviation, frame, residual of every measurement (the 20 largest of
// many), outliers.
std::string ScaleText(const ScaleMeasurements& measurements, const SimilarityEstimate& estimate);

// One line for a summary: "scale 1.234 +- 0.001; positions 18 of 20, rms 0.05 m".
std::string ScaleLine(const SimilarityEstimate& estimate);

// scale.json: the similarity, and all residuals. Atomic.
void WriteScaleJson(const std::filesystem::path& path, const ScaleMeasurements& measurements,
                    const SimilarityEstimate& estimate);

// kind,name,used,dx_m,dy_m,dz_m,residual_m,sigma_m,model_length,length_m: one row a measurement,
// residuals model minus measured; empty fields where they mean nothing. Atomic.
void WriteScaleCsv(const std::filesystem::path& path, const ScaleMeasurements& measurements,
                   const SimilarityEstimate& estimate);

}  // namespace colmap_seapoint
