#include "examples/survey/scene/boards.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "colmap_seapoint/markers/marker_codes.h"

namespace colmap_seapoint {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Calls visit(index of the node) for all nodes below the board and two cells around it.
void VisitNodes(const HeightField& ground, const MarkerBoard& board,
                const std::function<void(size_t)>& visit) {
  const GridSpec& grid = ground.Grid();
  const double reach = std::sqrt(2.0) * board.HalfWidth() + 2 * grid.step;
  for (int j = 0; j < grid.ny; ++j) {
    if (std::abs(grid.Y(j) - board.centre.y()) > reach) continue;
    for (int i = 0; i < grid.nx; ++i) {
      const double x = grid.X(i) - board.centre.x(), y = grid.Y(j) - board.centre.y();
      if (std::hypot(x, y) > reach) continue;
      visit(static_cast<size_t>(j) * static_cast<size_t>(grid.nx) + static_cast<size_t>(i));
    }
  }
}

// Where the board lies on its own print, in half widths: x to the right, y down.
Eigen::Vector2d OnPrint(const MarkerBoard& board, double x, double y) {
  const double dx = x - board.centre.x(), dy = y - board.centre.y();
  const double c = std::cos(board.turn), s = std::sin(board.turn);
  return Eigen::Vector2d(c * dx + s * dy, -(c * dy - s * dx)) / board.HalfWidth();
}

}  // namespace

double MarkerBoard::HalfWidth() const {
  const double cells = NumCells(name.family);
  return 0.5 * size * (cells + 2) / cells;
}

std::array<Eigen::Vector3d, 4> MarkerBoard::Corners() const {
  std::array<Eigen::Vector3d, 4> corners;
  for (size_t k = 0; k < 4; ++k) {
    const double angle = turn + kPi / 4 + kPi / 2 * static_cast<double>(k);
    corners[k] = centre + std::sqrt(2.0) * HalfWidth() *
                              Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
  }
  return corners;
}

std::optional<float> MarkerBoard::ShadeAt(double x, double y) const {
  const Eigen::Vector2d place = OnPrint(*this, x, y);
  if (place.cwiseAbs().maxCoeff() > 1) return std::nullopt;
  const int cells = NumCells(name.family);
  const auto cell = [&](double along) {
    return static_cast<int>(std::floor(0.5 * (along + 1) * (cells + 2))) - 1;
  };
  return IsWhiteCell(name, cell(place.x()), cell(place.y())) ? 1.0f : 0.0f;
}

std::vector<MarkerBoard> MakeBars(const std::vector<Eigen::Vector2d>& places,
                                  const BoardOptions& options, const HeightField& ground) {
  std::vector<MarkerBoard> boards;
  for (size_t k = 0; k < places.size(); ++k) {
    const auto random = [&](int64_t axis) {
      return Uniform(Hash(options.seed + 77, static_cast<int64_t>(k), axis));
    };
    const double heading = kPi * (random(0) - 0.5) / 6;
    for (int end = 0; end < 2; ++end) {
      MarkerBoard board;
      board.name = {MarkerFamily::kTag36h11, 2 * static_cast<int>(k) + end};
      board.size = options.marker_size;
      board.turn = 2 * kPi * random(1 + end);
      const double along = (end == 0 ? -0.5 : 0.5) * options.bar_length;
      board.centre = {places[k].x() + along * std::cos(heading),
                      places[k].y() + along * std::sin(heading), ground.MinHeight()};
      float highest = ground.MinHeight();
      VisitNodes(ground, board,
                 [&](size_t node) { highest = std::max(highest, ground.Heights()[node]); });
      board.centre.z() = static_cast<double>(highest);
      boards.push_back(board);
    }
  }
  return boards;
}

HeightField WithBoards(const HeightField& ground, const std::vector<MarkerBoard>& boards) {
  Field heights = ground.Heights();
  for (const MarkerBoard& board : boards) {
    VisitNodes(ground, board,
               [&](size_t node) { heights[node] = static_cast<float>(board.centre.z()); });
  }
  return HeightField(ground.Grid(), std::move(heights));
}

}  // namespace colmap_seapoint
