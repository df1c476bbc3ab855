// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/point_smoother.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "tests/trajectory/made_flight.h"
#include "trajectory/interpolators.h"

namespace swath::trajectory {
namespace {

/// One motion for a whole record.
MotionModel model_of(double acceleration, double time) {
  const AxisMotion m = motion_of(acceleration, time);
  return {{0.0}, {{m, motion_of(2.0 * acceleration, time), m}}};
}

/// The same estimate as one least-squares problem over all instants: nodes joined by the model, some of them observed.
struct Batch {
  std::vector<double> time;
  Eigen::MatrixXd information;
  Eigen::VectorXd right;

  Batch(std::vector<double> instants, const MotionModel& model) : time(std::move(instants)) {
    const auto n = static_cast<Eigen::Index>(9 * time.size());
    information = Eigen::MatrixXd::Zero(n, n);
    right = Eigen::VectorXd::Zero(n);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const AxisMotion& m = model.motion[0][static_cast<size_t>(axis)];
      information(6 + axis, 6 + axis) += 1.0 / (m.acceleration() * m.acceleration());
      for (size_t i = 0; i + 1 < time.size(); ++i) {
        const double dt = time[i + 1] - time[i];
        Eigen::MatrixXd join = Eigen::MatrixXd::Zero(3, n);
        const Eigen::Matrix3d f = motion_transition(m, dt);
        for (Eigen::Index r = 0; r < 3; ++r) {
          for (Eigen::Index c = 0; c < 3; ++c) join(r, static_cast<Eigen::Index>(9 * i) + 3 * c + axis) = -f(r, c);
          join(r, static_cast<Eigen::Index>(9 * (i + 1)) + 3 * r + axis) = 1.0;
        }
        information += join.transpose() * motion_noise(m, dt).ldlt().solve(join);
      }
    }
  }
  void observe(size_t i, const Eigen::Vector3d& z, const Eigen::Matrix3d& covariance) {
    const auto at = static_cast<Eigen::Index>(9 * i);
    const Eigen::Matrix3d weight = covariance.inverse();
    information.block<3, 3>(at, at) += weight;
    right.segment<3>(at) += weight * z;
  }
  PointState state(size_t i) const {
    const Eigen::LDLT<Eigen::MatrixXd> solver(information);
    const auto at = static_cast<Eigen::Index>(9 * i);
    PointState s;
    s.x = solver.solve(right).segment<6>(at);
    s.covariance = solver.solve(Eigen::MatrixXd::Identity(information.rows(), information.cols())).block<6, 6>(at, at);
    return s;
  }
};

// The batch knows nothing of the start velocity, the smoother has 100 m/s about the first step's: 1e-8 of its variance (0.01 m^2/s^2) and
// of its correction; the batch's own normal equations lose as much.
constexpr double state_tolerance = 1e-6, covariance_tolerance = 1e-5;

void expect_same(const PointState& a, const PointState& b, const std::string& what) {
  EXPECT_LT((a.x - b.x).norm(), state_tolerance) << what;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      EXPECT_NEAR(a.covariance(i, j), b.covariance(i, j), covariance_tolerance * std::sqrt(b.covariance(i, i) * b.covariance(j, j)))
          << what << " " << i << " " << j;
}

TEST(PointSmoother, IsTheLeastSquaresSolutionOfTheWholePass) {
  const PointFixes fixes = test::MadeFlight(1).fixes(12, 1.0);
  const PointSmoother smoother(fixes, model_of(0.4, 1.5));
  Batch all(fixes.time, smoother.model());
  for (size_t i = 0; i < fixes.size(); ++i) all.observe(i, fixes.position[i], fixes.covariance[i]);
  for (size_t i = 0; i < fixes.size(); ++i) expect_same(smoother.at(fixes.time[i]), all.state(i), "fix " + std::to_string(i));
}

TEST(PointSmoother, BetweenFixesAndWithoutAFixToo) {
  const PointFixes fixes = test::MadeFlight(2).fixes(12, 1.0);
  const PointSmoother smoother(fixes, model_of(0.4, 1.5));
  for (const double t : {0.4, 5.7, 10.2}) {
    std::vector<double> instants = fixes.time;
    const auto at = static_cast<size_t>(std::upper_bound(instants.begin(), instants.end(), t) - instants.begin());
    instants.insert(instants.begin() + static_cast<long>(at), t);
    Batch batch(instants, smoother.model());
    for (size_t i = 0; i < fixes.size(); ++i) batch.observe(i < at ? i : i + 1, fixes.position[i], fixes.covariance[i]);
    expect_same(smoother.at(t), batch.state(at), "t " + std::to_string(t));
  }
  for (const size_t out : {3u, 6u, 9u}) {
    Batch batch(fixes.time, smoother.model());
    for (size_t i = 0; i < fixes.size(); ++i)
      if (i != out) batch.observe(i, fixes.position[i], fixes.covariance[i]);
    expect_same(smoother.without(out), batch.state(out), "without " + std::to_string(out));
  }
}

TEST(PointSmoother, ItsSigmaGrowsInAGapAndIsTrue) {
  constexpr double roughness = 0.25;
  double ratio = 0.0, n = 0.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    test::MadeFlight flight(seed, roughness);
    PointFixes fixes = flight.fixes(200, 1.0);
    const auto erase = [](auto& column) { column.erase(column.begin() + 95, column.begin() + 105); };
    erase(fixes.time), erase(fixes.position), erase(fixes.covariance);
    const PointTrack track = track_of(fixes, {}, {});
    const PointSmoother& smoother = track.smoother;
    const PointState in_gap = smoother.at(100.0), beside = smoother.at(50.5);
    EXPECT_GT(in_gap.covariance(0, 0), 10.0 * beside.covariance(0, 0));
    for (double t = 10.3; t < 90.0; t += 1.7, ++n) {
      const PointState s = smoother.at(t);
      const Eigen::Vector3d e = s.position() - flight.position(t);
      const Eigen::Matrix3d covariance = s.covariance.topLeftCorner<3, 3>() + smoother.model().slow_of(stated_at(fixes, t));
      ratio += e.dot(covariance.llt().solve(e)) / 3.0;
    }
  }
  // The model is not the flight's (sums of sines) and the clock's 0.5 ms are unknown to it: true within a fifth, not exactly.
  EXPECT_NEAR(std::sqrt(ratio / n), 1.0, 0.2);
}

}  // namespace
}  // namespace swath::trajectory
