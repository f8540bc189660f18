#include "colmap_seapoint/water/estimate_water.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "colmap_seapoint/base/median.h"
#include "colmap_seapoint/water/channel_fit.h"

namespace colmap_seapoint {
namespace {

constexpr float kOverexposed = 0.98f;
constexpr size_t kMinPlaces = 20;
constexpr double kMinSpan = 0.02;   // rms of a place's ranges about their mean, over the latter
constexpr double kMaxSigma = 0.1;   // of a times the median range: of a restored colour's logarithm
constexpr double kMaxNoise = 0.08;  // of a restored colour
constexpr double kMaxWhite = 50;
const Eigen::Array3d kLuminance(0.2126, 0.7152, 0.0722);  // of sRGB's primaries
constexpr double kGrey = 0.2159;                          // the light of the middle byte

Eigen::Array3d ColorOf(const WaterSample& sample) {
  return {sample.rgb[0], sample.rgb[1], sample.rgb[2]};
}

bool IsUsable(const WaterSample& sample) {
  if (!std::isfinite(sample.range) || !(sample.range > 0)) return false;
  if (!(sample.axis_cosine > 0 && sample.axis_cosine <= 1)) return false;
  return std::all_of(sample.rgb.begin(), sample.rgb.end(),
                     [](float value) { return value >= 0 && value < kOverexposed; });
}

// Whatever order they come in, they give one result.
void Sort(std::vector<WaterSample>* samples) {
  const auto key = [](const WaterSample& s) {
    return std::tie(s.place, s.picture, s.range, s.axis_cosine, s.rgb);
  };
  std::sort(samples->begin(), samples->end(),
            [&](const WaterSample& a, const WaterSample& b) { return key(a) < key(b); });
}

double MedianRange(const std::vector<WaterSample>& samples) {
  std::vector<double> ranges;
  for (const WaterSample& sample : samples) ranges.push_back(sample.range);
  return UpperMedian(std::move(ranges));
}

// Places that are seen twice or more: which samples, and how far their ranges span.
struct SeenTwice {
  std::vector<size_t> samples, place_end;
  double span = 0;
};

SeenTwice FindSeenTwice(const std::vector<WaterSample>& samples) {
  SeenTwice found;
  double squares = 0;
  for (size_t begin = 0, end = 0; begin < samples.size(); begin = end) {
    double sum = 0;
    while (end < samples.size() && samples[end].place == samples[begin].place) {
      sum += samples[end++].range;
    }
    if (end - begin < 2) continue;
    const double mean = sum / static_cast<double>(end - begin);
    for (size_t i = begin; i < end; ++i) {
      squares += std::pow(samples[i].range / mean - 1, 2);
      found.samples.push_back(i);
    }
    found.place_end.push_back(found.samples.size());
  }
  if (!found.samples.empty()) {
    found.span = std::sqrt(squares / static_cast<double>(found.samples.size()));
  }
  return found;
}

ChannelSamples SamplesOf(const std::vector<WaterSample>& samples, const SeenTwice& seen,
                         double median_range, const Eigen::Array3d& weights) {
  ChannelSamples channel;
  channel.place_end = seen.place_end;
  for (const size_t i : seen.samples) {
    channel.range.push_back(samples[i].range / median_range);
    channel.log_cosine.push_back(std::log(samples[i].axis_cosine));
    channel.light.push_back((weights * ColorOf(samples[i])).sum());
  }
  return channel;
}

WaterState FitWater(const std::vector<WaterSample>& samples, WaterModel* water,
                    Eigen::Array3d* noise) {
  const SeenTwice seen = FindSeenTwice(samples);
  if (seen.place_end.size() < kMinPlaces) return WaterState::kTooFewPlaces;
  if (seen.span < kMinSpan) return WaterState::kOneRange;
  const double median_range = MedianRange(samples);
  // Lens and lamps are the same for all channels: what differs is the water's.
  water->falloff = FitChannel(SamplesOf(samples, seen, median_range, kLuminance)).falloff;
  for (int c = 0; c < 3; ++c) {
    const Eigen::Array3d channel = Eigen::Vector3d::Unit(c).array();
    const ChannelFit fit =
        FitChannel(SamplesOf(samples, seen, median_range, channel), water->falloff);
    if (!(fit.attenuation_sigma <= kMaxSigma)) return WaterState::kUncertain;
    water->attenuation[c] = fit.attenuation / median_range;
    water->veil[c] = fit.veil;
    water->veil_rate[c] = fit.veil_rate / median_range;
    (*noise)[c] = fit.noise;
  }
  return WaterState::kDetermined;
}

// Grey is what the median of all samples is, restored.
Eigen::Array3d WhiteBalance(const std::vector<WaterSample>& samples, WaterModel water) {
  std::vector<double> channel(samples.size());
  water.max_gain.setConstant(std::numeric_limits<double>::infinity());
  Eigen::Array3d white;
  for (int c = 0; c < 3; ++c) {
    for (size_t i = 0; i < samples.size(); ++i) {
      channel[i] = static_cast<double>(Restore(water, ColorOf(samples[i]).cast<float>(),
                                               samples[i].range, samples[i].axis_cosine)[c]);
    }
    white[c] = std::clamp(kGrey / std::max(UpperMedian(channel), 1e-9), 1 / kMaxWhite, kMaxWhite);
  }
  return white;
}

}  // namespace

WaterModel EstimateWater(std::vector<WaterSample> samples) {
  samples.erase(std::remove_if(samples.begin(), samples.end(),
                               [](const WaterSample& sample) { return !IsUsable(sample); }),
                samples.end());
  WaterModel water;
  if (samples.empty()) return water;
  Sort(&samples);
  Eigen::Array3d noise = Eigen::Array3d::Zero();
  const WaterState state = FitWater(samples, &water, &noise);
  if (state != WaterState::kDetermined) water = {};
  water.state = state;
  water.white = WhiteBalance(samples, water);
  water.max_gain = (kMaxNoise / (noise * water.white).max(1e-9)).max(1);
  return water;
}

}  // namespace colmap_seapoint
