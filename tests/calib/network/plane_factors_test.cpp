// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/network/plane_factors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "tests/calib/tie_block.h"

namespace swath::calib {
namespace {

using namespace test;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Two crossing lines over planes known exactly, and a trajectory that is off by a known error of the states, linear between instants.
struct Crossing {
  World world = make_world({{0.3, 0.0}, {0.3 + 90.0 * deg, 50.0}}, block_planes(3, 4, 9));
  TieSet ties;
  std::vector<double> times;
  trajectory::Layout layout;
  std::vector<Parameter> unknown{boresight_roll, boresight_pitch, boresight_heading, lever_down, range_offset, scan_scale};
  VectorXd error;  // true less estimated: states, then calibration
  std::unique_ptr<FlightStates> states;
  std::unique_ptr<trajectory::Trajectory> off;
  core::Calibration calibration;

  explicit Crossing(double size = 1.0, Dice* noise = nullptr) {
    world.returns = noise ? 60 : 12;
    ties = ties_of(world, noise);
    for (size_t l = 0; l < world.lines.size(); ++l)
      for (double s = -world.margin; s < world.lines[l].duration() + world.margin + 0.1; s += 0.5) times.push_back(world.first(l) + s);
    states = std::make_unique<FlightStates>(layout, times.size(), static_cast<int>(unknown.size()));
    error = VectorXd::Zero(states->first(states->common()) + static_cast<Eigen::Index>(unknown.size()));
    for (int k = 0; k < states->instants(); ++k) {
      // Slow, so that the cubic through the trajectory's records does not round the corners at the instants.
      const double s = 0.4 * (times[static_cast<size_t>(k)] - world.start);
      error.segment<3>(states->first(k)) = 0.05 * size * Vector3d(std::sin(s), std::cos(s), std::sin(s + 2));
      error.segment<3>(states->first(k) + 6) = 2e-4 * size * Vector3d(std::cos(s + 1), std::sin(s + 3), std::cos(s));
    }
    calibration = world.truth;
    const double steps[] = {2e-4, -3e-4, 4e-4, 0.03, 0.02, 1e-4};
    for (size_t i = 0; i < unknown.size(); ++i) {
      error[states->first(states->common()) + static_cast<Eigen::Index>(i)] = size * steps[i];
      set_value(calibration, unknown[i], value_of(calibration, unknown[i]) - size * steps[i]);
    }
    off = std::make_unique<trajectory::Trajectory>(moved(world.exact));
  }

  core::TrajectoryData moved(core::TrajectoryData d) const {
    for (size_t i = 0; i < d.size(); ++i) {
      const auto next = std::upper_bound(times.begin(), times.end(), d.time[i]) - times.begin();
      const auto k = std::clamp<std::ptrdiff_t>(next - 1, 0, static_cast<std::ptrdiff_t>(times.size()) - 2);
      const auto at = static_cast<size_t>(k);
      const double s = std::clamp((d.time[i] - times[at]) / (times[at + 1] - times[at]), 0.0, 1.0);
      const auto first = states->first(static_cast<int>(k)), second = states->first(static_cast<int>(k) + 1);
      const Vector3d shift = (1 - s) * error.segment<3>(first) + s * error.segment<3>(second);
      const Vector3d turn = (1 - s) * error.segment<3>(first + 6) + s * error.segment<3>(second + 6);
      const core::Geodetic g{d.latitude[i], d.longitude[i], d.height[i]};
      const Matrix3d R =
          core::exp_so3(-turn) * core::ecef_R_ned(g.latitude, g.longitude) * core::matrix_of({d.roll[i], d.pitch[i], d.heading[i]});
      const core::Geodetic there = core::geodetic_of(core::ecef_of(g) - shift);
      const core::Attitude a = core::attitude_of(core::ecef_R_ned(there.latitude, there.longitude).transpose() * R);
      d.latitude[i] = there.latitude, d.longitude[i] = there.longitude, d.height[i] = there.height;
      d.roll[i] = a.roll, d.pitch[i] = a.pitch, d.heading[i] = core::wrap_two_pi(a.heading);
    }
    return d;
  }
  PlaneFactors factors(double surface = 0.003) const {
    return PlaneFactors(ties, world.scanner, world.noise, times, unknown, RobustOptions(), surface, 1e-10, 2);
  }
};

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
