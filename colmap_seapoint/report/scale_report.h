// What a scaling says of itself: on stdout, in scale.json and as a table.
#pragma once

#include <filesystem>
#include <string>

#include "colmap_seapoint/georeference/estimate_similarity.h"
#include "colmap_seapoint/georeference/scale_measurements.h"

namespace colmap_seapoint {

// For a person: the scale with its standard deviation, the frame, the residual of every measurement
// (of more than 20 positions, the 20 largest), and which of them are outliers.
std::string ScaleText(const ScaleMeasurements& measurements, const SimilarityEstimate& estimate);

// One line for a summary: "scale 1.234 +- 0.001; positions 18 of 20, rms 0.05 m (not b.jpg: 52 m
// off)".
std::string ScaleLine(const ScaleMeasurements& measurements, const SimilarityEstimate& estimate);

// scale.json: the similarity, and all residuals. Atomic.
void WriteScaleJson(const std::filesystem::path& path, const ScaleMeasurements& measurements,
                    const SimilarityEstimate& estimate);

inline constexpr char kScaleCsvHeader[] =
    "kind,name,used,dx_m,dy_m,dz_m,residual_m,sigma_m,model_length,length_m";

// kScaleCsvHeader, then one row a measurement.
// Residuals are model minus measured; a field is empty where it means nothing. Atomic.
void WriteScaleCsv(const std::filesystem::path& path, const ScaleMeasurements& measurements,
                   const SimilarityEstimate& estimate);

}  // namespace colmap_seapoint
