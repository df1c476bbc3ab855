// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/tie_system.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "tests/calib/tie_block.h"

namespace swath::calib {
namespace {

using namespace test;
using Eigen::MatrixXd;
using Eigen::VectorXd;

const std::vector<Parameter> some_globals = {boresight_roll, boresight_pitch, boresight_heading, range_offset, scan_scale};

std::unique_ptr<TieBench> bench_of(std::uint64_t seed) {
  World w = make_world({{0.0, 0.0}, {180.0 * deg, 60.0}, {90.0 * deg, 0.0}}, block_planes(2, 3, seed));
  w.returns = 8;
  Dice dice(seed);
  survey(w.planes[1], 0.02, &dice);
  TieSet ties = ties_of(w, &dice);
  CorrectionOptions o;
  o.attitude = CorrectionForm::drift;
  o.spacing = core::Seconds(7.0);
  auto bench = std::make_unique<TieBench>(w, ties, w.exact, o, some_globals);
  bench->state.calibration.pitch.value += 1e-4;
  return bench;
}

// Every return, control point and prior value as rows of one matrix; unknowns: globals, corrections, each group's departure, planes.
struct Dense {
  MatrixXd N;
  VectorXd b;
  Eigen::Index planes_at;
};
Dense dense_of(const TieBench& s, const TiePass& pass, const std::vector<ControlRow>& control, const TiePrior& prior, double surface) {
  const auto unknowns = static_cast<Eigen::Index>(s.problem.size()), groups = static_cast<Eigen::Index>(s.ties.groups.size());
  Dense d;
  d.planes_at = unknowns + groups;
  const Eigen::Index n = d.planes_at + 3 * static_cast<Eigen::Index>(s.ties.planes.size());
  d.N = MatrixXd::Zero(n, n);
  d.b = VectorXd::Zero(n);
  trajectory::Cursor cursor(s.flown);
  const ShotGeometry geometry(s.world.scanner, s.state.calibration);
  for (size_t g = 0; g < s.ties.groups.size(); ++g)
    for (size_t i = s.ties.groups[g].begin; i < s.ties.groups[g].end; ++i) {
      Condition c;
      EXPECT_TRUE(condition_of(s.problem, geometry, s.state, s.noise, cursor, s.ties.groups[g], i, c));
      VectorXd a = VectorXd::Zero(n);
      for (size_t k = 0; k < s.problem.globals.size(); ++k) a[k] = c.by[s.problem.globals[k]];
      std::vector<int> numbers;
      const Eigen::RowVectorXd by =
          c.by.segment<6>(position_north) * s.knots.derivatives(s.ties.groups[g].line, geometry.time(s.ties.returns.time[i]), numbers);
      for (size_t k = 0; k < numbers.size(); ++k) a[s.problem.globals.size() + numbers[k]] = by[k];
      a[unknowns + static_cast<Eigen::Index>(g)] = 1.0;
      a.segment<3>(d.planes_at + 3 * s.ties.groups[g].plane) << -1.0, -c.u, -c.v;
      const double w = s.problem.robust(pass.deviation[i]) / c.variance();
      d.N += w * a * a.transpose();
      d.b += w * c.f * a;
    }
  d.N.diagonal().segment(unknowns, groups).array() += 1.0 / (surface * surface);
  for (const ControlRow& r : control) {
    VectorXd a = VectorXd::Zero(n);
    a.segment<3>(d.planes_at + 3 * r.plane) = r.by;
    d.N += a * a.transpose() / (r.sigma * r.sigma);
    d.b += a * r.f / (r.sigma * r.sigma);
  }
  const auto knots = s.knots.size(), globals = static_cast<int>(s.problem.globals.size());
  d.N.block(globals, globals, knots, knots) += prior.corrections.whole().bottomRightCorner(knots, knots);
  d.b.segment(globals, knots) += prior.corrections.times(prior.present).tail(knots);
  d.N.diagonal().head(globals) += prior.globals;
  d.b.head(globals) += prior.globals.cwiseProduct(prior.departure);
  return d;
}

TiePrior prior_of(const TieBench& s) { return s.prior(VectorXd::Constant(5, 1e4), VectorXd::LinSpaced(5, 0.0, 1e-3)); }

TEST(TieSystem, SameAnswerAsDenseLeastSquares) {
  const auto s = bench_of(3);
  for (Eigen::Index i = 0; i < s->state.correction.size(); ++i)
    s->state.correction[i] = (s->knots.is_position(static_cast<int>(i)) ? 1e-2 : 1e-5) * std::sin(i);
  const TiePass pass = linearise(s->problem, s->state, s->noise, 1.0);
  const double surface = 0.004;
  const TieSystem system(s->problem, pass.blocks, control_rows(s->state.planes, 1.5), surface);
  const TieSelection use{std::vector<char>(s->ties.groups.size(), 1), std::vector<char>(4, 1)};
  std::vector<PlaneRest> rests;
  Normals n = system.sum(use, rests);
  const TiePrior prior = prior_of(*s);
  add_prior(prior, n);
  const TieSolution solution = solve(system, n, rests, Inverse::both);
  ASSERT_TRUE(solution.solved);

  const Dense dense = dense_of(*s, pass, control_rows(s->state.planes, 1.5), prior, surface);
  const VectorXd scale = dense.N.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd C = scale.asDiagonal() * (scale.asDiagonal() * dense.N * scale.asDiagonal()).inverse() * scale.asDiagonal();
  const VectorXd x = -C * dense.b;
  // Nine digits of a sigma: a tenth of a million of it is lost by the condition of 1e6 to 1e8.
  constexpr double share = 1e-6;
  for (Eigen::Index i = 0; i < solution.x.size(); ++i) {
    const double sigma = std::sqrt(C(i, i));
    EXPECT_NEAR(solution.x[i], x[i], share * sigma + 1e-6 * std::abs(x[i])) << i;
    EXPECT_NEAR(solution.covariance({static_cast<int>(i)})(0, 0), C(i, i), 1e-5 * C(i, i)) << i;
  }
  for (size_t k = 0; k < s->ties.planes.size(); ++k) {
    const Eigen::Index at = dense.planes_at + 3 * static_cast<Eigen::Index>(k);
    const Eigen::Matrix3d P = plane_covariance(rests[k], solution.covariance(rests[k].index));
    for (int i = 0; i < 3; ++i) {
      // The planes' damping is in the one and not in the other: 1e-4 / m^2 against 1e4.
      EXPECT_NEAR(solution.d[k][i], x[at + i], 1e-3 * std::sqrt(C(at + i, at + i)));
      EXPECT_NEAR(P(i, i), C(at + i, at + i), 1e-3 * C(at + i, at + i));
    }
    // A function of unknowns and plane.
    VectorXd h = VectorXd::Zero(4);
    h << 300.0, 1.0, 2.0, -1.0;
    VectorXd all = VectorXd::Zero(C.rows());
    all[1] = 300.0;
    all.segment<3>(at) << 1.0, 2.0, -1.0;
    const double expected = all.dot(C * all);
    EXPECT_NEAR(PlaneRow(h, {1}, rests[k]).variance(solution.covariance(rests[k].index)), expected, 1e-3 * expected);
  }
}

TEST(TieSystem, LeavingOutIsSubtracting) {
  const auto s = bench_of(5);
  const TiePass pass = linearise(s->problem, s->state, s->noise, 1.0);
  const TieSystem system(s->problem, pass.blocks, control_rows(s->state.planes, 1.0), 0.003);
  TieSelection use{std::vector<char>(s->ties.groups.size(), 1), std::vector<char>(4, 1)};
  std::vector<PlaneRest> rests;
  Normals all = system.sum(use, rests);
  TieSelection without = use;
  without.group[4] = 0;
  const std::uint32_t plane = s->ties.groups[4].plane;
  system.add(plane, use, -1.0, all);
  system.add(plane, without, 1.0, all);
  const Normals expected = system.sum(without, rests);
  EXPECT_LT((all.N.whole() - expected.N.whole()).norm(), 1e-12 * expected.N.whole().norm());
  EXPECT_LT((all.b - expected.b).norm(), 1e-9 * expected.b.norm());
}

// Chained lines: everything that is asked of the inverse is what the dense matrix gives, a group left out among it.
TEST(TieSystem, ChainedLinesAsTheDenseMatrix) {
  World w = make_world({{0.0, 0.0}, {180.0 * deg, 60.0}, {90.0 * deg, 0.0}}, block_planes(2, 3, 3));
  w.returns = 8;
  Dice dice(3);
  survey(w.planes[1], 0.02, &dice);
  survey(w.planes[5], 0.02, &dice);
  const TieSet ties = ties_of(w, &dice);
  CorrectionOptions o;
  o.spacing = core::Seconds(0.2);
  const TieBench s(w, ties, w.exact, o, some_globals);
  ASSERT_TRUE(s.knots.is_chained());
  const TiePass pass = linearise(s.problem, s.state, s.noise, 1.0);
  const TieSystem system(s.problem, pass.blocks, control_rows(s.state.planes, 1.0), 0.004);
  TieSelection use{std::vector<char>(ties.groups.size(), 1), std::vector<char>(8, 1)};
  use.group[4] = 0;
  use.control[2] = 0;
  std::vector<PlaneRest> rests;
  Normals n = system.sum(use, rests);
  add_prior(s.prior(VectorXd::Constant(5, 1e4), VectorXd::Zero(5)), n);
  const TieSolution solution = solve(system, n, rests, Inverse::both);
  ASSERT_TRUE(solution.solved);
  const MatrixXd N = n.N.whole();
  const VectorXd scale = N.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd C = scale.asDiagonal() * (scale.asDiagonal() * N * scale.asDiagonal()).llt().solve(MatrixXd(scale.asDiagonal()));
  const auto near = [&](const MatrixXd& is, const MatrixXd& wanted) {
    for (Eigen::Index i = 0; i < is.rows(); ++i)
      for (Eigen::Index j = 0; j < is.cols(); ++j) EXPECT_NEAR(is(i, j), wanted(i, j), 1e-5 * std::sqrt(wanted(i, i) * wanted(j, j)));
  };
  EXPECT_LT((solution.x + C * n.b).cwiseQuotient(C.diagonal().cwiseSqrt()).cwiseAbs().maxCoeff(), 1e-5);
  for (const PlaneRest& rest : rests) near(solution.covariance(rest.index), C(rest.index, rest.index));
  near(solution.of_globals(5), C.topLeftCorner(5, 5));
  std::vector<int> numbers;
  s.knots.derivatives(1, s.ties.lines[1].first + 4.04, numbers);
  for (int& k : numbers) k += 5;
  near(solution.covariance(numbers), C(numbers, numbers));
  EXPECT_LT((solution.inverse->diagonal() - C.diagonal()).cwiseQuotient(C.diagonal()).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(TieSystem, WhiteNormalsAreThoseOfIndependentReturns) {
  const auto s = bench_of(6);
  const TiePass pass = linearise(s->problem, s->state, s->noise, 1.0);
  const TieSystem system(s->problem, pass.blocks, {}, 0.003);
  const TieSelection use{std::vector<char>(s->ties.groups.size(), 1), {}};
  Normals white(5);
  for (std::uint32_t k = 0; k < system.planes(); ++k) system.add(k, use, 1.0, white, true);
  // The same from blocks without surface, its corrections' rows left out.
  const TieSystem bare(s->problem, pass.blocks, {}, 0.0);
  std::vector<PlaneRest> rests;
  const Normals n = bare.sum(use, rests);
  EXPECT_LT((white.N.whole() - n.N.whole().topLeftCorner(5, 5)).norm(), 1e-12 * white.N.whole().norm());
}

TEST(TieSystem, ControlRows) {
  TiePlane p = block_planes(1, 1, 3)[1];
  survey(p, 0.02, nullptr);
  p.control[2].point += 0.1 * p.normal;
  const std::vector<ControlRow> rows = control_rows({p}, 2.0);
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_NEAR(rows[0].f, 0.0, 1e-12);
  EXPECT_NEAR(rows[2].f, 0.1, 1e-12);
  EXPECT_DOUBLE_EQ(rows[1].sigma, 0.04);
  // d0 and the slopes move the plane towards the point.
  TiePlane moved = p;
  move_plane(moved, {1e-4, 2e-4, -1e-4});
  EXPECT_NEAR(control_rows({moved}, 1.0)[3].f - rows[3].f, rows[3].by.dot(Eigen::Vector3d(1e-4, 2e-4, -1e-4)), 1e-7);
}

}  // namespace
}  // namespace swath::calib
