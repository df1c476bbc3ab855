// SPDX-License-Identifier: GPL-3.0-or-later
// Exact motions of a carrier, the records that an IMU and a GNSS receiver would make of them, and errors drawn by a seed.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <random>
#include <utility>
#include <vector>

#include "core/records/gnss_data.h"
#include "core/records/imu_data.h"
#include "core/records/imu_spec.h"
#include "core/records/trajectory_data.h"
#include "simulate/planned_flight.h"

namespace swath::test {

constexpr double motion_start = 2317 * 604800.0 + 208800.0;  ///< GPS time of second 0 of every motion here: doubles resolve 2.4e-7 s

/// A motion with its exact derivatives, by seconds since its start.
using MotionAt = std::function<simulate::Motion(double)>;

/// Lines of 1 km flown to and fro at 50 m/s in turbulence, turns of 22 deg of bank between them: some 180 s from one line to the next.
simulate::PlannedFlight survey_flight(int lines, int cross_lines = 0);
/// One line with 5 s before and after it.
simulate::PlannedFlight straight_flight(double length);
/// Three lines of 20 s at `speed` (m/s) and 22 deg of bank between them: a slow craft turns by a radian in 2 s. `seed`: of its turbulence.
simulate::PlannedFlight craft_flight(double speed, std::int64_t seed);
MotionAt motion_of(simulate::PlannedFlight flight);

/// A car on a level figure of eight, 300 m long, that does not slip: its velocity lies along the vehicle's forward axis.
class Drive {
 public:
  /// From `time` on the car passes smoothly, within 6 s, to `speed`: 1 is about 15 m/s, 0 a stop.
  struct Change {
    double time, speed;
  };
  /// `azimuth`, `elevation`: the vehicle's forward axis in body, rad.
  explicit Drive(std::vector<Change> changes, double azimuth = 0.0, double elevation = 0.0);
  simulate::Motion operator()(double t) const;

 private:
  std::vector<Change> changes_;
  double azimuth_, elevation_;
};

/// Normally distributed numbers that are the same on every machine.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}
  double uniform() { return (static_cast<double>(random_() >> 11) + 0.5) * 0x1p-53; }
  double normal();
  Eigen::Vector3d vector() {
    const double x = normal(), y = normal();
    return {x, y, normal()};
  }

 private:
  std::mt19937_64 random_;
};

/// What the sensors see of a motion from second `from` to `until`.
struct Sensors {
  double from = 0.0, until = 0.0;
  double imu_step = 0.005, fix_step = 0.2;       ///< s
  Eigen::Vector3d lever{-0.412, 0.127, -1.236};  ///< IMU centre to antenna, body, m
};

struct Records {
  core::ImuData imu;
  core::GnssData gnss;  ///< with velocities
};

/// Records without errors; the fixes' covariances are zero.
Records exact_records(const MotionAt& motion, const Sensors& sensors);

/// Biases, scale factors and drifts drawn with the model's sigmas, white noise; the same for the same seed.
core::ImuData with_errors(const core::ImuData& exact, const core::ImuErrorModel& model, std::uint64_t seed);

struct FixErrors {
  double horizontal = 0.025, vertical = 0.045;  ///< m, sigma of each component
  double share = 0.4, time = 120.0;             ///< of the variance, correlated over this many s
  double speed = 0.03;                          ///< m/s, sigma of each component of the velocity
  double outliers = 0.0, outlier = 1.0;         ///< share of the fixes that are off by so many m, each in its own direction
  bool velocity = false;                        ///< keep the velocities
};
core::GnssData with_errors(const core::GnssData& exact, const FixErrors& errors, std::uint64_t seed);

/// Without the fixes between two instants, seconds of the motion.
core::GnssData without(const core::GnssData& gnss, double from, double until);
core::GnssData keep_fixes(const core::GnssData& gnss, const std::function<bool(size_t)>& wanted);

/// North, east, down (m), roll, pitch, heading (rad) of a trajectory's record less the truth.
using Error6 = Eigen::Matrix<double, 6, 1>;
Error6 error_of(const core::TrajectoryData& trajectory, size_t k, const MotionAt& truth);
Error6 sigma_of(const core::TrajectoryData& trajectory, size_t k);

/// Position (ecef, m), velocity (ecef axes, m/s) and attitude of a motion.
struct Truth {
  Eigen::Vector3d position, velocity;
  Eigen::Matrix3d ecef_R_body;
};
Truth truth_at(const MotionAt& motion, double seconds);

}  // namespace swath::test
