#include <algorithm>
#include <limits>
#include <vector>

#include "densify/completeness/gaps/closing_pass.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kMaxExact = 8;
constexpr int kMaxRounds = 50;
constexpr double kFar = std::numeric_limits<double>::infinity();
using Route = std::vector<RouteStop>;

const Eigen::Vector3d& EntryOf(const std::vector<ClosingPass>& passes, const RouteStop& stop) {
  const ClosingPass& pass = passes[static_cast<size_t>(stop.pass)];
  return stop.is_reversed ? pass.End() : pass.Begin();
}

const Eigen::Vector3d& ExitOf(const std::vector<ClosingPass>& passes, const RouteStop& stop) {
  return EntryOf(passes, {stop.pass, !stop.is_reversed});
}

double Way(const std::vector<ClosingPass>& passes, const RouteStop& a, const RouteStop& b) {
  return (EntryOf(passes, b) - ExitOf(passes, a)).norm();
}

RouteStop StopOf(size_t state) { return {static_cast<int>(state / 2), state % 2 == 1}; }

// Held and Karp: the shortest way through every set of passes that ends with each one, from either
// end.
Route Shortest(const std::vector<ClosingPass>& passes) {
  const size_t n = passes.size(), states = 2 * n, sets = size_t{1} << n;
  std::vector<double> length(sets * states, kFar);
  std::vector<size_t> from(sets * states, states);
  for (size_t s = 0; s < states; ++s) length[(size_t{1} << (s / 2)) * states + s] = 0;
  for (size_t set = 1; set < sets; ++set) {
    for (size_t s = 0; s < states; ++s) {
      const double so_far = length[set * states + s];
      if (so_far == kFar) continue;
      for (size_t t = 0; t < states; ++t) {
        const size_t bit = size_t{1} << (t / 2);
        if (set & bit) continue;
        const double sum = so_far + Way(passes, StopOf(s), StopOf(t));
        double& best = length[(set | bit) * states + t];
        if (sum >= best) continue;
        best = sum;
        from[(set | bit) * states + t] = s;
      }
    }
  }
  size_t set = sets - 1;
  const auto row = length.begin() + static_cast<std::ptrdiff_t>(set * states);
  auto state =
      static_cast<size_t>(std::min_element(row, row + static_cast<std::ptrdiff_t>(states)) - row);
  Route route;
  while (state < states) {
    route.push_back(StopOf(state));
    const size_t before = from[set * states + state];
    set &= ~(size_t{1} << (state / 2));
    state = before;
  }
  std::reverse(route.begin(), route.end());
  return route;
}

Route Greedy(const std::vector<ClosingPass>& passes, const RouteStop& start) {
  Route route = {start};
  std::vector<bool> is_done(passes.size(), false);
  is_done[static_cast<size_t>(start.pass)] = true;
  while (route.size() < passes.size()) {
    RouteStop best;
    double shortest = kFar;
    for (size_t s = 0; s < 2 * passes.size(); ++s) {
      if (is_done[s / 2]) continue;
      const double way = Way(passes, route.back(), StopOf(s));
      if (way >= shortest) continue;
      shortest = way;
      best = StopOf(s);
    }
    is_done[static_cast<size_t>(best.pass)] = true;
    route.push_back(best);
  }
  return route;
}

// The route with stops i to k taken backwards, each from its other end.
void Reverse(size_t i, size_t k, Route* route) {
  std::reverse(route->begin() + static_cast<std::ptrdiff_t>(i),
               route->begin() + static_cast<std::ptrdiff_t>(k) + 1);
  for (size_t j = i; j <= k; ++j) (*route)[j].is_reversed = !(*route)[j].is_reversed;
}

double Gain(const std::vector<ClosingPass>& passes, const Route& route, size_t i, size_t k) {
  const RouteStop first = route[i], last = route[k];
  const RouteStop new_first = {last.pass, !last.is_reversed};
  const RouteStop new_last = {first.pass, !first.is_reversed};
  double gain = 0;
  if (i > 0) gain += Way(passes, route[i - 1], first) - Way(passes, route[i - 1], new_first);
  if (k + 1 < route.size()) {
    gain += Way(passes, last, route[k + 1]) - Way(passes, new_last, route[k + 1]);
  }
  return gain;
}

void Improve(const std::vector<ClosingPass>& passes, Route* route) {
  for (int round = 0; round < kMaxRounds; ++round) {
    bool is_better = false;
    for (size_t i = 0; i < route->size(); ++i) {
      for (size_t k = i; k < route->size(); ++k) {
        if (Gain(passes, *route, i, k) <= 1e-9) continue;
        Reverse(i, k, route);
        is_better = true;
      }
    }
    if (!is_better) return;
  }
}

}  // namespace

double TransitLength(const std::vector<ClosingPass>& passes, const Route& route) {
  double sum = 0;
  for (size_t i = 1; i < route.size(); ++i) sum += Way(passes, route[i - 1], route[i]);
  return sum;
}

Route PlanRoute(const std::vector<ClosingPass>& passes) {
  if (passes.empty()) return {};
  if (passes.size() <= kMaxExact) return Shortest(passes);
  Route best;
  double shortest = kFar;
  for (size_t s = 0; s < kMaxExact; ++s) {
    Route route = Greedy(passes, StopOf(s * 2 * passes.size() / kMaxExact));
    Improve(passes, &route);
    const double length = TransitLength(passes, route);
    if (length >= shortest) continue;
    shortest = length;
    best = std::move(route);
  }
  return best;
}

}  // namespace colmap_seapoint
