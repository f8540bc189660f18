// What a round of the mapper tries, one after the other, until a trial is good enough.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "colmap_seapoint/mapping/continued_part.h"
#include "colmap_seapoint/mapping/mapper_process.h"
#include "colmap_seapoint/mapping/run_mapper.h"

namespace colmap_seapoint {

inline constexpr char kMapper[] = "mapper";

struct TrialPlan {
  std::string name;  // of its folder and log, behind the round's
  std::string command = kMapper;
  std::filesystem::path database_path;
  std::filesystem::path continued_model;     // whose pictures and lenses stay; empty: none
  std::filesystem::path part_path;           // of it the part that the mapper is given
  PicturesToAdd added;                       // to it; without names, nothing ties any to it
  std::filesystem::path triangulation_path;  // the database whose matches become the points
  MapperOptions options;
  bool holds_distortion = false;  // by the options
  // It differs from COLMAP's plain trial in nothing but that the distortion is free: no other trial
  // where that one could not hold it.
  bool frees_distortion = false;
  bool must_succeed = false;                // when no trial before it found a model
  std::function<void(TrialPlan*)> prepare;  // before it is run; may be empty
};

// The model that is to be continued, where the job names one; the global mapper, thinned matches,
// an initial pair of ours (where the job asks for them), COLMAP as it is, with a wide lens where
// nothing is known of the lens, with a free distortion, and with small models dropped. `folder`:
// exists; what thinned matches need is put there when their turn comes. The plans refer to `colmap`
// and `job`.
std::vector<TrialPlan> PlanFirstRound(const ColmapProgram& colmap, const MapperJob& job,
                                      const std::filesystem::path& folder);

std::vector<TrialPlan> PlanLaterRound(const ColmapProgram& colmap, const MapperJob& job);

// The plan as a call of the mapper. All pictures.
MapperCall CallOf(const MapperJob& job, const TrialPlan& plan,
                  const std::filesystem::path& output_path, const std::string& log_name);

}  // namespace colmap_seapoint
