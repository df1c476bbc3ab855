// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/navigation/chain_cost.h"

#include <ceres/cost_function.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <memory>

#include "core/geo/frames.h"

namespace swath::calib {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

std::array<double, 9> by_rows(const Matrix3d& M) {
  return {M(0, 0), M(0, 1), M(0, 2), M(1, 0), M(1, 1), M(1, 2), M(2, 0), M(2, 1), M(2, 2)};
}

/// Two images of one camera: a stated covariance of 12 errors.
struct Two {
  std::array<std::array<double, 6>, 2> pose{{{1, 2, 3, 0.01, -0.02, 0.03}, {4, 5, 6, -0.02, 0.01, 0.02}}};
  std::array<std::array<double, 9>, 2> base{};
  std::array<double, 3> antenna{0.1, 0.2, -1.0}, boresight{0.003, -0.002, 0.001};
  std::array<double, 6> drift{0.1, 0.2, 0.3, 0.4, 0.5, 0.6};
  MatrixXd C;
  double station_factor = 1.0, attitude_factor = 1.0;
  std::vector<ChainMember> members;
  NavigationStep step;

  explicit Two(bool with_drift) {
    std::srand(3);
    const MatrixXd A = MatrixXd::Random(12, 12);
    C = A * A.transpose() + MatrixXd::Identity(12, 12);
    for (size_t i = 0; i < 2; ++i) {
      base[i] = by_rows(core::exp_so3(Vector3d::Random()));
      ChainMember m;
      m.pose = pose[i].data(), m.base = base[i].data(), m.antenna = antenna.data(), m.boresight = boresight.data();
      if (with_drift) m.drift = drift.data(), m.u = 0.5 * static_cast<double>(i);
      m.station = {1.5 + 3.0 * static_cast<double>(i), 2.2, 4.4};
      // Nearly the base, as seen from the local frame.
      Matrix3d R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(base[i].data());
      m.observed_local_R_camera = by_rows(core::exp_so3(0.1 * Vector3d::Random()) * R.transpose());
      members.push_back(m);
    }
    step.image = 1, step.before = {0};
    step.by_before = C.bottomLeftCorner(6, 6) * C.topLeftCorner(6, 6).inverse();
    step.root = Eigen::LLT<MatrixXd>(C.bottomRightCorner(6, 6) - step.by_before * C.topRightCorner(6, 6)).matrixL();
  }
  /// Residual and derivatives by all parameters, one after the other.
  VectorXd residual(const NavigationStep& s, const std::vector<ChainMember>& of, MatrixXd* J = nullptr) {
    std::vector<double*> blocks;
    const std::unique_ptr<ceres::CostFunction> cost(chain_cost(s, of, &station_factor, &attitude_factor, blocks));
    const auto& sizes = cost->parameter_block_sizes();
    EXPECT_EQ(sizes.size(), blocks.size());
    VectorXd out(cost->num_residuals());
    std::vector<std::vector<double>> by(sizes.size());
    std::vector<double*> to;
    for (size_t k = 0; k < sizes.size(); ++k)
      by[k].resize(static_cast<size_t>(sizes[k]) * static_cast<size_t>(out.size())), to.push_back(by[k].data());
    EXPECT_TRUE(cost->Evaluate(blocks.data(), out.data(), J ? to.data() : nullptr));
    if (J) {
      J->resize(out.size(), 0);
      for (size_t k = 0; k < sizes.size(); ++k) {
        J->conservativeResize(Eigen::NoChange, J->cols() + sizes[k]);
        J->rightCols(sizes[k]) =
            Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(by[k].data(), out.size(), sizes[k]);
        for (int i = 0; i < sizes[k]; ++i) places.push_back(blocks[k] + i);
      }
    }
    return out;
  }
  std::vector<double*> places;
};

/// Errors of one image, by a step that has none before it and a root of 1.
VectorXd plain_errors(Two& t, size_t image) {
  NavigationStep alone;
  alone.root = MatrixXd::Identity(6, 6);
  return t.residual(alone, {t.members[image]});
}

TEST(ChainCost, SquaresAreThoseOfTheWholeCovariance) {
  Two t(true);
  VectorXd e(12);
  e << plain_errors(t, 0), plain_errors(t, 1);
  NavigationStep first;
  first.root = Eigen::LLT<MatrixXd>(t.C.topLeftCorner(6, 6)).matrixL();
  const double squares = t.residual(first, {t.members[0]}).squaredNorm() + t.residual(t.step, t.members).squaredNorm();
  EXPECT_NEAR(squares, e.dot(t.C.llt().solve(e)), 1e-9 * squares);
  // Factors are those of the sigmas.
  t.station_factor = 2.0, t.attitude_factor = 0.5;
  VectorXd scale(12);
  scale << 2, 2, 2, 0.5, 0.5, 0.5, 2, 2, 2, 0.5, 0.5, 0.5;
  const MatrixXd wider = scale.asDiagonal() * t.C * scale.asDiagonal();
  const double scaled = t.residual(first, {t.members[0]}).squaredNorm() + t.residual(t.step, t.members).squaredNorm();
  EXPECT_NEAR(scaled, e.dot(wider.llt().solve(e)), 1e-9 * scaled);
}

TEST(ChainCost, ErrorsAreThoseOfStationAndAttitude) {
  Two t(true);
  const VectorXd e = plain_errors(t, 1);
  const Matrix3d R0 = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(t.base[1].data());
  const Matrix3d R = core::exp_so3(Vector3d(t.pose[1].data() + 3)) * R0;
  const Vector3d drift = Vector3d(t.drift.data()) + 0.5 * Vector3d(t.drift.data() + 3);
  const Vector3d station =
      Vector3d(t.pose[1].data()) + R.transpose() * Vector3d(t.antenna.data()) + drift - Vector3d(t.members[1].station->data());
  EXPECT_LT((e.head<3>() - station).norm(), 1e-12);
  const Matrix3d observed = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(t.members[1].observed_local_R_camera->data());
  const Vector3d turn = core::log_so3(R * observed * core::exp_so3(-Vector3d(t.boresight.data())));
  EXPECT_LT((e.tail<3>() - turn).norm(), 1e-9);
}

/// Derivatives by all parameters against central differences.
void expect_derivatives(Two& t, Eigen::Index parameters) {
  MatrixXd J;
  t.residual(t.step, t.members, &J);
  ASSERT_EQ(J.cols(), parameters);
  constexpr double step = 1e-6;
  for (size_t k = 0; k < t.places.size(); ++k) {
    const double at = *t.places[k];
    *t.places[k] = at + step;
    const VectorXd more = t.residual(t.step, t.members);
    *t.places[k] = at - step;
    const VectorXd less = t.residual(t.step, t.members);
    *t.places[k] = at;
    EXPECT_LT((J.col(static_cast<Eigen::Index>(k)) - (more - less) / (2 * step)).norm(), 1e-7) << k;
  }
}

TEST(ChainCost, DerivativesAreThoseOfDifferences) {
  for (const bool with_drift : {false, true}) {
    Two t(with_drift);
    expect_derivatives(t, with_drift ? 24 : 18);
  }
}

/// A datum moves stations and turns attitudes.
TEST(ChainCost, Datum) {
  Two t(false);
  std::array<double, 7> datum{0.3, -0.2, 0.1, 0.02, -0.03, 0.04, 1e-3};
  const std::array<double, 3> centre{2.0, 3.0, 4.0};
  for (ChainMember& m : t.members) m.datum = datum.data(), m.datum_centre = centre.data(), m.turned = true;
  const VectorXd e = plain_errors(t, 0);
  const Matrix3d R0 = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(t.base[0].data());
  const Matrix3d R = core::exp_so3(Vector3d(t.pose[0].data() + 3)) * R0, turn = core::exp_so3(Vector3d(datum.data() + 3));
  const Vector3d X = Vector3d(t.pose[0].data()) + R.transpose() * Vector3d(t.antenna.data()), c(centre.data());
  const Vector3d there = c + (1.0 + datum[6]) * turn * (X - c) + Vector3d(datum.data());
  EXPECT_LT((e.head<3>() - (there - Vector3d(t.members[0].station->data()))).norm(), 1e-12);
  const Matrix3d observed = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(t.members[0].observed_local_R_camera->data());
  const Vector3d w = core::log_so3(R * turn.transpose() * observed * core::exp_so3(-Vector3d(t.boresight.data())));
  EXPECT_LT((e.tail<3>() - w).norm(), 1e-9);
  expect_derivatives(t, 25);
}

TEST(ChainCost, StationsAlone) {
  Two t(false);
  for (ChainMember& m : t.members) m.observed_local_R_camera.reset();
  NavigationStep s;
  s.root = Eigen::LLT<MatrixXd>(t.C.topLeftCorner(3, 3)).matrixL();
  const VectorXd r = t.residual(s, {t.members[0]});
  ASSERT_EQ(r.size(), 3);
  Two both(false);
  const Vector3d e = plain_errors(both, 0).head<3>();
  EXPECT_NEAR(r.squaredNorm(), e.dot(t.C.topLeftCorner(3, 3).llt().solve(e)), 1e-9);
}

}  // namespace
}  // namespace swath::calib
