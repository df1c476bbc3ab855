// SPDX-License-Identifier: GPL-3.0-or-later
// The dense product that most of a factorisation by fronts consists of.
//
// Weighed: Eigen's, which is compiled for the least processor that the program runs on and takes about twice the time on those with AVX2;
// OpenBLAS, whose library for all processors is larger than all else that a package of swath holds. Source of the blocking: Goto and van
// de Geijn 2008. Products are not fused with sums, and each element is summed in one order: the numbers are the same on any processor.
#pragma once

#include <Eigen/Core>

namespace swath::calib {

/// Element (i, j) is data[i * row_step + j * column_step].
struct MatrixView {
  const double* data;
  Eigen::Index rows, columns, row_step, column_step;

  /// Columns side by side.
  template <class Matrix>
  static MatrixView of(const Matrix& m) {
    static_assert(!Matrix::IsRowMajor);
    return {m.data(), m.rows(), m.cols(), m.innerStride(), m.outerStride()};
  }
  MatrixView transposed() const { return {data, columns, rows, column_step, row_step}; }
};

/// C -= A B. C may share no memory with A and B.
void subtract_product(Eigen::Ref<Eigen::MatrixXd> C, const MatrixView& A, const MatrixView& B);

}  // namespace swath::calib
