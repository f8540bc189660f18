// What a long job consists of, for those who tell how far it is: every counted part of it
// (progress.h) says which kind of work it is, and one observer makes one estimate of all.
#pragma once

#include <cstdint>
#include <string>

namespace colmap_seapoint {

// In the order in which a reconstruction does it.
enum class Work : int {
  kIntake,         // HEIC and RAW decoded; seconds of video looked through
  kPictures,       // SeaPoints of pictures
  kLookAlikes,     // pictures that look like one another
  kPairs,          // matches of pairs
  kMarkers,        // pictures looked through for coded markers
  kTiltedViews,    // views from above of pictures that nothing ties to the others
  kRegistration,   // pictures put into a model by COLMAP's mapper
  kRefinement,     // models adjusted and measured again; its steps are of no known number
  kJoining,        // models tried to be made one
  kDensification,  // steps of the densifier
  kMaps,           // depth maps
  kOrthomosaic,    // pictures that a map is made of
  kCompleteness,   // pictures looked at for what is missing, and the cloud twice as many steps
  kOther,          // nothing that is planned
};
inline constexpr int kNumWorks = static_cast<int>(Work::kOther) + 1;

// Called from several threads at once.
class WorkObserver {
 public:
  virtual ~WorkObserver() = default;
  // `already_done` of `total` were finished by an earlier run. The same kind may begin again.
  virtual void Begin(Work work, const std::string& label, int64_t total, int64_t already_done) = 0;
  virtual void Advance(Work work, int64_t done) = 0;
  virtual void End(Work work) = 0;
  // What a person is told now: what is done, the share of the whole job, the time left.
  virtual std::string Line() = 0;
  // Seconds after which another line is worth reading.
  virtual double SecondsBetweenLines() = 0;
};

// The one that all work is told to from now on; nullptr: none, each part then speaks for itself.
// Not to be called while a Progress lives.
void SetWorkObserver(WorkObserver* of_all_work);

}  // namespace colmap_seapoint
