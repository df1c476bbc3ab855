// SPDX-License-Identifier: GPL-3.0-or-later
// A short flight or drive with its records, made ready for the filter.
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "core/geo/frames.h"
#include "tests/world/navigation.h"
#include "trajectory/ins/ins_filter.h"

namespace swath::trajectory::test {

using namespace swath::test;

inline NavState nav_at(const MotionAt& motion, double t) {
  const Truth truth = truth_at(motion, t);
  return {motion_start + t, truth.position, truth.velocity, truth.ecef_R_body};
}

/// What a Problem refers to, kept together. A node at each end, at each fix and every `spacing` seconds between fixes.
struct InsProblem {
  struct Setup {
    Sensors sensors{.from = 0, .until = 20, .imu_step = 0.01};
    core::ImuErrorModel imu = core::error_model_of(core::ImuGrade::tactical);
    FixErrors fixes;
    Layout layout{true, true, true, true, false};
    InsGnssOptions options;
    std::uint64_t seed = 1;
    double spacing = 0.25;  // s
    double still_until = -1.0;
    std::function<core::ImuData(core::ImuData)> change_imu;
    std::function<core::GnssData(core::GnssData)> change_gnss;
  };

  MotionAt motion;
  Setup setup;
  ImuPath path;
  core::GnssData gnss;
  std::vector<Node> nodes;
  std::unique_ptr<Problem> problem;

  InsProblem(MotionAt m, const Setup& s) : motion(std::move(m)), setup(s) {
    const Records exact = exact_records(motion, s.sensors);
    core::ImuData imu = with_errors(exact.imu, s.imu, s.seed);
    if (s.change_imu) imu = s.change_imu(std::move(imu));
    path = make_path(std::move(imu), s.options.max_gap.value);
    gnss = with_errors(exact.gnss, s.fixes, s.seed);
    if (s.change_gnss) gnss = s.change_gnss(std::move(gnss));
    const auto add = [this](double t, std::int32_t fix) {
      constexpr double same = 1e-5;
      if (nodes.empty()) {
        nodes.push_back({t, fix, false});
        return;
      }
      const double from = nodes.back().time, n = std::ceil((t - from) / setup.spacing - 1e-6);
      if (t - from < same) {
        if (fix >= 0) nodes.back().fix = fix;
        return;
      }
      for (double i = 1; i < n; ++i) nodes.push_back({from + (t - from) * i / n, -1, false});
      nodes.push_back({t, fix, false});
    };
    add(path.begin(), -1);
    for (size_t k = 0; k < gnss.size(); ++k) add(gnss.time[k], static_cast<std::int32_t>(k));
    add(path.end(), -1);
    for (Node& n : nodes) n.still = n.time < motion_start + s.still_until;
    problem = std::make_unique<Problem>(
        Problem{path, gnss, nodes, s.layout, ProcessNoise::of(s.imu, s.options.correlation_time.value), s.options});
  }
  InsProblem(const InsProblem&) = delete;
  InsProblem& operator=(const InsProblem&) = delete;

  static constexpr double position_sigma = 0.5, velocity_sigma = 0.2, attitude_sigma = 0.3 * core::degree, lever_sigma = 0.02;

  StateMatrix covariance() const {
    const Layout& l = setup.layout;
    StateMatrix P = StateMatrix::Zero(l.size, l.size);
    const auto put = [&P](int row, int rows, double sigma) {
      if (row >= 0) P.diagonal().segment(row, rows).setConstant(sigma * sigma);
    };
    const core::ImuErrorModel& m = setup.imu;
    put(l.position, 3, position_sigma), put(l.velocity, 3, velocity_sigma), put(l.attitude, 3, attitude_sigma);
    put(l.gyro_bias, 3, std::hypot(m.gyro_bias.value, m.gyro_drift.value));
    put(l.force_bias, 3, std::hypot(m.accelerometer_bias.value, m.accelerometer_drift.value));
    put(l.gyro_scale, 3, m.gyro_scale.value), put(l.force_scale, 3, m.accelerometer_scale.value), put(l.lever, 3, lever_sigma);
    put(l.fix, 3, 1.0), put(l.latency, 1, setup.options.latency_sigma.value), put(l.track, 2, 5 * core::degree);
    return P;
  }
  /// The true state at a node with errors drawn from the first nine of covariance().
  Estimate start(size_t node = 0) const {
    Dice dice(setup.seed + 77);
    Estimate e;
    e.nav = nav_at(motion, nodes[node].time - motion_start);
    e.nav.time = nodes[node].time;
    e.lever = setup.sensors.lever;
    StateVector off = StateVector::Zero(setup.layout.size);
    off.segment<3>(Layout::position) = position_sigma * dice.vector();
    off.segment<3>(Layout::velocity) = velocity_sigma * dice.vector();
    off.segment<3>(Layout::attitude) = attitude_sigma * dice.vector();
    e.correct(setup.layout, off);
    return e;
  }
  InsFilter filter(const std::vector<Estimate>* reference = nullptr) const {
    const StateVector none = StateVector::Zero(setup.layout.size);
    if (!reference) return {*problem, start(), none, covariance(), nullptr};
    return {*problem, reference->front(), start().minus(reference->front(), setup.layout), covariance(), reference};
  }
  /// Estimate less truth: position and velocity (ecef), rotation; in the filter's own axes.
  Eigen::Matrix<double, 9, 1> error_of(const Estimate& e) const {
    Estimate truth;
    truth.nav = nav_at(motion, e.nav.time - motion_start);
    return e.minus(truth, Layout()).head<9>();
  }
};

}  // namespace swath::trajectory::test
