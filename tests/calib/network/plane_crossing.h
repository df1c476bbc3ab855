// SPDX-License-Identifier: GPL-3.0-or-later
// Two crossing lines over planes known exactly, for the planes' part of a flight's adjustment.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "calib/network/plane_factors.h"
#include "tests/calib/tie_block.h"

namespace swath::calib::test {

/// With a trajectory that is off by a known error of the states, linear between instants.
struct Crossing {
  World world;
  TieSet ties;
  std::vector<double> times;
  trajectory::Layout layout;
  std::vector<Parameter> unknown{boresight_roll, boresight_pitch, boresight_heading, lever_down, range_offset, scan_scale};
  Eigen::VectorXd error;  // true less estimated: states, then calibration
  std::unique_ptr<FlightStates> states;
  std::unique_ptr<trajectory::Trajectory> off;
  core::Calibration calibration;

  /// `side`: squared, number of planes on the ground.
  explicit Crossing(double size = 1.0, Dice* noise = nullptr, int side = 3)
      : world(make_world({{0.3, 0.0}, {0.3 + 90.0 * deg, 50.0}}, block_planes(side, 4, 9))) {
    world.returns = noise ? 60 : 12;
    ties = ties_of(world, noise);
    for (size_t l = 0; l < world.lines.size(); ++l)
      for (double s = -world.margin; s < world.lines[l].duration() + world.margin + 0.1; s += 0.5) times.push_back(world.first(l) + s);
    states = std::make_unique<FlightStates>(layout, times.size(), static_cast<int>(unknown.size()));
    error = Eigen::VectorXd::Zero(states->first(states->common()) + static_cast<Eigen::Index>(unknown.size()));
    for (int k = 0; k < states->instants(); ++k) {
      // Slow, so that the cubic through the trajectory's records does not round the corners at the instants.
      const double s = 0.4 * (times[static_cast<size_t>(k)] - world.start);
      const auto first = states->first(states->pose(k));
      error.segment<3>(first) = 0.05 * size * Eigen::Vector3d(std::sin(s), std::cos(s), std::sin(s + 2));
      error.segment<3>(first + 3) = 2e-4 * size * Eigen::Vector3d(std::cos(s + 1), std::sin(s + 3), std::cos(s));
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
      const auto first = states->first(states->pose(static_cast<int>(k))), second = states->first(states->pose(static_cast<int>(k) + 1));
      const Eigen::Vector3d shift = (1 - s) * error.segment<3>(first) + s * error.segment<3>(second);
      const Eigen::Vector3d turn = (1 - s) * error.segment<3>(first + 3) + s * error.segment<3>(second + 3);
      const core::Geodetic g{d.latitude[i], d.longitude[i], d.height[i]};
      const Eigen::Matrix3d R =
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

}  // namespace swath::calib::test
