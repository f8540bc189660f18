#include "colmap_seapoint/water/channel_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "colmap_seapoint/base/median.h"

namespace colmap_seapoint {
namespace {

constexpr double kStarts[] = {0.1, 0.5, 1.5};  // a and b, over the median range
constexpr int kNumRounds = 6;                  // of weights
constexpr int kNumSteps = 12;                  // of each round
constexpr double kMaxRate = 20, kMinVeilRate = 0.02;
constexpr double kDarkness = 0.01;  // light at which noise no longer falls with it
constexpr double kSigmaOfMedian = 1.4826;
constexpr double kMinNoise = 1e-6;
constexpr double kPriorSpread = 1;  // of ln b about ln a
constexpr double kPriorFloor = 0.05;
// Water rarely takes more than this of an e-fold over the median range; lenses and lamps rarely
// fall with more than this power of the cosine.
constexpr double kAttenuationSpread = 1, kFalloffSpread = 4;
constexpr double kMinFalloff = -4, kMaxFalloff = 16;

struct Parameters {
  double attenuation = 0, veil = 0, veil_rate = 0, falloff = 0;
};

// Of one place.
struct Place {
  size_t begin, end;
};

// What the model makes of sample i.
double Falloff(const ChannelSamples& samples, size_t i, const Parameters& p) {
  return std::exp(p.falloff * samples.log_cosine[i]);
}

double Transmission(const ChannelSamples& samples, size_t i, const Parameters& p) {
  return std::exp(p.falloff * samples.log_cosine[i] - p.attenuation * samples.range[i]);
}

double WithoutVeil(const ChannelSamples& samples, size_t i, const Parameters& p) {
  const double veil = p.veil * (1 - std::exp(-p.veil_rate * samples.range[i]));
  return samples.light[i] - Falloff(samples, i, p) * veil;
}

Eigen::Vector3d PriorResiduals(const Parameters& p) {
  return {std::log(p.veil_rate / std::max(p.attenuation, kPriorFloor)) / kPriorSpread,
          p.attenuation / kAttenuationSpread, p.falloff / kFalloffSpread};
}

Eigen::Vector4d Slopes(const ChannelSamples& samples, size_t i, const Parameters& p, double color) {
  const double z = samples.range[i], veiled = std::exp(-p.veil_rate * z);
  const double falloff = Falloff(samples, i, p), seen = color * Transmission(samples, i, p);
  return {-seen * z, falloff * (1 - veiled), falloff * p.veil * z * veiled,
          (seen + falloff * p.veil * (1 - veiled)) * samples.log_cosine[i]};
}

class Problem {
 public:
  Problem(const ChannelSamples& samples, bool is_falloff_known)
      : samples_(samples),
        is_falloff_known_(is_falloff_known),
        scale_(samples.light.size()),
        weight_(samples.light.size(), 1.0) {
    size_t begin = 0;
    for (const size_t end : samples.place_end) {
      places_.push_back({begin, end});
      double sum = 0;
      for (size_t i = begin; i < end; ++i) sum += samples.light[i];
      const double mean = std::max(0.0, sum / static_cast<double>(end - begin));
      for (size_t i = begin; i < end; ++i) scale_[i] = 1 / (kDarkness + mean);
      begin = end;
    }
  }

  // Residuals in units of the light that the place shows.
  std::vector<double> Residuals(const Parameters& p) const {
    std::vector<double> residuals(scale_.size());
    for (const Place& place : places_) {
      const double color = ColorOf(place, p);
      for (size_t i = place.begin; i < place.end; ++i) {
        residuals[i] =
            scale_[i] * (WithoutVeil(samples_, i, p) - color * Transmission(samples_, i, p));
      }
    }
    return residuals;
  }

  void Reweight(const Parameters& p) {
    const std::vector<double> residuals = Residuals(p);
    noise_ = std::max(kMinNoise, Spread(residuals));
    for (size_t i = 0; i < residuals.size(); ++i) {
      const double ratio = residuals[i] / (2 * noise_);
      weight_[i] = 1 / (1 + ratio * ratio);
    }
  }

  double Cost(const Parameters& p) const {
    const std::vector<double> residuals = Residuals(p);
    double cost = 0;
    for (size_t i = 0; i < residuals.size(); ++i) {
      cost += weight_[i] * residuals[i] * residuals[i];
    }
    return cost / (noise_ * noise_) + PriorResiduals(p).squaredNorm();
  }

  // Of weights that follow the residuals: what starts are compared by.
  double RobustCost(const Parameters& p, double noise) const {
    double cost = 0;
    for (const double residual : Residuals(p)) {
      cost += std::log1p(std::pow(residual / (2 * noise), 2));
    }
    return cost;
  }

  // The normal equations; what a change of the places' colours could do as well is taken
  // out of each column.
  void Linearize(const Parameters& p, Eigen::Matrix4d* normal, Eigen::Vector4d* right) const {
    normal->setZero();
    right->setZero();
    for (const Place& place : places_) AddPlace(place, p, normal, right);
    *normal /= noise_ * noise_;
    *right /= noise_ * noise_;
    const Eigen::Vector3d prior = PriorResiduals(p);
    const bool is_free = p.attenuation > kPriorFloor;
    Eigen::Matrix<double, 3, 4> slopes = Eigen::Matrix<double, 3, 4>::Zero();
    slopes.row(0) << (is_free ? -1 / p.attenuation : 0), 0, 1 / p.veil_rate, 0;
    slopes.row(0) /= kPriorSpread;
    slopes(1, 0) = 1 / kAttenuationSpread;
    slopes(2, 3) = 1 / kFalloffSpread;
    *normal += slopes.transpose() * slopes;
    *right -= slopes.transpose() * prior;
    if (is_falloff_known_) {
      normal->row(3).setZero();
      normal->col(3).setZero();
      (*normal)(3, 3) = 1;
      (*right)[3] = 0;
    }
  }

  double Noise() const { return noise_; }
  // In the light's own units.
  double LightNoise(const Parameters& p) const {
    std::vector<double> residuals = Residuals(p);
    for (size_t i = 0; i < residuals.size(); ++i) residuals[i] /= scale_[i];
    return Spread(residuals);
  }

 private:
  // Each place takes a degree of freedom with it.
  double Spread(std::vector<double> residuals) const {
    for (double& residual : residuals) residual = std::abs(residual);
    const double num = static_cast<double>(residuals.size());
    const double freedom = std::max(1.0, num - static_cast<double>(places_.size()));
    return kSigmaOfMedian * UpperMedian(std::move(residuals)) * std::sqrt(num / freedom);
  }
  double ColorOf(const Place& place, const Parameters& p) const {
    double sum = 0, squares = 0;
    for (size_t i = place.begin; i < place.end; ++i) {
      const double e = Transmission(samples_, i, p);
      sum += weight_[i] * e * WithoutVeil(samples_, i, p);
      squares += weight_[i] * e * e;
    }
    return std::max(0.0, sum / squares);
  }
  void AddPlace(const Place& place, const Parameters& p, Eigen::Matrix4d* normal,
                Eigen::Vector4d* right) const {
    const double color = ColorOf(place, p);
    Eigen::Vector4d along = Eigen::Vector4d::Zero();
    double squares = 0;
    for (size_t i = place.begin; i < place.end; ++i) {
      const double e = Transmission(samples_, i, p);
      along += weight_[i] * e * Slopes(samples_, i, p, color);
      squares += weight_[i] * e * e;
    }
    along /= squares;
    for (size_t i = place.begin; i < place.end; ++i) {
      const double e = Transmission(samples_, i, p), weight = weight_[i] * scale_[i] * scale_[i];
      const Eigen::Vector4d slopes = Slopes(samples_, i, p, color) - e * along;
      *normal += weight * slopes * slopes.transpose();
      *right += weight * (WithoutVeil(samples_, i, p) - color * e) * slopes;
    }
  }

  const ChannelSamples& samples_;
  const bool is_falloff_known_;
  std::vector<Place> places_;
  std::vector<double> scale_;  // of the residuals; the same within a place
  std::vector<double> weight_;
  double noise_ = 1;
};

Parameters Stepped(const Parameters& p, const Eigen::Vector4d& step) {
  Parameters next;
  next.attenuation = std::clamp(p.attenuation + step[0], 0.0, kMaxRate);
  next.veil = std::clamp(p.veil + step[1], 0.0, 1.0);
  next.veil_rate = std::clamp(p.veil_rate + step[2], 0.5 * p.veil_rate, 2 * p.veil_rate);
  next.veil_rate = std::clamp(next.veil_rate, kMinVeilRate, kMaxRate);
  next.falloff = std::clamp(p.falloff + step[3], kMinFalloff, kMaxFalloff);
  return next;
}

Parameters Descend(const Problem& problem, Parameters p) {
  double damping = 1e-3, cost = problem.Cost(p);
  for (int k = 0; k < kNumSteps; ++k) {
    Eigen::Matrix4d normal;
    Eigen::Vector4d right;
    problem.Linearize(p, &normal, &right);
    Eigen::Matrix4d damped = normal;
    damped.diagonal() += damping * normal.diagonal() + Eigen::Vector4d::Constant(1e-9);
    const Parameters next = Stepped(p, damped.ldlt().solve(right));
    const double next_cost = problem.Cost(next);
    const bool is_better = next_cost < cost;
    damping *= is_better ? 0.2 : 8;
    if (!is_better) continue;
    const bool is_done = cost - next_cost < 1e-9 * cost;
    p = next;
    cost = next_cost;
    if (is_done) break;
  }
  return p;
}

double SigmaOfAttenuation(const Problem& problem, const Parameters& p) {
  Eigen::Matrix4d normal;
  Eigen::Vector4d right;
  problem.Linearize(p, &normal, &right);
  normal.diagonal().array() += 1e-12;
  const Eigen::Vector4d column = normal.ldlt().solve(Eigen::Vector4d::UnitX());
  return std::sqrt(std::max(0.0, column[0]));
}

}  // namespace

ChannelFit FitChannel(const ChannelSamples& samples, std::optional<double> falloff) {
  const double darkest = std::max(0.0, Quantile(samples.light, 0.05));
  ChannelFit best;
  double best_noise = 0, best_cost = std::numeric_limits<double>::infinity();
  for (const double rate : kStarts) {
    Problem problem(samples, falloff.has_value());
    Parameters p = {rate, 0.5 * darkest, rate, falloff.value_or(0)};
    for (int round = 0; round < kNumRounds; ++round) {
      problem.Reweight(p);
      p = Descend(problem, p);
    }
    // One measure for all starts: the first one's noise.
    if (best_noise == 0) best_noise = problem.Noise();
    const double cost = problem.RobustCost(p, best_noise);
    if (cost >= best_cost) continue;
    best_cost = cost;
    best = {p.attenuation,        p.veil, p.veil_rate, p.falloff, SigmaOfAttenuation(problem, p),
            problem.LightNoise(p)};
  }
  return best;
}

}  // namespace colmap_seapoint
