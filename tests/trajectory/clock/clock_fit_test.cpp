// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/clock/clock_fit.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/trajectory/ins_run.h"
#include "tests/world/navigation.h"

namespace swath::trajectory {
namespace {

constexpr double step = 0.2, half_span = 2.0;  // s, of fixes; of second differences
const ClockGrid grid{0.0, 15};

const test::Course& slow_craft() {
  static const test::Course course(test::motion_of(test::craft_flight(8.0, 3)), 0, 100);
  return course;
}

std::vector<ClockWindow> windows_of(const core::ImuData& imu, const core::GnssData& gnss, const ClockGrid& at = grid) {
  return clock_windows(make_path(imu, 10), gnss, slow_craft().sensors.lever, step, half_span, at);
}

TEST(ClockFit, TakesOutWhatBiasesAndScaleFactorsDoInTurns) {
  // 10 mg and 0.1 deg/s, one axis at a time, and 0.5 %: a bias taken as it is at the middle fix moves the offset by centiseconds.
  core::ImuErrorModel spec = core::error_model_of(core::ImuGrade::mems);
  for (int error = 0; error < clock_sensor_errors; ++error) {
    core::ImuData imu = slow_craft().exact.imu;
    for (size_t k = 0; k < imu.size(); ++k) {
      const int axis = error % 3;
      if (error < 3) imu.angle[k][axis] += imu.step[k] * 0.1 * core::degree;
      if (error >= 3 && error < 6) imu.velocity[k][axis] += imu.step[k] * 0.1;
      if (error >= 6 && error < 9) imu.angle[k][axis] *= 1.002;
      if (error >= 9) imu.velocity[k][axis] *= 1.002;
    }
    const ClockFit fit = fit_clock(windows_of(imu, slow_craft().exact.gnss), grid, spec, 0.0, step);
    ASSERT_TRUE(fit.motion_changes);
    EXPECT_NEAR(fit.shift, 0.0, 1e-3) << "sensor error " << error;
    // Taken out of the records, less of it is left: turns show some errors weakly.
    const double truth = std::array{0.1 * core::degree, 0.1, 0.002, 0.002}[static_cast<size_t>(error / 3)];
    const ClockFit again = fit_clock(
        clock_windows(make_path(imu, 10), slow_craft().exact.gnss, slow_craft().sensors.lever, step, half_span, grid, fit.sensors), grid,
        spec, 0.0, step);
    const double found = fit.sensors[error], both = found + again.sensors[error];
    EXPECT_GT(found, 0.2 * truth) << "sensor error " << error;
    EXPECT_LT(std::abs(both - truth), std::abs(found - truth) + 0.1 * truth) << "sensor error " << error;
  }
}

TEST(ClockFit, FindsAShiftFromTheGridsMiddle) {
  core::ImuData imu = slow_craft().exact.imu;
  for (double& t : imu.time) t += 0.53;
  const ClockGrid about{0.5, 15};
  const ClockFit fit =
      fit_clock(windows_of(imu, slow_craft().exact.gnss, about), about, core::error_model_of(core::ImuGrade::mems), 0.0, step);
  EXPECT_NEAR(fit.shift, 0.03, 1e-3);
  EXPECT_LT(fit.sigma, 2e-3);
}

TEST(ClockFit, SigmaGrowsWithNoiseWanderAndArm) {
  const core::GnssData noisy = test::with_errors(slow_craft().exact.gnss, {}, 5);
  core::ImuErrorModel steady = core::error_model_of(core::ImuGrade::mems), wandering = steady;
  steady.angular_random_walk.value = 0.0;
  wandering.angular_random_walk.value *= 20;
  const std::vector<ClockWindow> exact = windows_of(slow_craft().exact.imu, slow_craft().exact.gnss);
  const std::vector<ClockWindow> windows = windows_of(slow_craft().exact.imu, noisy);
  const double sigma = fit_clock(windows, grid, steady, 0.0, step).sigma;
  EXPECT_GT(sigma, 2 * fit_clock(exact, grid, steady, 0.0, step).sigma);
  EXPECT_GT(fit_clock(windows, grid, wandering, 0.0, step).sigma, 2 * sigma);
  // An arm that is off by 8 cm at some 8 m/s is 10 ms.
  EXPECT_NEAR(fit_clock(windows, grid, steady, 0.08, step).sigma, std::hypot(sigma, 0.010), 0.0015);
}

TEST(ClockFit, NothingMoves) { EXPECT_FALSE(fit_clock({}, grid, core::error_model_of(core::ImuGrade::mems), 0.0, step).motion_changes); }

}  // namespace
}  // namespace swath::trajectory
