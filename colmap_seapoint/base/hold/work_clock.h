// The clock of work: without the time in which nothing could be done. What machines take for a job,
// and what is left of it, is told by it; not by a lid that was closed for the night.
#pragma once

namespace colmap_seapoint {

// Seconds of work since the program began; never less than before, whatever becomes of the clock on
// the wall. Those do not count in which the machine slept, all work was paused (work_pause.h), or,
// while somebody beats, the process was stopped (SIGSTOP, a frozen container). From any thread.
double WorkSeconds();

// That the process is not stopped, said at least once a second. A beat that comes more than
// kStandstillSeconds after the last one tells that it was. kBeatsEnd: no more are to come.
inline constexpr double kStandstillSeconds = 5;
enum class Beat { kNow, kBeatsEnd };
void TellWorkClock(Beat beat);

// Of the pause that begins or ends now: work_pause.cc's.
void SetWorkClockPaused(bool is_paused);

}  // namespace colmap_seapoint
