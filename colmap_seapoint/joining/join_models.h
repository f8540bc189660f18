// Two models of one survey become one, or stay two with the reason (ours).
//
// COLMAP's mapper leaves several models where no picture could be added to one by itself, though
// many pictures of one may be tied to many of the other. A wrong join is worse than two models: so
// the links must agree on one similarity, lie in several pictures, leave no gap where they should
// be (link_evidence.h), and bear the adjustment of both models as one.
#pragma once

#include <optional>
#include <string>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"

namespace colmap_seapoint {

struct JoinOptions {
  bool refine_lens = true;  // false: lenses are the user's
  bool refine_principal_point = true;
  int num_threads = 1;  // -1 = all; never changes a result
};

struct JoinedModel {
  std::optional<SparseModel> model;  // adjusted; nullopt: they stay apart
  std::string outcome;               // one clause: by how many points, or why not
};

// `a` should be the smaller one: the joined model lies in b's frame and begins with b's lenses.
// Taken when, after the adjustment, the points that both see are no worse than one and a half times
// the others (medians; half a pixel is always good enough), and four in five of them lie within
// four times that. Throws Error when the database cannot be read. Cost: that of one bundle
// adjustment, and of reading the pairs between them. The same bytes for any number of threads.
JoinedModel JoinModels(const ColmapDatabase& database, const SparseModel& a, const SparseModel& b,
                       const JoinOptions& options);

}  // namespace colmap_seapoint
