// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/tie_normals.h"

#include <gtest/gtest.h>

#include "tests/calib/tie_block.h"

namespace swath::calib {
namespace {

using namespace test;

// A flight whose state is at the truth, corrections in it: then every condition is zero and every derivative that of the records.
struct Setting {
  explicit Setting(core::ScannerModel model = core::ScannerModel::mirror) {
    world = make_world({{0.3, 0.0}, {0.3 + 180.0 * deg, 50.0}}, block_planes(3, 4, 9));
    world.returns = 12;
    world.scanner.model = model;
    world.truth.latency = core::Seconds(0.003);
    world.truth.range_scale = 1.00002;
    ties = ties_of(world, nullptr);
    const Correction error = (Correction() << 0.3, -0.2, 0.4, 0.001, -0.002, 0.003).finished();
    trajectory = std::make_unique<trajectory::Trajectory>(ErrorDraw::add(world.exact, [&](double) { return Correction(-error); }));
    CorrectionOptions o;
    o.spacing = core::Seconds(4.0);
    knots = std::make_unique<CorrectionKnots>(ties.lines, world.truth.latency.value, o, tactical_errors);
    problem = {&ties, &world.scanner, trajectory.get(), knots.get(), {}, RobustWeight(2.5, 6.0), 1};
    for (int k = boresight_roll; k <= latency; ++k) problem.globals.push_back(static_cast<Parameter>(k));
    state = {world.truth, Eigen::VectorXd::Zero(knots->size()), ties.planes, std::vector<double>(ties.planes.size(), 0.0)};
    for (int i = 0; i < knots->size(); i += 3) state.correction.segment<3>(i) = knots->is_position(i) ? error.head<3>() : error.tail<3>();
  }

  double distance(const TieState& at, const TieGroup& g, size_t row) const {
    trajectory::Cursor cursor(*trajectory);
    Condition c;
    EXPECT_TRUE(condition_of(problem, ShotGeometry(world.scanner, at.calibration), at, noise, cursor, g, row, c));
    return c.f;
  }

  World world;
  TieSet ties;
  std::unique_ptr<trajectory::Trajectory> trajectory;
  std::unique_ptr<CorrectionKnots> knots;
  TieProblem problem;
  TieState state;
  TieNoise noise{0.02, 2e-5, 5e-5, 0.0};
};

TEST(TieNormals, TruthFulfilsTheConditions) {
  const Setting s;
  const TiePass pass = linearise(s.problem, s.state, s.noise, 1.0);
  // Angles of attitude carried through Euler angles: 1e-8 m; the correction's turn of the nadir: 0.4 m / 6.4e6 m * 1 km = 0.06 mm.
  for (const GroupBlock& b : pass.blocks) EXPECT_LT(std::sqrt(b.c / b.weight()), 1e-4);
}

TEST(TieNormals, DerivativesAreCentralDifferences) {
  constexpr double corrections_rate = 5e-3;  // m/s: latency moves returns along the corrections too, which the derivative leaves out
  const Setting s;
  const size_t globals = s.problem.globals.size();
  trajectory::Cursor cursor(*s.trajectory);
  for (const size_t number : {size_t{0}, s.ties.groups.size() / 2, s.ties.groups.size() - 1}) {
    const TieGroup& g = s.ties.groups[number];
    const size_t row = g.begin + 3;
    Condition c;
    ASSERT_TRUE(condition_of(s.problem, ShotGeometry(s.world.scanner, s.state.calibration), s.state, s.noise, cursor, g, row, c));
    const auto expect = [&](double derivative, double h, const auto& perturb, const std::string& what, double rest = 0.0) {
      TieState up = s.state, down = s.state;
      perturb(up, h);
      perturb(down, -h);
      const double difference = (s.distance(up, g, row) - s.distance(down, g, row)) / (2.0 * h);
      // Rounding of ecef coordinates 2e-9 m; the nadir's turn; what is left of the conditions themselves (1e-4 m of 1 km).
      EXPECT_NEAR(derivative, difference, 2e-6 * std::max(1.0, std::abs(difference)) + 4e-9 / h + rest) << what << " group " << number;
    };
    for (size_t k = 0; k < globals; ++k) {
      const Parameter p = s.problem.globals[k];
      const bool metres = (p >= lever_forward && p <= range_offset);
      expect(
          c.by[p], metres ? 0.1 : 1e-4, [&](TieState& t, double d) { set_value(t.calibration, p, value_of(t.calibration, p) + d); },
          "parameter " + std::to_string(p), p == latency ? corrections_rate : 0.0);
    }
    const double t = s.ties.returns.time[row] + s.world.truth.latency.value;
    std::vector<int> numbers;
    const Eigen::MatrixXd D = s.knots->derivatives(g.line, t, numbers);
    const Eigen::RowVectorXd by = c.by.segment<6>(position_north) * D;
    for (size_t i = 0; i < numbers.size(); ++i)
      expect(
          by[static_cast<Eigen::Index>(i)], s.knots->is_position(numbers[i]) ? 0.1 : 1e-4,
          [&](TieState& to, double d) { to.correction[numbers[i]] += d; }, "correction " + std::to_string(i));
    const double plane[3] = {-1.0, -c.u, -c.v};
    for (int i = 0; i < 3; ++i)
      expect(
          plane[i], 1e-3, [&](TieState& to, double d) { move_plane(to.planes[g.plane], d * Eigen::Vector3d::Unit(i)); },
          "plane " + std::to_string(i));
  }
}

TEST(TieNormals, OtherScannersToo) {
  for (const core::ScannerModel model : {core::ScannerModel::conical, core::ScannerModel::polygon}) {
    Setting s;
    s.world.scanner.model = model;
    trajectory::Cursor cursor(*s.trajectory);
    const TieGroup& g = s.ties.groups[2];
    Condition c;
    ASSERT_TRUE(
        condition_of(s.problem, ShotGeometry(s.world.scanner, s.state.calibration), s.state, {1e-3, 0.0, 0.0, 0.0}, cursor, g, g.begin, c));
    EXPECT_TRUE(std::isfinite(c.f));
    EXPECT_GT(c.variance(), 0.0);
  }
}

TEST(TieNormals, BlocksAreSumsOfRows) {
  Setting s;
  Dice dice(4);
  for (double& r : s.ties.returns.range) r += 0.01 * dice.normal();
  const TiePass pass = linearise(s.problem, s.state, s.noise, 1.0);
  const size_t number = s.ties.groups.size() / 3;
  const TieGroup& g = s.ties.groups[number];
  const GroupBlock& block = pass.blocks[number];
  const auto m = static_cast<Eigen::Index>(block.index.size());
  Eigen::MatrixXd N = Eigen::MatrixXd::Zero(m + 3, m + 3);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(m + 3);
  trajectory::Cursor cursor(*s.trajectory);
  const ShotGeometry geometry(s.world.scanner, s.state.calibration);
  for (size_t i = g.begin; i < g.end; ++i) {
    Condition c;
    ASSERT_TRUE(condition_of(s.problem, geometry, s.state, s.noise, cursor, g, i, c));
    Eigen::VectorXd all = Eigen::VectorXd::Zero(s.problem.size());
    for (size_t k = 0; k < s.problem.globals.size(); ++k) all[k] = c.by[s.problem.globals[k]];
    std::vector<int> numbers;
    const Eigen::RowVectorXd by =
        c.by.segment<6>(position_north) * s.knots->derivatives(g.line, geometry.time(s.ties.returns.time[i]), numbers);
    for (size_t k = 0; k < numbers.size(); ++k) all[s.problem.globals.size() + numbers[k]] = by[k];
    Eigen::VectorXd a(m + 3);
    for (Eigen::Index k = 0; k < m; ++k) a[k] = all[block.index[k]];
    EXPECT_NEAR(all.squaredNorm(), a.head(m).squaredNorm(), 1e-9 * all.squaredNorm());
    a.tail<3>() << -1.0, -c.u, -c.v;
    const double w = s.problem.robust(pass.deviation[i]) / c.variance();
    N += w * a * a.transpose();
    b += w * c.f * a;
  }
  EXPECT_LT((N - block.N).norm(), 1e-6 * N.norm());
  EXPECT_LT((b - block.b).norm(), 1e-6 * b.norm());
}

TEST(TieNormals, OutliersOfAGroupHaveNoWeight) {
  Setting s;
  Dice dice(4);
  for (double& r : s.ties.returns.range) r += 0.02 * dice.normal();
  const TieGroup& g = s.ties.groups[1];
  s.ties.returns.range[g.begin + 2] -= 3.0;  // a branch above the roof
  s.ties.returns.time[g.begin + 5] = 1.0;    // long before the flight
  const TiePass pass = linearise(s.problem, s.state, s.noise, 1.0);
  EXPECT_EQ(pass.blocks[1].rejected, 1u);
  EXPECT_EQ(pass.blocks[1].outside, 1u);
  EXPECT_EQ(pass.blocks[1].used, g.end - g.begin - 2);
  EXPECT_TRUE(std::isnan(pass.deviation[g.begin + 5]));
  EXPECT_NEAR(pass.scale, 0.7, 0.2);  // ranges have their noise here, angles and pointing have none
}

TEST(TieNormals, TheSameForAnyNumberOfThreads) {
  Setting s;
  const TiePass one = linearise(s.problem, s.state, s.noise, 1.0);
  s.problem.threads = 3;
  const TiePass three = linearise(s.problem, s.state, s.noise, 1.0);
  for (size_t g = 0; g < one.blocks.size(); ++g) {
    EXPECT_EQ(one.blocks[g].N, three.blocks[g].N);
    EXPECT_EQ(one.blocks[g].b, three.blocks[g].b);
  }
}

TEST(TieNormals, APlaneMovesByItsUnknowns) {
  TiePlane p = block_planes(1, 1, 3)[1];
  const TiePlane old = p;
  const auto axes = plane_axes(p.normal);
  const Eigen::Vector3d d(0.4, 0.02, -0.03);
  move_plane(p, d);
  for (const auto& [u, v] : {std::pair{3.0, -2.0}, std::pair{-5.0, 1.0}, std::pair{0.0, 0.0}}) {
    const Eigen::Vector3d q = old.centre + u * axes[0] + v * axes[1] + (d[0] + d[1] * u + d[2] * v) * old.normal;
    EXPECT_NEAR(p.normal.dot(q - p.centre), 0.0, 1e-12);
  }
  EXPECT_NEAR(p.normal.norm(), 1.0, 1e-14);
}

TEST(TieNormals, ValuesByParameter) {
  core::Calibration c;
  for (int k = boresight_roll; k <= latency; ++k) set_value(c, static_cast<Parameter>(k), 0.1 * k + 1.0);
  for (int k = boresight_roll; k <= latency; ++k) EXPECT_EQ(value_of(c, static_cast<Parameter>(k)), 0.1 * k + 1.0);
  EXPECT_EQ(c.scan_offset.value, 0.1 * static_cast<int>(scan_offset) + 1.0);
}

}  // namespace
}  // namespace swath::calib
