#include "colmap_seapoint/report/reconstruction_summary.h"

#include <gtest/gtest.h>

namespace colmap_seapoint {
namespace {

TEST(SummaryTextTest, PicturesModelsCloudsAndTimes) {
  RunReport report;
  report.images_in = 9;
  report.images_used = 7;
  report.points = 1234567;
  report.cameras = {"camera 1 (1000x750): 9 pictures; focal length 900 px guessed"};
  report.left_out = {{"img8.jpg", "is in no model"}, {"zero.png", "is empty"}};
  report.stages = {{"mapper", 61.2, 60.0}, {"partial_densifier 0", 5.4, 9.0}};
  ModelSummary metric;
  metric.name = "0";
  metric.pictures = {"a", "b", "c", "d"};
  metric.densification.pairs = 3;
  metric.densification.points = 1234567;
  metric.cloud_path = "ws/dense/0/fused.ply";
  metric.units = "metres, local";
  metric.completeness = "96.7 % covered";
  metric.scaling = "scale 1.5 +- 0.01";
  ModelSummary empty;
  empty.name = "1";
  empty.pictures = {"e", "f", "g"};
  EXPECT_EQ(SummaryText({metric, empty}, report),
            "7 of 9 pictures used, 2 models, 1234567 points\n"
            "camera 1 (1000x750): 9 pictures; focal length 900 px guessed\n"
            "model 0: 4 pictures, 3 pairs, 1234567 points in ws/dense/0/fused.ply\n"
            "  metres, local (scale 1.5 +- 0.01)\n"
            "  completeness: 96.7 % covered\n"
            "model 1: 3 pictures, 0 pairs, 0 points\n"
            "  units arbitrary\n"
            "left out: img8.jpg: is in no model\n"
            "left out: zero.png: is empty\n"
            "mapper: 1 min 01 s\n"
            "partial_densifier 0: 5.4 s\n");
}

TEST(SummaryTextTest, OneModel) {
  RunReport report;
  report.images_in = report.images_used = 3;
  EXPECT_EQ(SummaryText({ModelSummary()}, report).find("3 of 3 pictures used, 1 model, 0 points\n"),
            0u);
}

}  // namespace
}  // namespace colmap_seapoint
