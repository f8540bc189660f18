#include "feature/retrieval/seapoint_retrieval.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "colmap_seapoint/base/parallel.h"
#include "feature/descriptor/rbrief_descriptor.h"
#include "feature/descriptor/rbrief_pattern.h"

namespace colmap_seapoint {
namespace {

constexpr int kSide = 1000;          // of a picture, pixels
constexpr int kPointsPerSide = 400;  // SeaPoints in a square of the ground as large as a picture
constexpr double kTurn = 2 * 3.14159265358979323846;

// A ground of SeaPoints, long and as wide as a picture, with descriptors of its own.
class Ground {
 public:
  Ground(int num_sides, unsigned seed) : random_(seed) {
    for (int i = 0; i < num_sides * kPointsPerSide; ++i) {
      SeaPoint point;
      point.x = static_cast<float>(Uniform(0, num_sides * kSide));
      point.y = static_cast<float>(Uniform(0, kSide));
      point.orientation = static_cast<float>(Uniform(-3, 3));
      features_.points.push_back(point);
      features_.descriptors.push_back(RandomDescriptor());
    }
  }

  Descriptor RandomDescriptor() {
    Descriptor descriptor;
    for (uint8_t& byte : descriptor) byte = static_cast<uint8_t>(random_());
    return descriptor;
  }

  // What a camera sees that stands over x = `begin` and is turned by `turn`, in a random order:
  // three in four of the points, each with up to 45 bits wrong, and as many others.
  Features Picture(double begin, double turn) {
    const double c = std::cos(turn), s = std::sin(turn), half = 0.5 * kSide;
    Features picture;
    for (size_t i = 0; i < features_.points.size(); ++i) {
      const double x = features_.points[i].x - begin - half, y = features_.points[i].y - half;
      SeaPoint point = features_.points[i];
      point.x = static_cast<float>(c * x - s * y + half + Uniform(-1, 1));
      point.y = static_cast<float>(s * x + c * y + half + Uniform(-1, 1));
      point.orientation += static_cast<float>(turn + Uniform(-0.25, 0.25));
      if (point.x < 0 || point.y < 0 || point.x >= kSide || point.y >= kSide) continue;
      if (random_() % 4 == 0) continue;
      const auto steps = static_cast<int>(std::lround(turn / kTurnStep));
      Append(point, Flipped(TurnDescriptor(features_.descriptors[i], steps)), &picture);
      Append({static_cast<float>(Uniform(0, kSide)), static_cast<float>(Uniform(0, kSide)), 1,
              static_cast<float>(Uniform(-3, 3))},
             RandomDescriptor(), &picture);
    }
    return picture;
  }

  static void Append(const SeaPoint& point, const Descriptor& descriptor, Features* features) {
    features->points.push_back(point);
    features->descriptors.push_back(descriptor);
  }

 private:
  double Uniform(double min, double max) {
    return std::uniform_real_distribution<double>(min, max)(random_);
  }

  Descriptor Flipped(Descriptor descriptor) {
    for (unsigned i = random_() % 46; i > 0; --i) {
      const size_t bit = random_() % 256;
      descriptor[bit / 8] = static_cast<uint8_t>(descriptor[bit / 8] ^ (1u << (bit % 8)));
    }
    return descriptor;
  }

  std::mt19937 random_;
  Features features_;
};

// Pictures along the ground, a quarter of a side apart: neighbours overlap by 75, 50 and 25 %.
// Every second one is upside down.
std::vector<Features> Survey(int count, unsigned seed) {
  Ground ground(count / 4 + 2, seed);
  std::vector<Features> pictures;
  for (int i = 0; i < count; ++i) {
    pictures.push_back(ground.Picture(0.25 * kSide * i, i % 2 == 0 ? 0 : kTurn / 2));
  }
  return pictures;
}

SeaPointIndex MakeIndex(const std::vector<Features>& pictures, int num_threads = 1) {
  std::vector<Descriptor> sample;
  size_t num_points = 0;
  for (const Features& picture : pictures) {
    AppendSample(picture, &sample);
    num_points += picture.points.size();
  }
  SeaPointIndex index(SeaPointVocabulary(sample, NumWordsFor(num_points), 0), num_points);
  std::vector<SeaPointIndex::Picture> entries(pictures.size());
  ParallelFor(num_threads, static_cast<int64_t>(pictures.size()), [&](int64_t i) {
    entries[static_cast<size_t>(i)] = index.MakeEntries(pictures[static_cast<size_t>(i)]);
  });
  for (const SeaPointIndex::Picture& picture : entries) index.Add(picture);
  index.Finish();
  return index;
}

std::vector<std::vector<RetrievedPicture>> QueryAll(const std::vector<Features>& pictures,
                                                    size_t max_count, int min_score,
                                                    int num_threads = 1) {
  const SeaPointIndex index = MakeIndex(pictures, num_threads);
  std::vector<std::vector<RetrievedPicture>> all(pictures.size());
  ParallelFor(num_threads, static_cast<int64_t>(pictures.size()), [&](int64_t i) {
    const auto self = static_cast<uint32_t>(i);
    all[self] = index.Query(pictures[self], {self}, max_count, min_score);
  });
  return all;
}

int Apart(size_t a, uint32_t b) { return std::abs(static_cast<int>(a) - static_cast<int>(b)); }

TEST(SeaPointIndex, FindsThePicturesThatOverlap) {
  const auto pictures = Survey(80, 1);
  const auto all = QueryAll(pictures, 6, 4);
  int num_wanted = 0, num_found = 0;
  for (size_t i = 0; i < all.size(); ++i) {
    for (uint32_t other = 0; other < pictures.size(); ++other) {
      if (other == i || Apart(i, other) > 3) continue;
      ++num_wanted;
      num_found += std::count_if(all[i].begin(), all[i].end(),
                                 [&](const RetrievedPicture& one) { return one.picture == other; });
    }
    for (size_t k = 0; k < all[i].size(); ++k) {
      EXPECT_NE(all[i][k].picture, i);
      EXPECT_LE(all[i][k].score, all[i][k > 0 ? k - 1 : 0].score);
      // Chance stays far below.
      EXPECT_TRUE(all[i][k].score < 10 || Apart(i, all[i][k].picture) <= 3) << i;
    }
    ASSERT_FALSE(all[i].empty());
    EXPECT_LE(Apart(i, all[i][0].picture), 2) << i;
  }
  EXPECT_GE(num_found, num_wanted * 95 / 100);
}

TEST(SeaPointIndex, LeavesOutWhatIsExcluded) {
  const auto pictures = Survey(20, 3);
  const SeaPointIndex index = MakeIndex(pictures);
  const auto found = index.Query(pictures[10], {9, 10, 11}, 2, 1);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(std::set<uint32_t>({found[0].picture, found[1].picture}), std::set<uint32_t>({8, 12}));
  EXPECT_EQ(index.Query(pictures[10], {10}, 1, 1).size(), 1u);
  EXPECT_TRUE(index.Query(pictures[10], {10}, 5, 100000).empty());
}

TEST(SeaPointIndex, SameForAnyNumberOfThreads) {
  const auto pictures = Survey(30, 4);
  const auto one = QueryAll(pictures, 10, 1, 1);
  EXPECT_EQ(one, QueryAll(pictures, 10, 1, 4));
  EXPECT_EQ(one, QueryAll(pictures, 10, 1, 3));
}

TEST(SeaPointIndex, SameForAnyOrderOfThePictures) {
  const auto pictures = Survey(30, 5);
  std::vector<uint32_t> order(pictures.size());  // place in the other order -> picture
  for (uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::mt19937 random(1);
  std::shuffle(order.begin(), order.end(), random);
  std::vector<Features> shuffled;
  for (const uint32_t picture : order) shuffled.push_back(pictures[picture]);
  const auto straight = QueryAll(pictures, 1000, 1), mixed = QueryAll(shuffled, 1000, 1);
  for (size_t i = 0; i < order.size(); ++i) {
    std::map<uint32_t, int> expected, actual;
    for (const RetrievedPicture& one : straight[order[i]]) expected[one.picture] = one.score;
    for (const RetrievedPicture& one : mixed[i]) actual[order[one.picture]] = one.score;
    EXPECT_EQ(actual, expected) << order[i];
    EXPECT_GE(expected.size(), 3u);
  }
}

TEST(SeaPointIndex, NoPictureAndOnePicture) {
  EXPECT_TRUE(QueryAll({}, 10, 1).empty());
  EXPECT_TRUE(MakeIndex({}).Query(Survey(1, 6)[0], {}, 10, 1).empty());
  EXPECT_TRUE(QueryAll(Survey(1, 6), 10, 1)[0].empty());
}

TEST(SeaPointIndex, EmptyPicturesAreLikeNothing) {
  auto pictures = Survey(8, 7);
  pictures[0] = pictures[3] = pictures[7] = Features();
  const auto all = QueryAll(pictures, 10, 1);
  for (size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].empty(), pictures[i].points.empty());
    for (const RetrievedPicture& one : all[i]) EXPECT_FALSE(pictures[one.picture].points.empty());
  }
  EXPECT_TRUE(QueryAll(std::vector<Features>(5), 10, 1)[2].empty());
}

// One texture everywhere: no word tells anything, and the time does not explode.
TEST(SeaPointIndex, AlikeDescriptorsSayNothing) {
  auto pictures = Survey(20, 8);
  for (Features& picture : pictures) {
    for (Descriptor& descriptor : picture.descriptors)
      descriptor.fill(0xff);  // however it is turned
  }
  for (const auto& found : QueryAll(pictures, 10, 1)) EXPECT_TRUE(found.empty());
  // A single point each is below every limit: it is found, and by its own kind.
  std::vector<Features> few(3);
  for (Features& picture : few) Ground::Append(SeaPoint{5, 5, 1, 0}, Descriptor{}, &picture);
  const auto found = QueryAll(few, 10, 1);
  ASSERT_EQ(found[1].size(), 2u);
  EXPECT_EQ(found[1][0].picture, 0u);
  EXPECT_EQ(found[1][0].score, 1);
}

TEST(SeaPointVocabulary, HasTheWordsAskedFor) {
  Ground ground(1, 9);
  std::vector<Descriptor> sample;
  for (int i = 0; i < 5000; ++i) sample.push_back(ground.RandomDescriptor());
  const SeaPointVocabulary vocabulary(sample, 500, 0);
  EXPECT_GE(vocabulary.NumWords(), 400u);
  EXPECT_LE(vocabulary.NumWords(), 600u);
  std::map<uint32_t, int> sizes;
  for (const Descriptor& descriptor : sample) {
    const auto words = vocabulary.NearestWords(descriptor);
    EXPECT_EQ(words[0], vocabulary.NearestWord(descriptor));
    EXPECT_NE(words[0], words[1]);
    EXPECT_LT(std::max(words[0], words[1]), vocabulary.NumWords());
    ++sizes[words[0]];
  }
  EXPECT_EQ(sizes.size(), vocabulary.NumWords());
  for (const auto& [word, size] : sizes) EXPECT_LE(size, 100) << word;

  std::reverse(sample.begin(), sample.end());
  const SeaPointVocabulary reversed(sample, 500, 0), other(sample, 500, 1);
  int num_other = 0;
  for (const Descriptor& descriptor : sample) {
    EXPECT_EQ(reversed.NearestWords(descriptor), vocabulary.NearestWords(descriptor));
    num_other += other.NearestWord(descriptor) != vocabulary.NearestWord(descriptor) ? 1 : 0;
  }
  EXPECT_GT(num_other, 0) << "the seed does not matter";
}

TEST(SeaPointVocabulary, OneWordWhereAllIsAlike) {
  const Descriptor descriptor = {};
  for (const size_t count : {0, 1, 1000}) {
    const SeaPointVocabulary vocabulary(std::vector<Descriptor>(count, descriptor), 100, 0);
    EXPECT_EQ(vocabulary.NumWords(), 1u);
    EXPECT_EQ(vocabulary.NearestWords(descriptor), (std::array<uint32_t, 2>{0, 0}));
  }
}

}  // namespace
}  // namespace colmap_seapoint
