#include "colmap_seapoint/watch/picture_arrivals.h"

#include <gtest/gtest.h>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

class PictureArrivalsTest : public testing::Test {
 protected:
  // The names of those that are whole now, with the second in which each was seen first.
  std::vector<std::pair<std::string, double>> Look(double now) {
    std::vector<std::pair<std::string, double>> found;
    arrivals_.Look(now, [&](const Arrival& arrival, const ColorImage& picture) {
      found.emplace_back(arrival.name, arrival.seconds);
      has_pixels_ = !picture.Empty();
    });
    return found;
  }
  using Found = std::vector<std::pair<std::string, double>>;

  std::string BytesOfPicture(int index) const {
    WriteImage(scratch_ / "picture.jpg", StripPicture(index));
    return ReadBytes(scratch_ / "picture.jpg");
  }

  TemporaryFolder folder_, scratch_;
  PictureArrivals arrivals_{folder_.Path()};
  bool has_pixels_ = false;
};

TEST_F(PictureArrivalsTest, OneComesWhenItIsSteady) {
  Look(1);
  WriteBytes(folder_ / "a.jpg", BytesOfPicture(0));
  EXPECT_EQ(Look(2), Found{});
  EXPECT_EQ(Look(3), (Found{{"a.jpg", 2}}));
  EXPECT_TRUE(has_pixels_);
  EXPECT_EQ(Look(4), Found{});
}

TEST_F(PictureArrivalsTest, HalfAPictureWaitsForItsRest) {
  Look(1);
  const std::string bytes = BytesOfPicture(0);
  WriteBytes(folder_ / "a.jpg", bytes.substr(0, bytes.size() / 2));
  for (double now = 2; now < 6; ++now) EXPECT_EQ(Look(now), Found{});
  EXPECT_EQ(arrivals_.Waiting(), std::vector<std::string>{"a.jpg"});
  WriteBytes(folder_ / "a.jpg", bytes);
  EXPECT_EQ(Look(6), Found{});
  EXPECT_EQ(Look(7), (Found{{"a.jpg", 2}}));
  EXPECT_EQ(arrivals_.Waiting(), std::vector<std::string>{});
}

TEST_F(PictureArrivalsTest, AChangedOneComesAgainAndABurstTogether) {
  Look(1);
  WriteBytes(folder_ / "a.jpg", BytesOfPicture(0));
  WriteBytes(folder_ / "b.jpg", BytesOfPicture(1));
  WriteBytes(folder_ / "notes.txt", "none of them");
  Look(2);
  EXPECT_EQ(Look(3), (Found{{"a.jpg", 2}, {"b.jpg", 2}}));
  WriteBytes(folder_ / "b.jpg", BytesOfPicture(5));
  Look(4);
  EXPECT_EQ(Look(5), (Found{{"b.jpg", 4}}));
}

TEST_F(PictureArrivalsTest, ADiskThatIsPulledIsNoEmptySurvey) {
  WriteBytes(folder_ / "a.jpg", BytesOfPicture(0));
  Look(0);
  EXPECT_EQ(Look(1), (Found{{"a.jpg", 0}}));
  fs::rename(folder_ / "a.jpg", scratch_ / "a.jpg");
  EXPECT_THROW(Look(2), Error);
  fs::rename(scratch_ / "a.jpg", folder_ / "a.jpg");
  EXPECT_EQ(Look(3), Found{});
}

}  // namespace
}  // namespace colmap_seapoint
