// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/network/plane_factors.h"

#include <gtest/gtest.h>

#include "tests/calib/network/plane_crossing.h"

namespace swath::calib {
namespace {

using namespace test;
using Eigen::VectorXd;

/// Scaled to what each unknown's own equation weighs.
double share_of_right_side(const Crossing& c, double& right) {
  PlaneFactors factors = c.factors();
  factors.linearise(*c.off, c.calibration);
  NetworkNormals normals(c.states->sizes());
  factors.add(*c.states, normals);
  VectorXd product = VectorXd::Zero(c.error.size());
  for (int a = 0; a < normals.N.nodes(); ++a)
    for (int b = 0; b <= a; ++b) {
      const auto B = normals.N.block(a, b);
      if (B.size() == 0) continue;
      product.segment(normals.N.first(a), normals.N.size(a)) += B * c.error.segment(normals.N.first(b), normals.N.size(b));
      if (a != b)
        product.segment(normals.N.first(b), normals.N.size(b)) += B.transpose() * c.error.segment(normals.N.first(a), normals.N.size(a));
    }
  const VectorXd scale = normals.N.diagonal().unaryExpr([](double d) { return d > 0 ? 1 / std::sqrt(d) : 0.0; });
  right = scale.cwiseProduct(normals.b).norm();
  return scale.cwiseProduct(product - normals.b).norm() / right;
}

/// Every Jacobian, the place of each unknown and the elimination of the planes are in this: the true error of states and calibration, with
/// the true planes, solves the equations but for terms of second order, which fall with the error's size.
TEST(PlaneFactors, TheTrueErrorSolvesTheEquations) {
  double right = 0, smaller = 0;
  const double whole = share_of_right_side(Crossing(1.0), right), tenth = share_of_right_side(Crossing(0.1), smaller);
  std::printf("left of the right side: %.2g, with a tenth of the error %.2g\n", whole, tenth);
  EXPECT_LT(whole, 0.02);
  EXPECT_LT(tenth, 0.004);
  EXPECT_NEAR(smaller / right, 0.1, 0.01);
}

TEST(PlaneFactors, TheFitBringsPlanesToTheirReturnsAndRoughnessIsWhatIsNotNoise) {
  Dice dice(3);
  Crossing c(0.0, &dice);
  for (TiePlane& p : c.ties.planes) p.centre += 0.3 * p.normal;
  PlaneFactors factors = c.factors();
  factors.fit(*c.off, c.calibration);
  factors.linearise(*c.off, c.calibration);
  for (const PlaneMisfit& m : factors.misfits()) {
    if (m.returns > 0) {
      EXPECT_LT(std::abs(m.mean), 0.03) << m.plane;
    }
    EXPECT_EQ(m.weight, 1.0);
  }
  EXPECT_NEAR(factors.noise_factor(), 1.0, 0.15);
}

TEST(PlaneFactors, AGroupFarFromItsPlaneLosesItsWeight) {
  Dice dice(3);
  Crossing c(0.0, &dice);
  const TieGroup& bad = c.ties.groups[4];
  for (std::uint32_t i = bad.begin; i < bad.end; ++i) c.ties.returns.range[i] += 1.0;
  PlaneFactors factors = c.factors();
  factors.linearise(*c.off, c.calibration);
  factors.weigh();
  const std::vector<PlaneMisfit> misfits = factors.misfits();
  EXPECT_EQ(misfits[4].weight, 0.0);
  EXPECT_EQ(factors.left_out(), 1u);
  size_t full = 0;
  for (const PlaneMisfit& m : misfits) full += m.weight == 1.0;
  EXPECT_GT(full, misfits.size() * 8 / 10);
}

TEST(PlaneFactors, ARejectedGroupTakesNoPartInTheFit) {
  Dice dice(3);
  Crossing c(0.0, &dice);
  const TieGroup& bad = c.ties.groups[4];
  for (std::uint32_t i = bad.begin; i < bad.end; ++i) c.ties.returns.range[i] += 1.0;
  PlaneFactors factors = c.factors();
  factors.reject(4);
  factors.fit(*c.off, c.calibration);
  factors.linearise(*c.off, c.calibration);
  const std::vector<PlaneMisfit> misfits = factors.misfits();
  EXPECT_GT(std::abs(misfits[4].mean), 0.7);  // the range's metre, along the normal
  size_t others = 0;
  for (size_t g = 0; g < misfits.size(); ++g) {
    if (g == 4 || misfits[g].plane != bad.plane) continue;
    EXPECT_LT(std::abs(misfits[g].mean), 0.03);
    ++others;
  }
  EXPECT_GT(others, 0u);
}

/// A solution moves the planes that were eliminated: with everything else held, to where the returns are.
TEST(PlaneFactors, PlanesFollowTheSolution) {
  Crossing c(0.0);
  for (TiePlane& p : c.ties.planes) p.centre += 0.1 * p.normal;
  PlaneFactors factors = c.factors();
  factors.linearise(*c.off, c.calibration);
  NetworkNormals normals(c.states->sizes());
  factors.add(*c.states, normals);
  factors.follow(VectorXd::Zero(c.error.size()), *c.states);
  for (const PlaneMisfit& m : factors.misfits()) {
    const size_t k = m.plane;
    EXPECT_NEAR(factors.planes()[k].normal.dot(factors.planes()[k].centre - c.world.planes[k].centre), 0.0, 2e-3) << k;
  }
}

}  // namespace
}  // namespace swath::calib
