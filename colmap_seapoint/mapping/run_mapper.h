// The unmodified `colmap mapper` as a stage: database -> sparse models (ours; the paper hands its
// matches to COLMAP in the same way).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "colmap_seapoint/mapping/colmap_program.h"

namespace colmap_seapoint {

// Raise it whenever the same database and options give other models than before
// (tests/mapping/mapper_version_test.cc watches).
inline constexpr char kMapperVersion[] = "16";

// Whose the lens is.
enum class LensRule {
  kFind,           // ours to find: held while models grow, then adjusted (adjust_lens.h)
  kHold,           // given: held by the mapper and by us, who adjust the rest
  kLeaveToMapper,  // the user decides what the mapper refines, and its models stay as they are
};

struct MapperJob {
  std::filesystem::path database_path;
  std::filesystem::path image_path;
  std::string mask_path;              // COLMAP's masks (picture_masks.h); empty = none
  std::filesystem::path output_path;  // the caller's own: emptied; holds 0/, 1/ ... afterwards
  std::filesystem::path log_folder;   // gets mapper_1_thinned.log, mapper_1.log ...
  // Where given, the global mapper is tried first; the first round proper is then left out when
  // that registers all pictures.
  std::optional<MapperOptions> global_round;
  // True: the first round is tried with fewer matches before it is tried with all of them
  // (tracks/thinned_database.h), and of a large survey with the lens of a pilot (lens_pilot.h).
  bool thins_matches = false;
  // Where given, the pictures that are not in it are added to this model, whose poses and lenses
  // stay (add_pictures.h), before all else is tried; what it takes is taken.
  std::optional<std::filesystem::path> continued_model;
  // Where given, the first round is tried with these before it is tried as it is (initial_pair.h).
  std::optional<MapperOptions> initial_pair_round;
  MapperOptions first_round;
  MapperOptions later_rounds;
  LensRule lens = LensRule::kFind;
  bool adjusts_principal_point = true;
  bool joins_models = true;           // join_rounds.h
  int num_threads = 1;                // of our adjustment; -1 = all cores; never changes a result
  std::vector<std::string> pictures;  // those that have a verified pair
};

// Maps all pictures; then, in further rounds, those that are in no model yet, as long as a round
// finds one: the models of all rounds are numbered on. When the first round leaves pictures over,
// or a lens that cannot be adjusted soundly, it is tried with a free distortion too, then in
// COLMAP's way of dropping small models and beginning anew, and the better trial counts: the one
// with more pictures that their own matches do not contradict, then the one with the smaller error.
// The trials of the global mapper, of thinned matches and of the given initial pair are compared in
// the same way; one picture in 50 may be left over before another trial is made. Models of fewer
// than 50 points are not taken. Throws Error when the mapper or the triangulator fails in a trial
// that has no model to fall back on, or no round finds a model, UsageError when the mapper refuses
// an option's value.
void RunMapper(const ColmapProgram& colmap, const MapperJob& job);

}  // namespace colmap_seapoint
