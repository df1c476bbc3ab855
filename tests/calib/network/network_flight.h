// SPDX-License-Identifier: GPL-3.0-or-later
// A short flight smoothed, from where a network goes on.
#pragma once

#include <vector>

#include "calib/network/navigation_factors.h"
#include "tests/trajectory/ins_problem.h"
#include "trajectory/ins/ins_smoother.h"

namespace swath::calib::test {

struct NetworkFlight {
  trajectory::test::InsProblem flight;
  trajectory::SmootherRun run;                  ///< linearised about `reference`
  std::vector<trajectory::Estimate> reference;  ///< constants alike at all instants

  explicit NetworkFlight(double seconds, bool velocity = false, core::ImuGrade grade = core::ImuGrade::tactical,
                         trajectory::Layout layout = {true, true, true, true, false})
      : flight(trajectory::test::motion_of(swath::test::survey_flight(2)), setup_of(seconds, velocity, grade, layout)) {
    run = run_smoother(*flight.problem, flight.filter());
    for (int i = 0; i < 3; ++i) {
      refer();
      run = run_smoother(*flight.problem, flight.filter(&reference));
    }
  }
  const trajectory::Layout& layout() const { return flight.setup.layout; }
  NavigationPrior prior() const {
    const trajectory::Estimate stated = flight.start();
    return {flight.covariance(), [stated, l = layout()](const trajectory::Estimate& about) { return stated.minus(about, l); }};
  }

 private:
  static trajectory::test::InsProblem::Setup setup_of(double seconds, bool velocity, core::ImuGrade grade, trajectory::Layout layout) {
    trajectory::test::InsProblem::Setup s;
    s.layout = layout;
    s.sensors.until = seconds;
    s.imu = core::error_model_of(grade);
    s.fixes.velocity = velocity;
    s.options.use_velocity = velocity;
    return s;
  }
  void refer() {
    reference.clear();
    for (const trajectory::SmoothedNode& n : run.nodes) {
      trajectory::Estimate e = n.estimate;
      const trajectory::Estimate& first = run.nodes.front().estimate;
      e.gyro_scale = first.gyro_scale, e.force_scale = first.force_scale, e.lever = first.lever, e.latency = first.latency;
      reference.push_back(e);
    }
  }
};

}  // namespace swath::calib::test
