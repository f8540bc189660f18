// Where the pictures must have been that are in no model: by their neighbours on the track.
#pragma once

#include <string>
#include <vector>

#include "densify/completeness/sight/survey_views.h"

namespace colmap_seapoint {

// Pictures that follow one another, none of them in any model, between two that are in this one.
struct LostRun {
  std::vector<std::string> names;
  // image_idx; -1: the track begins or ends with them, or goes on in another model.
  int before = -1, after = -1;
};

// `registered`, `lost`, `elsewhere` (in another model): names of pictures; those of one folder, in
// natural order, are one track. `registered` is in the order of the model's images.
std::vector<LostRun> FindLostRuns(const std::vector<std::string>& registered,
                                  const std::vector<std::string>& lost,
                                  const std::vector<std::string>& elsewhere);

// What a run may have seen. A few pictures between two neighbours are placed on the way from one to
// the other. Of a longer run no more is said than "somewhere between A and B": all that lies nearer
// to the straight line between the two than a picture is wide. At an open end, one picture's width
// around it.
class LostSight {
 public:
  // `footprint`: width of a picture on the ground, units.
  LostSight(const std::vector<LostRun>& runs, const std::vector<SurveyView>& views,
            double footprint);
  // The first run that may have seen the place; -1: none.
  int RunThatSaw(const Eigen::Vector3d& place) const;

 private:
  struct Reach {
    int run;
    Eigen::Vector3d from, to;          // camera centres
    Eigen::Vector3d axis;              // of the cameras, mean
    double radius;                     // about the line, across the axis
    std::vector<SurveyView> pictures;  // placed; empty: by the radius
  };
  std::vector<Reach> reaches_;
};

}  // namespace colmap_seapoint
