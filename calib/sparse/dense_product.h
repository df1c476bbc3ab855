// SPDX-License-Identifier: GPL-3.0-or-later
// The dense product that most of a factorisation by fronts consists of.
#pragma once

#include <Eigen/Core>

namespace swath::calib {

/// Element (i, j) is data[i * row_step + j * column_step].
struct MatrixView {
  const double* data;
  Eigen::Index rows, columns, row_step, column_step;

  /// Of a matrix by columns, or a block of one; it must outlive the view.
  template <class Matrix>
  static MatrixView of(const Matrix& m) {
    static_assert(!Matrix::IsRowMajor);
    return {m.data(), m.rows(), m.cols(), m.innerStride(), m.outerStride()};
  }
  MatrixView transposed() const { return {data, columns, rows, column_step, row_step}; }
};

/// C -= A B. No element of C may be one of A or B.
void subtract_product(Eigen::Ref<Eigen::MatrixXd> C, const MatrixView& A, const MatrixView& B);

}  // namespace swath::calib
