#include "colmap_seapoint/report/difference_files.h"

#include <cmath>
#include <string>

#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/image/image_file.h"

namespace colmap_seapoint {
namespace {

constexpr int kPictureWidth = 1000;  // pixels
constexpr int kMaxPictureHeight = 1500;
constexpr std::array<uint8_t, 3> kBeyondColor = {255, 0, 255};

}  // namespace

void DifferenceFiles::Begin(const CompareSetup& setup) {
  CheckWritableDir(folder_);
  scale_ = setup.comparison.distances.back();
  max_distance_ = setup.comparison.max_distance;
  const std::string comment = "distance to the other cloud; red from " + std::to_string(scale_) +
                              " on, magenta beyond " + std::to_string(max_distance_);
  input_.cloud = std::make_unique<DistanceCloudWriter>(folder_ / "input_to_reference.ply",
                                                       setup.comparison.input.num_points,
                                                       setup.input_fits_float, comment);
  reference_.cloud = std::make_unique<DistanceCloudWriter>(folder_ / "reference_to_input.ply",
                                                           setup.comparison.reference.num_points,
                                                           setup.reference_fits_float, comment);
  for (Side* side : {&input_, &reference_}) {
    side->picture = std::make_unique<PlanPicture>(setup.view, kPictureWidth, kMaxPictureHeight);
  }
}

void DifferenceFiles::Add(bool of_input, const PointVector& points,
                          const std::vector<double>& squared) {
  const Side& side = of_input ? input_ : reference_;
  for (size_t i = 0; i < points.size(); ++i) {
    const bool beyond = std::isinf(squared[i]);
    const double distance = beyond ? max_distance_ : std::sqrt(squared[i]);
    const auto color = beyond ? kBeyondColor : RampColor(distance / scale_);
    side.cloud->Add(points[i], color, distance);
    side.picture->Add(points[i], color);
  }
}

void DifferenceFiles::Finish() {
  input_.cloud->Finish();
  reference_.cloud->Finish();
  WriteImage(folder_ / "differences.png",
             StackPictures(input_.picture->Picture(), reference_.picture->Picture()));
}

}  // namespace colmap_seapoint
