#include "colmap_seapoint/orthomosaic/sources/exposure.h"

#include <Eigen/QR>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "colmap_seapoint/base/median.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kRowsAPicture = 400;
constexpr size_t kMaxRows = 100000;
constexpr int kMinPictures = 5;  // of a camera, for a falloff
constexpr int kMaxPairs = 3;     // a block
constexpr uint8_t kDarkest = 3, kBrightest = 250;
constexpr double kGainPrior = 0.05;  // of a gain that nothing tells, against one observation
constexpr double kLevelPrior = 1;
constexpr double kKnown = 1e8;      // of what is known, against one observation
constexpr double kSmoothPrior = 4;  // of neighbouring nodes of the falloff
constexpr double kMaxLogGain = 1.0986;

using Node = std::pair<int, double>;  // number and weight

// The four nodes of the falloff around a place of the picture.
std::array<Node, 4> NodesAt(double x, double y) {
  const double px = std::clamp(x, 0.0, 1.0) * (Exposure::kNodesX - 1);
  const double py = std::clamp(y, 0.0, 1.0) * (Exposure::kNodesY - 1);
  const int left = std::min(static_cast<int>(px), Exposure::kNodesX - 2);
  const int top = std::min(static_cast<int>(py), Exposure::kNodesY - 2);
  const double fx = px - left, fy = py - top;
  const int at = top * Exposure::kNodesX + left;
  return {{{at, (1 - fx) * (1 - fy)},
           {at + 1, fx * (1 - fy)},
           {at + Exposure::kNodesX, (1 - fx) * fy},
           {at + Exposure::kNodesX + 1, fx * fy}}};
}

struct Row {  // two pictures of one block
  uint32_t picture[2];
  Eigen::Vector2d place[2];  // in the picture, 0 ... 1
  Eigen::Vector2d on_map;
  Eigen::Vector3d difference;  // of the logarithms, first minus second
  double weight = 1;
};

bool IsReadable(const Source& source) {
  if (source.picture == kNoPicture) return false;
  const auto [least, most] = std::minmax_element(source.rgb.begin(), source.rgb.end());
  return *least >= kDarkest && *most <= kBrightest;
}

Eigen::Vector3d LogLight(const Source& source) {
  Eigen::Vector3d log;
  for (size_t c = 0; c < 3; ++c) {
    log[static_cast<Eigen::Index>(c)] = std::log(double{LightOf(source.rgb[c])});
  }
  return log;
}

class RowCollector {
 public:
  RowCollector(const Relief& relief, const std::vector<MapView>& views, const SourceBlocks& sources)
      : relief_(relief), views_(views), sources_(sources) {}

  std::vector<Row> Collect() const {
    const size_t most = std::min(kMaxRows, kRowsAPicture * views_.size());
    const size_t stride = sources_.NumSlots() * kMaxPairs / most + 1;
    std::vector<Row> rows;
    for (int y = 0; y < relief_.Blocks().height; ++y) {
      for (int x = 0; x < relief_.Blocks().width; ++x) {
        const int32_t at = sources_.slot[relief_.Blocks().At(x, y)];
        if (at < 0 || sources_.IsKept(at)) continue;
        if (SourceBlocks::Scattered(at) % stride == 0) AddBlock(x, y, at, &rows);
      }
    }
    return rows;
  }

 private:
  // The best source with the next, that with the one after it, and the best with the last, which
  // is near the border of its picture.
  void AddBlock(int x, int y, int32_t at, std::vector<Row>* rows) const {
    const Source* sources = sources_.Of(at);
    int last = 0;
    while (last + 1 < kMaxSources && sources[last + 1].picture != kNoPicture) ++last;
    const Eigen::Vector3d place = PlaceInBlock(relief_, x, y);
    if (last >= 1) AddRow(sources[0], sources[1], place, rows);
    if (last >= 2) AddRow(sources[1], sources[2], place, rows);
    if (last >= 3) AddRow(sources[0], sources[last], place, rows);
  }

  void AddRow(const Source& a, const Source& b, const Eigen::Vector3d& place,
              std::vector<Row>* rows) const {
    if (!IsReadable(a) || !IsReadable(b)) return;
    const auto at_a = ShareOf(a.picture, place), at_b = ShareOf(b.picture, place);
    if (!at_a || !at_b) return;
    rows->push_back(
        {{a.picture, b.picture}, {*at_a, *at_b}, place.head<2>(), LogLight(a) - LogLight(b)});
  }

  // Where a picture shows a place, 0 ... 1 from its left and upper side.
  std::optional<Eigen::Vector2d> ShareOf(uint32_t picture, const Eigen::Vector3d& place) const {
    const MapView& view = views_[picture];
    const auto pixel = view.PixelOf(place);
    if (!pixel) return std::nullopt;
    return Eigen::Vector2d(pixel->x() / view.GetCamera().width,
                           pixel->y() / view.GetCamera().height);
  }

  const Relief& relief_;
  const std::vector<MapView>& views_;
  const SourceBlocks& sources_;
};

// Unknowns: the logarithm of every picture's gain, then of every node of every falloff.
class ExposureSystem {
 public:
  ExposureSystem(size_t num_pictures, const std::vector<int>& falloff_of, int num_falloffs)
      : num_pictures_(static_cast<int>(num_pictures)),
        falloff_of_(falloff_of),
        num_falloffs_(num_falloffs),
        size_(num_pictures_ + num_falloffs * Exposure::kNumNodes) {}

  // One column a channel. `known`: a row for each of the first unknowns, whose values these are.
  Eigen::MatrixX3d Solve(const std::vector<Row>& rows,
                         const Eigen::MatrixX3d& known = Eigen::MatrixX3d(0, 3)) const {
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(size_, 3);
    for (const Row& row : rows) AddRow(row, &entries, &right);
    AddPriors(&entries);
    for (Eigen::Index i = 0; i < known.rows(); ++i) {
      entries.emplace_back(i, i, kKnown);
      right.row(i) += kKnown * known.row(i);
    }
    Eigen::SparseMatrix<double> matrix(size_, size_);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
    Eigen::MatrixX3d result = solver.solve(right);
    if (!result.allFinite()) result.setZero();
    return result;
  }

  // The unknowns in a row, with their factors.
  std::vector<Node> TermsOf(const Row& row) const {
    std::vector<Node> terms;
    AddTerms(row.picture[0], row.place[0], 1, &terms);
    AddTerms(row.picture[1], row.place[1], -1, &terms);
    return terms;
  }
  // The logarithm of what a picture's light is multiplied with, times `sign`.
  void AddTerms(uint32_t picture, const Eigen::Vector2d& place, double sign,
                std::vector<Node>* terms) const {
    terms->emplace_back(static_cast<int>(picture), sign);
    const int falloff = falloff_of_[picture];
    if (falloff < 0) return;
    const int first = num_pictures_ + falloff * Exposure::kNumNodes;
    for (const auto& [node, weight] : NodesAt(place.x(), place.y())) {
      terms->emplace_back(first + node, sign * weight);
    }
  }

 private:
  void AddRow(const Row& row, std::vector<Eigen::Triplet<double>>* entries,
              Eigen::MatrixX3d* right) const {
    const std::vector<Node> terms = TermsOf(row);
    for (const auto& [i, a] : terms) {
      right->row(i) -= row.weight * a * row.difference.transpose();
      for (const auto& [k, b] : terms) entries->emplace_back(i, k, row.weight * a * b);
    }
  }

  void AddPriors(std::vector<Eigen::Triplet<double>>* entries) const {
    for (int i = 0; i < num_pictures_; ++i) entries->emplace_back(i, i, kGainPrior);
    for (int falloff = 0; falloff < num_falloffs_; ++falloff) {
      const int first = num_pictures_ + falloff * Exposure::kNumNodes;
      for (int node = 0; node < Exposure::kNumNodes; ++node) {
        entries->emplace_back(first + node, first + node, kLevelPrior);
        const int x = node % Exposure::kNodesX, y = node / Exposure::kNodesX;
        const bool is_inner_x = x > 0 && x + 1 < Exposure::kNodesX;
        const bool is_inner_y = y > 0 && y + 1 < Exposure::kNodesY;
        if (is_inner_x) AddSmoothness(first + node, 1, entries);
        if (is_inner_y) AddSmoothness(first + node, Exposure::kNodesX, entries);
      }
    }
  }

  // Of a node between two others, which lie `step` before and behind.
  static void AddSmoothness(int node, int step, std::vector<Eigen::Triplet<double>>* entries) {
    constexpr double kBend[3] = {1, -2, 1};
    for (int i = 0; i < 9; ++i) {
      const int a = i / 3, b = i % 3;
      entries->emplace_back(node + (a - 1) * step, node + (b - 1) * step,
                            kSmoothPrior * kBend[a] * kBend[b]);
    }
  }

  int num_pictures_;
  const std::vector<int>& falloff_of_;
  int num_falloffs_;
  int size_;
};

// Rows that stay farther off than most count less.
void Reweigh(const ExposureSystem& system, const Eigen::MatrixX3d& solution,
             std::vector<Row>* rows) {
  std::vector<double> residuals;
  for (const Row& row : *rows) {
    Eigen::Vector3d residual = row.difference;
    for (const auto& [i, a] : system.TermsOf(row)) residual += a * solution.row(i).transpose();
    residuals.push_back(residual.norm());
  }
  const double limit = 2 * UpperMedian(residuals);
  for (size_t i = 0; i < rows->size(); ++i) {
    (*rows)[i].weight = residuals[i] > limit ? limit / residuals[i] : 1;
  }
}

// Of what the best picture of each place is multiplied with: the plane through it over the map.
ExposureTrend FindTrend(const ExposureSystem& system, const Eigen::MatrixX3d& solution,
                        const std::vector<Row>& rows) {
  ExposureTrend trend;
  for (const Row& row : rows) trend.place += row.on_map / static_cast<double>(rows.size());
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero(), right = Eigen::Matrix3d::Zero();
  for (const Row& row : rows) {
    std::vector<Node> terms;
    system.AddTerms(row.picture[0], row.place[0], 1, &terms);
    Eigen::RowVector3d logarithms = Eigen::RowVector3d::Zero();
    for (const auto& [i, a] : terms) logarithms += a * solution.row(i);
    const Eigen::Vector3d basis = (row.on_map - trend.place).homogeneous();
    normal += basis * basis.transpose();
    right += basis * logarithms;
  }
  // Of all on one line, or in one place, what can be told.
  const Eigen::Matrix3d plane = normal.completeOrthogonalDecomposition().solve(right);
  if (!plane.allFinite()) return trend;
  trend.along_x = plane.row(0).transpose();
  trend.along_y = plane.row(1).transpose();
  trend.mean = plane.row(2).transpose();
  return trend;
}

Light FactorOf(const Eigen::RowVector3d& logarithms) {
  Light factor;
  for (size_t c = 0; c < 3; ++c) {
    const double log = logarithms[static_cast<Eigen::Index>(c)];
    factor[c] = static_cast<float>(std::exp(std::clamp(log, -kMaxLogGain, kMaxLogGain)));
  }
  return factor;
}

// The falloff that each picture takes part in: one a camera that has enough pictures.
std::vector<int> FindFalloffs(const std::vector<MapView>& views, int* num_falloffs) {
  std::map<uint32_t, int> num_pictures, number;
  for (const MapView& view : views) ++num_pictures[view.GetCamera().camera_id];
  *num_falloffs = 0;
  for (const auto& [camera, count] : num_pictures) {
    number[camera] = count < kMinPictures ? -1 : (*num_falloffs)++;
  }
  std::vector<int> falloff_of;
  for (const MapView& view : views) falloff_of.push_back(number[view.GetCamera().camera_id]);
  return falloff_of;
}

Eigen::RowVector3d LogOf(const Light& factor) {
  return {std::log(double{factor[0]}), std::log(double{factor[1]}), std::log(double{factor[2]})};
}

// What the falloffs make of the two pictures, at a gain of one.
void TakeOutKnown(const Exposure& falloffs, Row* row) {
  for (const int k : {0, 1}) {
    Light factor = falloffs.FactorAt(row->picture[k], static_cast<float>(row->place[k].x()),
                                     static_cast<float>(row->place[k].y()));
    for (size_t c = 0; c < 3; ++c) factor[c] /= falloffs.Gain(row->picture[k])[c];
    row->difference += (k == 0 ? 1 : -1) * LogOf(factor).transpose();
  }
}

}  // namespace

Light Exposure::FactorAt(uint32_t picture, float x, float y) const {
  Light factor = gains_[picture];
  const int falloff = falloff_of_[picture];
  if (falloff < 0) return factor;
  const std::array<Light, kNumNodes>& nodes = falloffs_[static_cast<size_t>(falloff)];
  const float px = std::clamp(x, 0.0f, 1.0f) * (kNodesX - 1);
  const float py = std::clamp(y, 0.0f, 1.0f) * (kNodesY - 1);
  const int left = std::min(static_cast<int>(px), kNodesX - 2);
  const int top = std::min(static_cast<int>(py), kNodesY - 2);
  const float fx = px - static_cast<float>(left), fy = py - static_cast<float>(top);
  const Light* at = &nodes[static_cast<size_t>(top * kNodesX + left)];
  for (size_t c = 0; c < 3; ++c) {
    const float above = at[0][c] + fx * (at[1][c] - at[0][c]);
    const float below = at[kNodesX][c] + fx * (at[kNodesX + 1][c] - at[kNodesX][c]);
    factor[c] *= above + fy * (below - above);
  }
  return factor;
}

Light Exposure::FactorOnMap(const Eigen::Vector2d& place) const {
  const Eigen::Vector2d way = place - trend_.place;
  Light factor;
  for (size_t c = 0; c < 3; ++c) {
    const auto i = static_cast<Eigen::Index>(c);
    const double log = trend_.mean[i] + way.x() * trend_.along_x[i] + way.y() * trend_.along_y[i];
    factor[c] = static_cast<float>(std::exp(std::clamp(-log, -kMaxLogGain, kMaxLogGain)));
  }
  return factor;
}

Exposure BalanceExposure(const Relief& relief, const std::vector<MapView>& views,
                         const SourceBlocks& sources) {
  int num_falloffs = 0;
  const std::vector<int> falloff_of = FindFalloffs(views, &num_falloffs);
  std::vector<Row> rows = RowCollector(relief, views, sources).Collect();
  if (rows.empty()) return EqualExposure(views.size());
  const ExposureSystem system(views.size(), falloff_of, num_falloffs);
  Eigen::MatrixX3d solution = system.Solve(rows);
  Reweigh(system, solution, &rows);
  solution = system.Solve(rows);
  std::vector<Light> gains;
  for (size_t i = 0; i < views.size(); ++i) {
    gains.push_back(FactorOf(solution.row(static_cast<Eigen::Index>(i))));
  }
  std::vector<std::array<Light, Exposure::kNumNodes>> falloffs(static_cast<size_t>(num_falloffs));
  auto at = static_cast<Eigen::Index>(views.size());
  for (auto& falloff : falloffs) {
    for (Light& node : falloff) node = FactorOf(solution.row(at++));
  }
  return Exposure(std::move(gains), falloff_of, std::move(falloffs),
                  FindTrend(system, solution, rows));
}

Exposure ContinueExposure(const Exposure& before, const Relief& relief,
                          const std::vector<MapView>& views, const SourceBlocks& sources) {
  const size_t num_before = before.Gains().size();
  std::map<uint32_t, int> falloffs;  // by camera
  for (size_t i = 0; i < num_before; ++i) {
    falloffs.emplace(views[i].GetCamera().camera_id, before.FalloffOf()[i]);
  }
  std::vector<Light> gains = before.Gains();
  std::vector<int> falloff_of = before.FalloffOf();
  for (size_t i = num_before; i < views.size(); ++i) {
    const auto found = falloffs.find(views[i].GetCamera().camera_id);
    falloff_of.push_back(found == falloffs.end() ? -1 : found->second);
  }
  gains.resize(views.size(), Light{1, 1, 1});
  const Exposure with_falloffs(gains, falloff_of, before.Falloffs());
  std::vector<Row> rows = RowCollector(relief, views, sources).Collect();
  for (Row& row : rows) TakeOutKnown(with_falloffs, &row);
  const std::vector<int> no_falloffs(views.size(), -1);
  const ExposureSystem system(views.size(), no_falloffs, 0);
  Eigen::MatrixX3d known(static_cast<Eigen::Index>(num_before), 3);
  for (size_t i = 0; i < num_before; ++i) {
    known.row(static_cast<Eigen::Index>(i)) = LogOf(gains[i]);
  }
  if (!rows.empty()) {
    Eigen::MatrixX3d solution = system.Solve(rows, known);
    Reweigh(system, solution, &rows);
    solution = system.Solve(rows, known);
    for (size_t i = num_before; i < views.size(); ++i) {
      gains[i] = FactorOf(solution.row(static_cast<Eigen::Index>(i)));
    }
  }
  return Exposure(std::move(gains), std::move(falloff_of), before.Falloffs(), before.Trend());
}

Exposure EqualExposure(size_t num_pictures) {
  return Exposure(std::vector<Light>(num_pictures, Light{1, 1, 1}),
                  std::vector<int>(num_pictures, -1), {});
}

}  // namespace colmap_seapoint
