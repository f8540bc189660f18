#include "colmap_seapoint/adjustment/reduced_system.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <set>

#include "colmap_seapoint/base/parallel.h"

namespace colmap_seapoint {
namespace {

using RowOfTwo = Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, kMaxLensParams>;

// Which pictures before it, and which lenses, share points with a picture, ascending.
struct Neighbors {
  std::vector<uint32_t> pictures, lenses;
};

Neighbors NeighborsOf(const Bundle& bundle, uint32_t picture) {
  std::vector<bool> sees_picture(picture + 1), sees_lens(bundle.lenses.size());
  for (uint32_t o = bundle.picture_begin[picture]; o < bundle.picture_begin[picture + 1]; ++o) {
    const uint32_t point = bundle.point_of[bundle.of_picture[o]];
    for (uint32_t k = bundle.point_begin[point]; k < bundle.point_begin[point + 1]; ++k) {
      if (bundle.picture_of[k] <= picture) sees_picture[bundle.picture_of[k]] = true;
    }
    for (uint32_t s = bundle.share_begin[point]; s < bundle.share_begin[point + 1]; ++s) {
      sees_lens[bundle.share_lens[s]] = true;
    }
  }
  Neighbors neighbors;
  for (uint32_t i = 0; i < sees_picture.size(); ++i) {
    if (sees_picture[i]) neighbors.pictures.push_back(i);
  }
  for (uint32_t c = 0; c < sees_lens.size(); ++c) {
    if (sees_lens[c]) neighbors.lenses.push_back(c);
  }
  return neighbors;
}

// What a picture adds to the lenses' own equations.
struct LensPart {
  std::vector<uint32_t> lenses;
  Eigen::MatrixXd equations;  // of the picture's lens (rows) with all these, side by side
  Eigen::VectorXd gradient, diagonal;
};

// Adds up one picture's row. Its observations' equations are those of the linearization: the lens
// part is worked out again, which costs less than to keep it.
class RowSum {
 public:
  RowSum(const Bundle& bundle, const Linearization& linearization, uint32_t picture,
         ReducedSystem* system)
      : bundle_(bundle), linearization_(linearization), picture_(picture), system_(system) {
    part_.lenses = NeighborsOf(bundle, picture).lenses;
    int size = 0;
    for (uint32_t lens : part_.lenses) size += bundle.lenses[lens].num_free;
    const int own_size = bundle.lenses[OwnLens()].num_free;
    part_.equations = Eigen::MatrixXd::Zero(own_size, size);
    part_.gradient = part_.diagonal = Eigen::VectorXd::Zero(own_size);
    border_ = Eigen::MatrixXd::Zero(size, kBlockSize);
    place_of_picture_.resize(picture + 1);
    for (size_t k = system->matrix.row_begin[picture]; k < system->matrix.row_begin[picture + 1];
         ++k) {
      place_of_picture_[system->matrix.columns[k]] = k;
      system->matrix.blocks[k].setZero();
    }
  }

  void Add(size_t observation, const RowOfTwo& by_lens) {
    const uint32_t point = bundle_.point_of[observation];
    const ObservationRow& row = linearization_.rows[observation];
    const Eigen::Matrix<double, 2, 6> by_pose = row.by_pose.cast<double>();
    const Eigen::Vector2d residual =
        row.residual.cast<double>() - row.basis * linearization_.point_residuals[point];
    gradient_.noalias() += by_pose.transpose() * residual;
    diagonal_ += by_pose.colwise().squaredNorm().transpose();
    part_.gradient.noalias() += by_lens.transpose() * residual;
    part_.diagonal += by_lens.colwise().squaredNorm().transpose();
    own_.noalias() += by_pose.transpose() * by_pose;
    AddPictures(point, by_pose, row.basis);
    AddLenses(point, by_pose, row.basis, by_lens);
  }

  // Puts the sums where they belong, except for the lenses' own equations, which it returns.
  LensPart Finish() {
    BlockMatrix& matrix = system_->matrix;
    if (bundle_.holds_pose[picture_]) own_.setIdentity();  // all else of its row is 0
    matrix.blocks[place_of_picture_[picture_]] += own_;
    const auto first = static_cast<Eigen::Index>(kBlockSize * picture_);
    system_->gradient.segment<kBlockSize>(first) = gradient_;
    system_->diagonal.segment<kBlockSize>(first) = diagonal_;
    Eigen::Index column = 0;
    for (uint32_t lens : part_.lenses) {
      int left = bundle_.lenses[lens].num_free;
      for (uint32_t r = system_->lens_row[lens]; r < system_->lens_row[lens + 1]; ++r) {
        Block& block = matrix.blocks[matrix.Find(r, picture_)];
        const int count = std::min(left, kBlockSize);
        block.setZero();
        block.topRows(count) = border_.middleRows(column, count);
        column += count;
        left -= count;
      }
    }
    return std::move(part_);
  }

 private:
  uint32_t OwnLens() const { return bundle_.lens_of_picture[picture_]; }

  void AddPictures(uint32_t point, const Eigen::Matrix<double, 2, 6>& by_pose,
                   const Eigen::Matrix<double, 2, 3>& basis) {
    for (uint32_t k = bundle_.point_begin[point]; k < bundle_.point_begin[point + 1]; ++k) {
      if (bundle_.picture_of[k] > picture_) break;  // they ascend
      const ObservationRow& other = linearization_.rows[k];
      const Eigen::Matrix2d both = basis * other.basis.transpose();
      const Eigen::Matrix<double, 2, 6> right = both * other.by_pose.cast<double>();
      system_->matrix.blocks[place_of_picture_[bundle_.picture_of[k]]].noalias() -=
          by_pose.transpose().lazyProduct(right);
    }
  }

  void AddLenses(uint32_t point, const Eigen::Matrix<double, 2, 6>& by_pose,
                 const Eigen::Matrix<double, 2, 3>& basis, const RowOfTwo& by_lens) {
    size_t of_part = 0;
    Eigen::Index column = 0;
    for (uint32_t s = bundle_.share_begin[point]; s < bundle_.share_begin[point + 1]; ++s) {
      while (part_.lenses[of_part] != bundle_.share_lens[s]) {
        column += bundle_.lenses[part_.lenses[of_part++]].num_free;
      }
      RowOfTwo reduced = -basis.lazyProduct(linearization_.Share(bundle_, s));
      if (bundle_.share_lens[s] == OwnLens()) reduced += by_lens;
      border_.middleRows(column, reduced.cols()) += reduced.transpose().lazyProduct(by_pose);
      part_.equations.middleCols(column, reduced.cols()) +=
          by_lens.transpose().lazyProduct(reduced);
    }
  }

  const Bundle& bundle_;
  const Linearization& linearization_;
  const uint32_t picture_;
  ReducedSystem* system_;
  LensPart part_;
  Eigen::MatrixXd border_;  // rows: the free values of all these lenses; columns: the pose
  std::vector<size_t> place_of_picture_;
  Block own_ = Block::Zero();
  Eigen::Matrix<double, 6, 1> gradient_ = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 6, 1> diagonal_ = Eigen::Matrix<double, 6, 1>::Zero();
};

// Entry (row, column) of the matrix, of lenses: row's lens is not before column's.
double& LensEntry(ReducedSystem* system, Eigen::Index row, Eigen::Index column) {
  const auto block_row = static_cast<uint32_t>(row / kBlockSize);
  const auto block_column = static_cast<uint32_t>(column / kBlockSize);
  const size_t place = system->matrix.Find(block_row, block_column);
  return system->matrix.blocks[place](row % kBlockSize, column % kBlockSize);
}

void ClearLensRows(const Bundle& bundle, ReducedSystem* system) {
  BlockMatrix& matrix = system->matrix;
  for (size_t r = bundle.NumPictures(); r < matrix.NumRows(); ++r) {
    for (size_t k = matrix.row_begin[r]; k < matrix.row_begin[r + 1]; ++k) {
      if (matrix.columns[k] >= bundle.NumPictures()) matrix.blocks[k].setZero();
    }
  }
  const auto first = static_cast<Eigen::Index>(kBlockSize * bundle.NumPictures());
  system->gradient.tail(system->gradient.size() - first).setZero();
  system->diagonal.tail(system->diagonal.size() - first).setZero();
}

void AddLensPart(const Bundle& bundle, uint32_t own_lens, const LensPart& part,
                 ReducedSystem* system) {
  const Eigen::Index own_first = system->LensIndex(own_lens);
  system->gradient.segment(own_first, part.gradient.size()) += part.gradient;
  system->diagonal.segment(own_first, part.diagonal.size()) += part.diagonal;
  Eigen::Index column = 0;
  for (uint32_t lens : part.lenses) {
    const int size = bundle.lenses[lens].num_free;
    if (lens <= own_lens) {
      for (Eigen::Index a = 0; a < part.equations.rows(); ++a) {
        for (Eigen::Index b = 0; b < size; ++b) {
          const Eigen::Index row = own_first + a, of = system->LensIndex(lens) + b;
          if (row / kBlockSize < of / kBlockSize) continue;
          LensEntry(system, row, of) += part.equations(a, column + b);
        }
      }
    }
    column += size;
  }
}

// What is left of a lens's last block is held.
void HoldRestOfLens(const Bundle& bundle, size_t lens, ReducedSystem* system) {
  const Eigen::Index end = system->LensIndex(lens + 1);
  for (Eigen::Index k = system->LensIndex(lens) + bundle.lenses[lens].num_free; k < end; ++k) {
    LensEntry(system, k, k) = 1;
  }
}

void AddPriors(const BundleLens& lens, const LensParams& params, size_t idx,
               ReducedSystem* system) {
  for (size_t param = 0; param < kMaxLensParams; ++param) {
    const double weight = lens.prior_weights[param];
    if (weight == 0) continue;
    const Eigen::Index k = system->LensIndex(idx) + lens.slots[param];
    LensEntry(system, k, k) += weight;
    system->diagonal[k] += weight;
    system->gradient[k] += weight * (params[param] - lens.prior[param]);
  }
}

}  // namespace

ReducedSystem MakeReducedSystem(const Bundle& bundle) {
  ReducedSystem system;
  const auto num_pictures = static_cast<uint32_t>(bundle.NumPictures());
  uint32_t num_rows = num_pictures;
  for (const BundleLens& lens : bundle.lenses) {
    system.lens_row.push_back(num_rows);
    num_rows += static_cast<uint32_t>((lens.num_free + kBlockSize - 1) / kBlockSize);
  }
  system.lens_row.push_back(num_rows);

  BlockMatrix& matrix = system.matrix;
  std::vector<std::vector<uint32_t>> pictures_of_lens(bundle.lenses.size());
  std::vector<std::set<uint32_t>> lenses_of_lens(bundle.lenses.size());
  matrix.row_begin.push_back(0);
  for (uint32_t i = 0; i < num_pictures; ++i) {
    const Neighbors neighbors = NeighborsOf(bundle, i);
    matrix.columns.insert(matrix.columns.end(), neighbors.pictures.begin(),
                          neighbors.pictures.end());
    matrix.row_begin.push_back(matrix.columns.size());
    for (uint32_t lens : neighbors.lenses) {
      pictures_of_lens[lens].push_back(i);
      lenses_of_lens[bundle.lens_of_picture[i]].insert(lens);
    }
  }
  for (size_t c = 0; c < bundle.lenses.size(); ++c) {
    for (uint32_t r = system.lens_row[c]; r < system.lens_row[c + 1]; ++r) {
      matrix.columns.insert(matrix.columns.end(), pictures_of_lens[c].begin(),
                            pictures_of_lens[c].end());
      for (uint32_t other : lenses_of_lens[c]) {
        for (uint32_t q = system.lens_row[other]; q < system.lens_row[other + 1]; ++q) {
          if (q <= r) matrix.columns.push_back(q);
        }
      }
      matrix.row_begin.push_back(matrix.columns.size());
    }
  }
  matrix.blocks.assign(matrix.columns.size(), Block::Zero());
  system.gradient = system.diagonal =
      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(kBlockSize * num_rows));
  return system;
}

void Reduce(const Bundle& bundle, const BundleValues& values, const RobustLoss& loss,
            const Linearization& linearization, int num_threads, ReducedSystem* system) {
  std::vector<LensPart> parts(bundle.NumPictures());
  ParallelFor(num_threads, static_cast<int64_t>(parts.size()), [&](int64_t i) {
    const auto picture = static_cast<uint32_t>(i);
    RowSum sum(bundle, linearization, picture, system);
    for (uint32_t o = bundle.picture_begin[picture]; o < bundle.picture_begin[picture + 1]; ++o) {
      const uint32_t k = bundle.of_picture[o];
      sum.Add(k, EquationsOf(bundle, values, loss, k).by_lens);
    }
    parts[picture] = sum.Finish();
  });
  ClearLensRows(bundle, system);
  for (size_t i = 0; i < parts.size(); ++i) {
    AddLensPart(bundle, bundle.lens_of_picture[i], parts[i], system);
  }
  for (size_t c = 0; c < bundle.lenses.size(); ++c) {
    HoldRestOfLens(bundle, c, system);
    AddPriors(bundle.lenses[c], values.lenses[c], c, system);
  }
}

BundleValues MovePosesAndLenses(const Bundle& bundle, const ReducedSystem& system,
                                const Eigen::VectorXd& step, const BundleValues& values) {
  BundleValues moved = values;
  for (size_t i = 0; i < bundle.NumPictures(); ++i) {
    const auto first = static_cast<Eigen::Index>(kBlockSize * i);
    const Eigen::Vector3d turn = step.segment<3>(first);
    const double angle = turn.norm();
    BundlePose& pose = moved.poses[i];
    if (angle > 0) {
      const Eigen::Quaterniond rotation(Eigen::AngleAxisd(angle, turn / angle));
      pose.rotation =
          (rotation * Eigen::Quaterniond(pose.rotation)).normalized().toRotationMatrix();
      pose.translation = rotation * pose.translation;
    }
    pose.translation += step.segment<3>(first + 3);
  }
  for (size_t c = 0; c < bundle.lenses.size(); ++c) {
    for (size_t k = 0; k < kMaxLensParams; ++k) {
      const int slot = bundle.lenses[c].slots[k];
      if (slot >= 0) moved.lenses[c][k] += step[system.LensIndex(c) + slot];
    }
  }
  return moved;
}

Eigen::Vector3d PointStep(const Bundle& bundle, const Linearization& linearization,
                          const ReducedSystem& system, const Eigen::VectorXd& step, size_t point) {
  Eigen::Vector3d sum = linearization.point_residuals[point];
  for (uint32_t k = bundle.point_begin[point]; k < bundle.point_begin[point + 1]; ++k) {
    const ObservationRow& row = linearization.rows[k];
    const auto first = static_cast<Eigen::Index>(kBlockSize * bundle.picture_of[k]);
    const Eigen::Vector2d shift = row.by_pose.cast<double>() * step.segment<kBlockSize>(first);
    sum.noalias() += row.basis.transpose() * shift;
  }
  for (uint32_t s = bundle.share_begin[point]; s < bundle.share_begin[point + 1]; ++s) {
    const size_t lens = bundle.share_lens[s];
    const auto share = linearization.Share(bundle, s);
    sum += share.lazyProduct(step.segment(system.LensIndex(lens), share.cols()));
  }
  return -(linearization.point_frames[point] * sum);
}

}  // namespace colmap_seapoint
