// The normal equations of many rows with few columns, without the half that symmetry gives for nothing.
#pragma once

#include <Eigen/Core>

namespace poecal {

/// sum_k x_k x_k^T of vectors of kSize numbers, a multiple of kTile. The same vectors in the same order give the same bits.
template <int kSize, int kTile>
class GramSum {
 public:
  using Matrix = Eigen::Matrix<double, kSize, kSize>;
  static_assert(kSize % kTile == 0);

  /// Room for the next vector, to be filled before anything else is asked for.
  auto next() {
    if (filled_ == kBlock) addBlock();
    return block_.col(filled_++);
  }

  /// The sum, and nothing is left.
  Matrix take() {
    addBlock();
    const Matrix sum = sum_.template selfadjointView<Eigen::Lower>();
    sum_.setZero();
    return sum;
  }

 private:
  static constexpr int kBlock = 64;

  /// Tile by tile below the diagonal: one tile stays in the registers while the block goes by. Half the time of a product of matrices.
  void addBlock() {
    for (int column = 0; column < kSize; column += kTile) {
      for (int row = column; row < kSize; row += kTile) {
        Eigen::Matrix<double, kTile, kTile> tile = Eigen::Matrix<double, kTile, kTile>::Zero();
        for (int k = 0; k < filled_; ++k) {
          const auto down = block_.template block<kTile, 1>(row, k);
          const auto across = block_.template block<kTile, 1>(column, k);
          tile.noalias() += down.lazyProduct(across.transpose());
        }
        sum_.template block<kTile, kTile>(row, column) += tile;
      }
    }
    filled_ = 0;
  }

  Eigen::Matrix<double, kSize, kBlock> block_;
  Matrix sum_ = Matrix::Zero();
  int filled_ = 0;
};

}  // namespace poecal
