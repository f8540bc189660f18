#include "colmap_seapoint/water/estimate_water.h"

#include <algorithm>
#include <cmath>
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
constexpr double kMaxGain = 1000;
constexpr double kMaxWhite = 50;
const Eigen::Array3d kLuminance(0.2126, 0.7152, 0.0722);  // of sRGB's primaries

Eigen::Array3d ColorOf(const WaterSample& sample) {
  return {sample.rgb[0], sample.rgb[1], sample.rgb[2]};
}

bool IsUsable(const WaterSample& sample) {
  if (!std::isfinite(sample.range) || !(sample.range > 0)) return false;
  return std::all_of(sample.rgb.begin(), sample.rgb.end(),
                     [](float value) { return value >= 0 && value < kOverexposed; });
}

// Whatever order they come in, they give one result.
void Sort(std::vector<WaterSample>* samples) {
  const auto key = [](const WaterSample& s) {
    return std::tie(s.place, s.picture, s.range, s.rgb);
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

WaterState FitWater(const std::vector<WaterSample>& samples, WaterModel* water) {
  const SeenTwice seen = FindSeenTwice(samples);
  if (seen.place_end.size() < kMinPlaces) return WaterState::kTooFewPlaces;
  if (seen.span < kMinSpan) return WaterState::kOneRange;
  const double median_range = MedianRange(samples);
  for (int c = 0; c < 3; ++c) {
    ChannelSamples channel;
    channel.place_end = seen.place_end;
    for (const size_t i : seen.samples) {
      channel.range.push_back(samples[i].range / median_range);
      channel.light.push_back(samples[i].rgb[static_cast<size_t>(c)]);
    }
    const ChannelFit fit = FitChannel(channel);
    if (!(fit.attenuation_sigma <= kMaxSigma)) return WaterState::kUncertain;
    water->attenuation[c] = fit.attenuation / median_range;
    water->veil[c] = fit.veil;
    water->veil_rate[c] = fit.veil_rate / median_range;
    water->max_gain[c] = std::clamp(kMaxNoise / std::max(fit.noise, 1e-9), 1.0, kMaxGain);
  }
  return WaterState::kDetermined;
}

// Grey is what the median of all samples is, restored, and as bright as their median was.
Eigen::Array3d WhiteBalance(const std::vector<WaterSample>& samples, const WaterModel& water) {
  std::vector<double> brightness, channel(samples.size());
  for (const WaterSample& sample : samples) {
    brightness.push_back((kLuminance * ColorOf(sample)).sum());
  }
  const double target = UpperMedian(std::move(brightness));
  Eigen::Array3d white;
  for (int c = 0; c < 3; ++c) {
    for (size_t i = 0; i < samples.size(); ++i) {
      channel[i] = static_cast<double>(
          Restore(water, ColorOf(samples[i]).cast<float>(), samples[i].range)[c]);
    }
    white[c] = std::clamp(target / std::max(UpperMedian(channel), 1e-9), 1 / kMaxWhite, kMaxWhite);
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
  const WaterState state = FitWater(samples, &water);
  if (state != WaterState::kDetermined) water = {};
  water.state = state;
  water.white = WhiteBalance(samples, water);
  return water;
}

}  // namespace colmap_seapoint
