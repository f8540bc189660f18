// One pair of the sequence or of the completion pass: from its positions on the track to its row of
// pairs.csv. Internal.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "densify/densify_pair.h"
#include "densify/overlap/pair_overlap.h"
#include "densify/sequence_context.h"

namespace colmap_seapoint {

struct PairTask {
  int first, second;  // positions
  std::string pass;   // "sequence" or "completion"
  PairOverlap overlap;
  std::vector<PixelPair> seeds;
  double min_confidence;  // of its points
};

struct PairOutcome {
  PairReport row;
  PairResult result;
};

// Seeds from the intrapair matches outside the overlap area (no labels: from all), and from the
// model's points (paper 2.6; the latter ours).
std::vector<PixelPair> FormSeeds(const SequenceContext& context, int first, int second,
                                 const std::vector<SeaPointLabel>& labels);

// A picture that cannot be read is a failure like any other: the row says so.
PairOutcome RunPair(const SequenceContext& context, const PairTask& task);

// The pair's row goes to the report; if it gave something, its cloud to the sink, its footprint
// into memory, and its figures to whoever draws them.
void Deliver(const SequenceContext& context, const PairTask& task, const PairOutcome& pair,
             SequenceMemory* memory, SequenceReport* report);

// A picture that starts no pair, and why.
PairReport SkippedRow(const SequenceContext& context, int first, const std::string& why);

}  // namespace colmap_seapoint
