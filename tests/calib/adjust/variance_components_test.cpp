// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/variance_components.h"

#include <gtest/gtest.h>

#include "tests/calib/tie_block.h"

namespace swath::calib {
namespace {

using namespace test;

std::unique_ptr<TieBench> bench_with(double range, double angle, double widest = 25.0 * deg, int returns = 30) {
  World w = make_world({{0.0, 0.0}, {180.0 * deg, 100.0}, {90.0 * deg, 0.0}}, block_planes(5, 10, 4));
  w.returns = returns;
  w.widest = widest;
  w.noise.range = core::Metres(range);
  w.noise.scan_angle = core::Radians(angle);
  Dice dice(31);
  TieSet ties = ties_of(w, &dice);
  CorrectionOptions o;
  o.spacing = core::Seconds(10.0);
  return std::make_unique<TieBench>(w, ties, w.exact, o, std::vector<Parameter>{boresight_roll, boresight_pitch});
}

SigmaFactors white_of(TieBench& s, TieNoise stated, const ComponentOptions& o = {}) {
  SigmaFactors f;
  double scale = 3.0;
  const TieSelection use{std::vector<char>(s.ties.groups.size(), 1), {}};
  for (int i = 0; i < 8; ++i) {
    const TieNoise now{stated.range * f.range.factor, stated.angle * f.angle.factor, stated.pointing * f.angle.factor, 0.0};
    const TiePass pass = linearise(s.problem, s.state, now, scale);
    scale = pass.scale;
    update_white(pass.blocks, use, o, f);
  }
  return f;
}

TEST(VarianceComponents, RangesAndAnglesAreToldApart) {
  const auto s = bench_with(0.03, 1e-4);
  const SigmaFactors f = white_of(*s, {0.02, 5e-5, 0.0, 0.0});
  EXPECT_TRUE(f.range.estimated);
  EXPECT_TRUE(f.angle.estimated);
  EXPECT_NEAR(f.range.factor, 1.5, 0.1);  // 3000 returns: 2 % of a sigma
  EXPECT_NEAR(f.angle.factor, 2.0, 0.2);
  EXPECT_GT(f.range.redundancy, f.angle.redundancy * 0.5);
}

TEST(VarianceComponents, AnglesThatNothingTellsAreKept) {
  const auto s = bench_with(0.03, 1e-6, 3.0 * deg, 10);
  const SigmaFactors f = white_of(*s, {0.02, 1e-6, 0.0, 0.0});
  EXPECT_TRUE(f.range.estimated);
  EXPECT_NEAR(f.range.factor, 1.5, 0.15);
  EXPECT_FALSE(f.angle.estimated);
  EXPECT_EQ(f.angle.factor, 1.0);
}

TEST(VarianceComponents, SwitchedOffIsKept) {
  const auto s = bench_with(0.03, 1e-4);
  ComponentOptions o;
  o.range = o.angle = false;
  const SigmaFactors f = white_of(*s, {0.02, 5e-5, 0.0, 0.0}, o);
  EXPECT_EQ(f.range.factor, 1.0);
  EXPECT_EQ(f.angle.factor, 1.0);
  EXPECT_FALSE(f.range.estimated);
}

TEST(VarianceComponents, FewDegreesOfFreedomMoveAFactorLittle) {
  // A correction of exactly one sigma times three in each knot, known without error: Omega is 9 per unknown.
  const auto s = bench_with(0.02, 1e-5, 10.0 * deg, 5);
  const int n = s->knots.size();
  TieSolution solution;
  TieMatrix known = TieMatrix::dense(n + 2);
  for (int i = 0; i < n + 2; ++i) known.add({i}, Eigen::MatrixXd::Constant(1, 1, 1e15));
  auto inverse = std::make_shared<TieInverse>(known);
  inverse->invert();
  solution.inverse = inverse;
  TiePrior prior = s->prior(Eigen::VectorXd::Zero(2), Eigen::VectorXd::Zero(2));
  prior.corrections = TieMatrix::dense(n + 2);
  for (int i = 2; i < n + 2; ++i) prior.corrections.add({i}, Eigen::MatrixXd::Identity(1, 1));
  const TiePass pass = linearise(s->problem, s->state, s->noise, 1.0);
  const TieSystem system(s->problem, pass.blocks, {}, 0.003);
  const TieSelection use{std::vector<char>(s->ties.groups.size(), 0), {}};
  const TieTests tests{std::vector<TieTest>(s->ties.groups.size()), {}};
  const auto factor = [&](double freedom) {
    ComponentOptions o;
    o.freedom = freedom;
    SigmaFactors f;
    update_correlated(s->problem, system, solution, tests, use, prior, Eigen::VectorXd::Constant(n, 3.0), o, f);
    EXPECT_NEAR(f.position[line_mean].redundancy, n / 2.0, 1e-9);
    EXPECT_TRUE(f.attitude[line_mean].estimated);
    EXPECT_FALSE(f.control.estimated);
    return f.position[line_mean].factor;
  };
  const double r = n / 2.0;
  EXPECT_NEAR(factor(1e9), 1.0, 1e-6);
  EXPECT_NEAR(factor(10.0 * r), std::sqrt((10.0 * r + 9.0 * r) / (11.0 * r)), 1e-9);
  EXPECT_EQ(factor(1.0), 2.0);  // no more than twice in one round
}

}  // namespace
}  // namespace swath::calib
