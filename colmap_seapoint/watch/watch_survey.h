// automatic_reconstructor, with --watch or without.
#pragma once

#include "colmap_seapoint/base/run_options.h"
#include "colmap_seapoint/pipeline/reconstruct_options.h"

namespace colmap_seapoint {

// With --watch: round after round, as pictures come into the folder, a coarse answer of all that
// are there, in <workspace>/watch (live_survey.h); at the end, when Ctrl-C or --watch_idle says
// that no more will come, what a run without --watch makes. A round that fails is said, and the
// next one tries again. Else that alone. Throws as RunAutomaticReconstructor does.
CommandResult ReconstructOrWatch(const AutomaticReconstructorOptions& options);

}  // namespace colmap_seapoint
