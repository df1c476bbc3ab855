// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/ins_output.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/geo/geodesy.h"
#include "tests/trajectory/ins_problem.h"
#include "trajectory/trajectory.h"

namespace swath::trajectory {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::InsProblem;

constexpr double position_off = 0.003, angle_off = 2e-5;  // m, rad by which the nodes miss the truth

constexpr double many_instants = 0.03;  // s between them: more than are worked on in one part

/// Nodes that lie about the truth, each with its own covariance.
std::vector<SmoothedNode> nodes_of(const InsProblem& made, double velocity_off = 0.003) {
  test::Dice dice(9);
  std::vector<SmoothedNode> out;
  for (size_t k = 0; k < made.nodes.size(); ++k) {
    SmoothedNode n;
    n.estimate.nav = test::nav_at(made.motion, made.nodes[k].time - test::motion_start);
    n.estimate.nav.time = made.nodes[k].time;
    n.estimate.nav.position += position_off * dice.vector();
    n.estimate.nav.velocity += velocity_off * dice.vector();
    n.estimate.nav.ecef_R_body = core::exp_so3(angle_off * dice.vector()) * n.estimate.nav.ecef_R_body;
    core::CovarianceSeries::Matrix9 c = core::CovarianceSeries::Matrix9::Identity();
    c *= std::pow(0.01 * (1 + static_cast<double>(k % 3)), 2);
    n.covariance = core::CovarianceSeries::pack(c);
    out.push_back(n);
  }
  return out;
}

InsProblem::Setup exact_setup(double spacing = 0.25) {
  InsProblem::Setup s;
  s.sensors.imu_step = 0.005;
  s.imu = {};
  s.spacing = spacing;
  return s;
}

Vector3d position(const core::TrajectoryData& d, size_t k) { return core::ecef_of({d.latitude[k], d.longitude[k], d.height[k]}); }
Matrix3d ned(const core::TrajectoryData& d, size_t k) { return core::ecef_R_ned(d.latitude[k], d.longitude[k]); }
Vector3d velocity(const core::TrajectoryData& d, size_t k) { return ned(d, k) * Vector3d(d.v_north[k], d.v_east[k], d.v_down[k]); }
Matrix3d attitude(const core::TrajectoryData& d, size_t k) { return ned(d, k) * core::matrix_of({d.roll[k], d.pitch[k], d.heading[k]}); }

TEST(InsOutput, MeetsTheNodesAndNothingJumps) {
  const InsProblem made(test::motion_of(test::survey_flight(2)), exact_setup());
  const std::vector<SmoothedNode> nodes = nodes_of(made);
  const core::TrajectoryData d = trajectory_of(*made.problem, nodes, 200.0);
  ASSERT_EQ(d.size(), made.path.imu.size());
  // Records at nodes are the nodes.
  size_t met = 0;
  for (size_t k = 1; k < made.nodes.size(); ++k) {
    const auto at = std::lower_bound(d.time.begin(), d.time.end(), made.nodes[k].time - 1e-5);
    if (at == d.time.end() || std::abs(*at - made.nodes[k].time) > 1e-6) continue;
    const auto i = static_cast<size_t>(at - d.time.begin());
    ++met;
    EXPECT_LT((position(d, i) - nodes[k].estimate.nav.position).norm(), 1e-8);
    EXPECT_LT((velocity(d, i) - nodes[k].estimate.nav.velocity).norm(), 1e-8);
    EXPECT_LT((attitude(d, i) - nodes[k].estimate.nav.ecef_R_body).norm(), 1e-9);
    EXPECT_NEAR(d.sigma_north[i], 0.01 * (1 + static_cast<double>(k % 3)), 1e-6);
  }
  EXPECT_GT(met, 90u);
  // Between them: positions differ by the velocities. The largest misclosures, some 2 cm over 0.2 s, are slopes of 1.5 times 0.1 m/s beside
  // the velocities; one that is not spread would show as 2 cm in 5 ms, 4 m/s.
  constexpr double spread = 0.2;  // m/s
  double worst = 0, worst_turn = 0;
  for (size_t k = 1; k < d.size(); ++k) {
    const double dt = d.time[k] - d.time[k - 1];
    EXPECT_NEAR(dt, 0.005, 1e-6);
    worst = std::max(worst, ((position(d, k) - position(d, k - 1)) / dt - 0.5 * (velocity(d, k) + velocity(d, k - 1))).norm());
    const test::Truth a = test::truth_at(made.motion, d.time[k - 1] - test::motion_start),
                      b = test::truth_at(made.motion, d.time[k] - test::motion_start);
    const Matrix3d step = attitude(d, k) * attitude(d, k - 1).transpose(), true_step = b.ecef_R_body * a.ecef_R_body.transpose();
    worst_turn = std::max(worst_turn, core::log_so3(step * true_step.transpose()).norm());
  }
  EXPECT_LT(worst, spread);
  // 4e-5 rad over 40 steps, not at once.
  EXPECT_LT(worst_turn, 5e-6);
}

TEST(InsOutput, PositionsLeaveAndMeetTheNodesWithTheirVelocities) {
  // Velocities that are off by 0.1 m/s from node to node, and with them positions by 2 cm over 0.2 s.
  const InsProblem made(test::motion_of(test::survey_flight(2)), exact_setup());
  const std::vector<SmoothedNode> nodes = nodes_of(made, 0.1);
  const core::TrajectoryData d = trajectory_of(*made.problem, nodes, 200.0);
  double beside_nodes = 0;
  for (size_t k = 1; k < d.size(); ++k) {
    // Records 39, 79 ... lie at nodes: the step that ends there, and the next one.
    if (k % 40 != 39 && k % 40 != 0) continue;
    const double dt = d.time[k] - d.time[k - 1];
    const Vector3d apart = (position(d, k) - position(d, k - 1)) / dt - 0.5 * (velocity(d, k) + velocity(d, k - 1));
    beside_nodes = std::max(beside_nodes, apart.norm());
  }
  // Slopes of the cubic half a step from its ends: 7 % of the 0.2 m/s by which the positions miss, 4 % of the 0.3 m/s of the velocities.
  EXPECT_LT(beside_nodes, 0.03);
}

TEST(InsOutput, SigmasAndCovariancesAreLinearBetweenNodes) {
  const InsProblem made(test::motion_of(test::survey_flight(2)), exact_setup());
  const std::vector<SmoothedNode> nodes = nodes_of(made);
  const core::TrajectoryData d = trajectory_of(*made.problem, nodes, 200.0);
  ASSERT_EQ(d.covariance.time.size(), made.nodes.size());
  for (size_t k = 0; k < d.size(); k += 17) {
    const auto c = d.covariance.at(d.time[k]);
    EXPECT_NEAR(d.sigma_down[k], std::sqrt(c(2, 2)), 1e-6);
    EXPECT_NEAR(d.sigma_heading[k], std::sqrt(c(8, 8)), 1e-6);
  }
  EXPECT_EQ(d.covariance.upper[5], nodes[5].covariance);
}

TEST(InsOutput, RateDecimates) {
  const InsProblem made(test::motion_of(test::survey_flight(2)), exact_setup(many_instants));
  const std::vector<SmoothedNode> nodes = nodes_of(made);
  const core::TrajectoryData all = trajectory_of(*made.problem, nodes, 200.0);
  for (const double rate : {100.0, 50.0, 10.0, 1.0}) {
    const core::TrajectoryData d = trajectory_of(*made.problem, nodes, rate);
    const auto every = static_cast<size_t>(std::lround(200.0 / rate));
    EXPECT_EQ(d.size(), (all.size() + every - 1) / every);
    for (size_t k = 1; k < d.size(); ++k) ASSERT_NEAR(d.time[k] - d.time[k - 1], 1 / rate, 1e-6);
    // Fewer records, the same values.
    EXPECT_EQ(d.latitude[d.size() - 1], all.latitude[(d.size() - 1) * every]);
  }
  EXPECT_EQ(trajectory_of(*made.problem, nodes, 2000.0).size(), all.size());
}

/// What a linearisation takes is the same trajectory, where it is wanted.
TEST(InsOutput, PosesOfSomeIntervalsAreThoseOfTheTrajectory) {
  const InsProblem made(test::motion_of(test::survey_flight(2)), exact_setup(many_instants));
  const std::vector<SmoothedNode> nodes = nodes_of(made);
  std::vector<Estimate> estimates;
  for (const SmoothedNode& n : nodes) estimates.push_back(n.estimate);
  for (const double rate : {200.0, 50.0}) {
    const core::TrajectoryData all = trajectory_of(*made.problem, nodes, rate);
    std::vector<char> wanted(nodes.size() - 1, 0);
    for (size_t k = 0; k < wanted.size(); ++k) wanted[k] = k % 7 < 3;
    const PoseRecords some = poses_of(*made.problem, estimates, OutputRecords(*made.problem, rate), wanted);
    size_t i = 0;
    for (size_t k = 0; k < all.size(); ++k) {
      // The record at a node ends the interval before it.
      const auto next = std::lower_bound(made.nodes.begin() + 1, made.nodes.end() - 1, all.time[k] - 1e-6,
                                         [](const Node& n, double t) { return n.time < t; });
      if (!wanted[static_cast<size_t>(next - made.nodes.begin()) - 1]) continue;
      ASSERT_LT(i, some.time.size());
      EXPECT_EQ(some.time[i], all.time[k]);
      EXPECT_LT((some.position[i] - position(all, k)).norm(), 1e-8);
      EXPECT_LT((some.ecef_R_body[i] - attitude(all, k)).norm(), 1e-12);
      ++i;
    }
    EXPECT_EQ(i, some.time.size());
    EXPECT_GT(i, all.size() / 3);
  }
}

TEST(InsOutput, BridgedStretchesHaveNoRecords) {
  InsProblem::Setup setup = exact_setup();
  setup.change_imu = [](core::ImuData imu) {
    for (auto* v : {&imu.angle, &imu.velocity}) v->erase(v->begin() + 1000, v->begin() + 1100);
    for (auto* v : {&imu.time, &imu.step}) v->erase(v->begin() + 1000, v->begin() + 1100);
    return imu;
  };
  const InsProblem made(test::motion_of(test::survey_flight(2)), setup);
  const core::TrajectoryData d = trajectory_of(*made.problem, nodes_of(made), 200.0);
  EXPECT_EQ(d.size(), 3900u);
  double longest = 0;
  for (size_t k = 1; k < d.size(); ++k) longest = std::max(longest, d.time[k] - d.time[k - 1]);
  EXPECT_NEAR(longest, 0.505, 1e-6);
  // The trajectory as others use it is then two spans.
  EXPECT_EQ(Trajectory(d).spans().size(), 2u);
}

}  // namespace
}  // namespace swath::trajectory
