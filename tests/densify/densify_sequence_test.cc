#include "densify/densify_sequence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <random>
#include <set>

#include "colmap_seapoint/base/error.h"
#include "densify/pair_debug.h"
#include "tests/synthetic/world.h"

namespace colmap_seapoint {
namespace {

constexpr double kDepth = 2;
constexpr int kNumPictures = 9;

// A strip over a seabed with a step across and a block on it, 80 % forward overlap; landmarks are
// its SeaPoints and its triangulated points, the same descriptor in every picture.
class Strip : public PictureSource {
 public:
  explicit Strip(int num_pictures = kNumPictures) : world_(Seabed()) {
    const Camera camera = MildCamera(CameraModel::kOpenCV, 210, 240, 180);
    model_.cameras[1] = camera;
    std::mt19937 generator(4);
    std::uniform_real_distribution<double> jitter(-1, 1);
    for (int i = 0; i < num_pictures; ++i) {
      const double advance = 0.2 * 240 * kDepth / 210;  // a fifth of a picture
      viewpoints_.push_back(
          StandAt(camera, {advance * i, 0.03 * jitter(generator), 0.03 * jitter(generator)},
                  {2 * jitter(generator), 2 * jitter(generator), 5 * jitter(generator)}));
      pictures_.push_back(TakePicture(world_, viewpoints_.back()));
    }
    AddImages();
    AddLandmarks();
  }

  ColorImage ReadColor(int image_idx) override {
    if (image_idx == unreadable_) throw Error("a.jpg", "is cut short", "copy it again");
    const std::lock_guard<std::mutex> lock(mutex_);
    ++num_decoded[image_idx];
    return pictures_[static_cast<size_t>(image_idx)];
  }
  std::optional<Features> ReadSeaPoints(int image_idx) override {
    if (!stores_seapoints) return std::nullopt;
    return features_[static_cast<size_t>(image_idx)];
  }
  // Knows the picture by its pixels.
  Features FindSeaPoints(const GrayImage& picture) override {
    ++num_found;
    for (size_t i = 0; i < pictures_.size(); ++i) {
      const GrayImage gray = GrayOf(pictures_[i]);
      size_t same = 0;
      while (same < gray.data.size() && std::abs(gray.data[same] - picture.data[same]) <= 1) ++same;
      if (same == gray.data.size()) return features_[i];
    }
    ADD_FAILURE() << "no picture of the strip";
    return {};
  }
  std::optional<FeatureMatches> ReadMatches(int image_idx1, int image_idx2) override {
    ++num_asked[{std::min(image_idx1, image_idx2), std::max(image_idx1, image_idx2)}];
    if (!stores_matches) return std::nullopt;
    --num_matched;
    return Match(features_[static_cast<size_t>(image_idx1)],
                 features_[static_cast<size_t>(image_idx2)]);
  }
  FeatureMatches Match(const Features& features1, const Features& features2) override {
    ++num_matched;
    std::map<Descriptor, uint32_t> second;
    for (uint32_t j = 0; j < features2.points.size(); ++j) second[features2.descriptors[j]] = j;
    FeatureMatches matches;
    for (uint32_t i = 0; i < features1.points.size(); ++i) {
      const auto found = second.find(features1.descriptors[i]);
      if (found != second.end()) matches.push_back({i, found->second});
    }
    return matches;
  }

  void MakeUnreadable(int image_idx) { unreadable_ = image_idx; }
  const SparseModel& Model() const { return model_; }
  const World& GetWorld() const { return world_; }

  bool stores_seapoints = true, stores_matches = true;
  std::map<int, int> num_decoded;                // by image_idx
  std::map<std::pair<int, int>, int> num_asked;  // by image_idx, smaller first
  int num_found = 0, num_matched = 0;            // SeaPoints, matches: not stored ones

 private:
  static World Seabed() {
    const NoiseTexture texture(42, 0.16, 4);
    return World({{{0, 0, kDepth}, {50, 0, 0}, {0, 50, 0}},
                  {{1.2, 0.1, 1.75}, {0.2, 0, 0}, {0, 0.2, 0}},
                  {{2.6, 0, 1.8}, {0.3, 0, 0}, {0, 5, 0}}},
                 texture);
  }

  // Names whose natural order differs from both file order and alphabet: picture10 before picture9
  // in the alphabet, and the model lists them backwards.
  void AddImages() {
    const size_t count = viewpoints_.size();
    std::vector<Viewpoint> viewpoints(viewpoints_.rbegin(), viewpoints_.rend());
    std::vector<ColorImage> pictures(pictures_.rbegin(), pictures_.rend());
    viewpoints_ = viewpoints;
    pictures_ = pictures;
    for (size_t i = 0; i < count; ++i) {
      PosedImage image;
      image.image_id = static_cast<uint32_t>(11 + i);
      image.camera_id = 1;
      image.name = "picture" + std::to_string(5 + count - 1 - i) + ".jpg";
      image.cam_from_world = viewpoints_[i].cam_from_world;
      model_.images.push_back(image);
    }
    features_.resize(count);
  }

  void AddLandmarks() {
    std::mt19937 generator(6);
    std::uniform_real_distribution<double> x(-1, 5), y(-1.2, 1.2);
    for (uint64_t id = 1; id <= 3000; ++id) {
      const auto point = world_.Cast({x(generator), y(generator), 0}, {0, 0, 1});
      Descriptor descriptor{};
      std::memcpy(descriptor.data(), &id, sizeof(id));
      SparsePoint landmark;
      landmark.xyz = *point;
      for (size_t i = 0; i < viewpoints_.size(); ++i) {
        const auto pixel = PixelOf(world_, viewpoints_[i], *point);
        if (!pixel) continue;
        SeaPoint sea_point;
        sea_point.x = static_cast<float>(pixel->x());
        sea_point.y = static_cast<float>(pixel->y());
        features_[i].points.push_back(sea_point);
        features_[i].descriptors.push_back(descriptor);
        PosedImage& image = model_.images[i];
        landmark.track.push_back({image.image_id, static_cast<uint32_t>(image.points2D.size())});
        image.points2D.push_back(*pixel);
        image.point3D_ids.push_back(id);
      }
      if (landmark.track.size() >= 2) {
        model_.points3D[id] = landmark;
      } else {
        for (const auto& element : landmark.track) {
          model_.images[element.image_id - 11].point3D_ids.back() = kNoPoint3D;
        }
      }
    }
  }

  World world_;
  std::vector<Viewpoint> viewpoints_;
  std::vector<ColorImage> pictures_;
  std::vector<Features> features_;
  SparseModel model_;
  int unreadable_ = -1;
  std::mutex mutex_;
};

struct Outcome {
  SequenceReport report;
  std::vector<PartialCloud> clouds;

  int64_t NumPoints() const {
    int64_t count = 0;
    for (const PartialCloud& cloud : clouds) count += static_cast<int64_t>(cloud.points.size());
    return count;
  }
};

Outcome Densify(Strip* strip, const PartialDensificationOptions& options, int num_threads = 2,
                const std::function<void(const PairDebug&)>& debug = nullptr) {
  Outcome outcome;
  int64_t last_done = -1;
  SequenceCallbacks callbacks;
  callbacks.sink = [&](const PartialCloud& cloud) { outcome.clouds.push_back(cloud); };
  callbacks.progress = [&](int64_t done, int64_t total) {
    EXPECT_GT(done, last_done);
    EXPECT_LE(done, total);
    last_done = done;
  };
  callbacks.debug = debug;
  outcome.report = DensifySequence(strip->Model(), strip, options, num_threads, callbacks);
  return outcome;
}

// Squares of the ground, four GSD wide, that hold a point within two GSD of the surface.
std::set<std::pair<int, int>> CoveredSquares(const Strip& strip, const Outcome& outcome) {
  const double gsd = kDepth / 210;
  std::set<std::pair<int, int>> squares;
  for (const PartialCloud& cloud : outcome.clouds) {
    for (const DensePoint& point : cloud.points) {
      if (strip.GetWorld().Distance(point.xyz.cast<double>()) > 2 * gsd) continue;
      squares.insert({static_cast<int>(std::floor(point.xyz.x() / (4 * gsd))),
                      static_cast<int>(std::floor(point.xyz.y() / (4 * gsd)))});
    }
  }
  return squares;
}

double ShareOnSurface(const Strip& strip, const Outcome& outcome) {
  int64_t num_good = 0;
  for (const PartialCloud& cloud : outcome.clouds) {
    for (const DensePoint& point : cloud.points) {
      num_good += strip.GetWorld().Distance(point.xyz.cast<double>()) <= 4 * kDepth / 210;
    }
  }
  return static_cast<double>(num_good) / static_cast<double>(outcome.NumPoints());
}

Strip& TestStrip() {
  static Strip strip;
  return strip;
}

TEST(DensifySequenceTest, PartialCoversWhatCompleteCoversWithFewerPoints) {
  Strip& strip = TestStrip();
  PartialDensificationOptions options;
  const Outcome partial = Densify(&strip, options);
  options.mode = "complete";
  const Outcome complete = Densify(&strip, options);
  const auto partial_squares = CoveredSquares(strip, partial);
  const auto complete_squares = CoveredSquares(strip, complete);
  int64_t num_both = 0;
  for (const auto& square : complete_squares) {
    num_both += static_cast<int64_t>(partial_squares.count(square));
  }
  const double coverage =
      static_cast<double>(num_both) / static_cast<double>(complete_squares.size());
  const double points =
      static_cast<double>(partial.NumPoints()) / static_cast<double>(complete.NumPoints());
  EXPECT_GE(coverage, 0.98);
  EXPECT_LT(points, 0.35);
  EXPECT_GE(ShareOnSurface(strip, partial), 0.98);
  EXPECT_TRUE(partial.report.left_out.empty());
}

TEST(DensifySequenceTest, SequentialRedundancyWorksToo) {
  Strip& strip = TestStrip();
  PartialDensificationOptions options;
  options.redundancy = "sequential";
  const Outcome sequential = Densify(&strip, options);
  options.mode = "complete";
  const Outcome complete = Densify(&strip, options);
  const double coverage = static_cast<double>(CoveredSquares(strip, sequential).size()) /
                          static_cast<double>(CoveredSquares(strip, complete).size());
  EXPECT_GE(coverage, 0.9);
  EXPECT_LT(sequential.NumPoints(), 0.9 * static_cast<double>(complete.NumPoints()));
}

TEST(DensifySequenceTest, ReportAddsUp) {
  Strip& strip = TestStrip();
  const Outcome outcome = Densify(&strip, PartialDensificationOptions());
  EXPECT_EQ(outcome.report.num_points, outcome.NumPoints());
  std::map<std::pair<int, int>, int64_t> points_of_pair;
  for (const PartialCloud& cloud : outcome.clouds) {
    points_of_pair[{cloud.image_idx1, cloud.image_idx2}] +=
        static_cast<int64_t>(cloud.points.size());
  }
  int64_t sum = 0;
  for (const PairReport& pair : outcome.report.pairs) {
    sum += pair.num_points;
    if (pair.num_points > 0) {
      EXPECT_EQ((points_of_pair[{pair.image_idx1, pair.image_idx2}]), pair.num_points);
    }
    if (pair.skipped.empty()) {
      EXPECT_GT(pair.baseline, 0.1);
      EXPECT_GT(pair.num_seeds, 4);
    }
  }
  EXPECT_EQ(sum, outcome.report.num_points);
  // In the order of the names: the last image of the model is the first of the strip.
  EXPECT_EQ(outcome.report.pairs[0].image_idx1, kNumPictures - 1);
  EXPECT_EQ(outcome.report.pairs[0].image_idx2, kNumPictures - 2);
  EXPECT_EQ(outcome.report.pairs[0].overlap, 0);
  EXPECT_EQ(outcome.report.pairs[0].num_oa, 0);
}

void ExpectSameClouds(const Outcome& one, const Outcome& other) {
  ASSERT_EQ(one.clouds.size(), other.clouds.size());
  ASSERT_GT(one.NumPoints(), 30000);
  for (size_t c = 0; c < one.clouds.size(); ++c) {
    ASSERT_EQ(one.clouds[c].points.size(), other.clouds[c].points.size());
    for (size_t i = 0; i < one.clouds[c].points.size(); ++i) {
      const DensePoint &a = one.clouds[c].points[i], &b = other.clouds[c].points[i];
      ASSERT_TRUE(a.xyz == b.xyz && a.normal == b.normal && a.rgb == b.rgb);
    }
  }
}

TEST(DensifySequenceTest, SameCloudsWithAnyNumberOfThreads) {
  Strip strip(4);
  const Outcome one = Densify(&strip, PartialDensificationOptions(), 1);
  const Outcome five = Densify(&strip, PartialDensificationOptions(), 5);
  ExpectSameClouds(one, five);
}

// What is stored is not worked out again, no pair is asked for twice, no picture decoded twice.
TEST(DensifySequenceTest, EveryPictureAndPairOnceInTheSequence) {
  for (const std::string redundancy : {"sequential", "all"}) {
    PartialDensificationOptions options;
    options.redundancy = redundancy;
    options.completion = false;
    Strip stored, found;
    found.stores_seapoints = found.stores_matches = false;
    const Outcome of_stored = Densify(&stored, options);
    const Outcome of_found = Densify(&found, options);
    for (const Strip* strip : {&stored, &found}) {
      EXPECT_GE(strip->num_asked.size(), 8u);
      for (const auto& [pair, count] : strip->num_asked) {
        EXPECT_EQ(count, 1) << pair.first << ", " << pair.second;
      }
      EXPECT_EQ(strip->num_decoded.size(), static_cast<size_t>(kNumPictures));
      for (const auto& [image_idx, count] : strip->num_decoded) EXPECT_EQ(count, 1) << image_idx;
    }
    EXPECT_EQ(stored.num_found, 0);
    EXPECT_EQ(stored.num_matched, 0);
    EXPECT_EQ(found.num_found, kNumPictures);
    EXPECT_EQ(found.num_matched, static_cast<int>(found.num_asked.size()));
    ExpectSameClouds(of_stored, of_found);
  }
}

// The same clouds with figures as without, and figures that fit the report.
TEST(DensifySequenceTest, DebugShowsWhatHappened) {
  for (const std::string redundancy : {"sequential", "all"}) {
    PartialDensificationOptions options;
    options.redundancy = redundancy;
    Strip strip(6);
    const Outcome plain = Densify(&strip, options);
    int num_shown = 0, num_with_previous = 0;
    int64_t num_normal = 0;
    const Outcome shown = Densify(&strip, options, 2, [&](const PairDebug& pair) {
      EXPECT_EQ(pair.partial->cloud.points.size(), static_cast<size_t>(pair.report.num_points));
      EXPECT_EQ(pair.view1.image_idx, pair.report.image_idx1);
      EXPECT_EQ(pair.view2.image_idx, pair.report.image_idx2);
      ++num_shown;
      num_normal += static_cast<int64_t>(pair.normal.cloud.points.size());
      if (pair.previous_color == nullptr) return;
      ++num_with_previous;
      EXPECT_EQ(pair.report.pass, "sequence");
      EXPECT_EQ(pair.labels1.size(), pair.points1->size());
      EXPECT_EQ(pair.previous_labels.size(), pair.previous_points->size());
      EXPECT_GT(pair.interpair.size(), 100u);
      if (redundancy == "sequential") {
        EXPECT_EQ(pair.mask.OverlapRate(), pair.report.overlap);
      }
      EXPECT_EQ(pair.covered_range.empty(), redundancy == "sequential");
    });
    ExpectSameClouds(plain, shown);
    EXPECT_EQ(num_shown, static_cast<int>(shown.clouds.size()));
    EXPECT_GE(num_with_previous, 1);
    EXPECT_GT(num_normal, shown.NumPoints());
  }
}

TEST(DensifySequenceTest, UnreadablePictureIsLeftOutAndTheRestGoesOn) {
  Strip& strip = TestStrip();
  const Outcome whole = Densify(&strip, PartialDensificationOptions());
  for (const int position : {0, 1, 4, kNumPictures - 1}) {
    const int image_idx = kNumPictures - 1 - position;
    strip.MakeUnreadable(image_idx);
    const Outcome damaged = Densify(&strip, PartialDensificationOptions());
    strip.MakeUnreadable(-1);
    ASSERT_EQ(damaged.report.left_out.size(), 1u) << position;
    EXPECT_EQ(damaged.report.left_out[0].image_idx, image_idx);
    EXPECT_EQ(damaged.report.left_out[0].reason, "is cut short");
    for (const PairReport& pair : damaged.report.pairs) {
      // Another picture completes the pair instead.
      EXPECT_TRUE(pair.pass != "sequence" || pair.image_idx2 != image_idx) << position;
    }
    for (const PartialCloud& cloud : damaged.clouds) {
      EXPECT_NE(cloud.image_idx1, image_idx);
      EXPECT_NE(cloud.image_idx2, image_idx);
    }
    const double coverage = static_cast<double>(CoveredSquares(strip, damaged).size()) /
                            static_cast<double>(CoveredSquares(strip, whole).size());
    EXPECT_GT(coverage, 0.85) << position;
  }
}

TEST(DensifySequenceTest, NothingToDensify) {
  for (const int num_pictures : {0, 1}) {
    Strip strip(num_pictures);
    const Outcome outcome = Densify(&strip, PartialDensificationOptions());
    EXPECT_TRUE(outcome.clouds.empty());
    EXPECT_EQ(outcome.report.num_points, 0);
  }
}

TEST(DensifySequenceTest, WithoutMatchesEveryPictureIsSkippedWithAReason) {
  class NoMatches : public Strip {
   public:
    NoMatches() : Strip(4) {}
    std::optional<FeatureMatches> ReadMatches(int, int) override { return FeatureMatches(); }
  };
  NoMatches strip;
  PartialDensificationOptions options;
  options.completion = false;
  const Outcome outcome = Densify(&strip, options);
  EXPECT_TRUE(outcome.clouds.empty());
  ASSERT_EQ(outcome.report.pairs.size(), 3u);
  for (const PairReport& pair : outcome.report.pairs) {
    EXPECT_EQ(pair.skipped, "no following picture matches it");
    EXPECT_EQ(pair.image_idx2, -1);
  }
}

}  // namespace
}  // namespace colmap_seapoint
