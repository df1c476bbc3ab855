// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/records/trajectory_data.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

namespace {

using swath::core::CovarianceSeries;
using Matrix9 = CovarianceSeries::Matrix9;

Matrix9 some_covariance(double seed) {
  Matrix9 a;
  for (Eigen::Index i = 0; i < 9; ++i)
    for (Eigen::Index j = 0; j < 9; ++j) a(i, j) = std::sin(seed + static_cast<double>(3 * i + 7 * j));
  return a * a.transpose() + 0.1 * Matrix9::Identity();
}

constexpr double rounding = 1e-14;

TEST(CovarianceSeries, PacksAndUnpacks) {
  const Matrix9 c = some_covariance(1.0);
  EXPECT_LT((CovarianceSeries::unpack(CovarianceSeries::pack(c)) - c).norm(), rounding * c.norm());
}

TEST(CovarianceSeries, IsLinearBetweenItsInstantsAndConstantBeyond) {
  CovarianceSeries s;
  const Matrix9 a = some_covariance(1.0), b = some_covariance(2.0);
  s.time = {10.0, 14.0};
  s.upper = {CovarianceSeries::pack(a), CovarianceSeries::pack(b)};
  EXPECT_LT((s.at(11.0) - (0.75 * a + 0.25 * b)).norm(), rounding * a.norm());
  EXPECT_LT((s.at(14.0) - b).norm(), rounding * b.norm());
  EXPECT_LT((s.at(0.0) - a).norm(), rounding * a.norm());
  EXPECT_LT((s.at(99.0) - b).norm(), rounding * b.norm());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix9>(s.at(12.3)).eigenvalues().minCoeff(), 0.0);
}

}  // namespace
