// SPDX-License-Identifier: GPL-3.0-or-later
// Seconds and peak memory of the INS/GNSS smoother: ins_bench [HOURS] (1). IMU at 200 Hz, tactical grade, GNSS at 5 Hz, made in memory from
// lines of 3 km and the turns between them. One thread.
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <random>
#include <utility>

#include "core/error.h"
#include "simulate/inertial.h"
#include "simulate/planned_flight.h"
#include "trajectory/ins/ins_gnss.h"

namespace {

using namespace swath;
using Clock = std::chrono::steady_clock;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double start = 1.4e9;                         // GPS time, s
constexpr double imu_step = 0.005, gnss_step = 0.2;     // s
constexpr double limit_seconds = 20.0, limit_gb = 1.0;  // for an hour, on one core
constexpr double horizontal = 0.025, vertical = 0.045;  // m, of the fixes; 40 % of the variance correlated over 120 s
const Vector3d lever(-0.412, 0.127, -1.236);

struct Random {
  std::mt19937_64 engine{1};
  std::normal_distribution<double> normal;
  Vector3d vector() {
    const double x = normal(engine), y = normal(engine);
    return {x, y, normal(engine)};
  }
};

core::ImuData imu_of(const simulate::Flight& flight, double seconds, const core::ImuErrorModel& m, Random& random) {
  core::ImuData out;
  const Vector3d one = Vector3d::Ones();
  const Vector3d gyro_bias = m.gyro_bias.value * random.vector(), force_bias = m.accelerometer_bias.value * random.vector();
  const Vector3d gyro_scale = m.gyro_scale.value * random.vector(), force_scale = m.accelerometer_scale.value * random.vector();
  const double dt = imu_step, root = std::sqrt(dt);
  const auto records = static_cast<size_t>(seconds / dt);
  for (size_t k = 1; k <= records; ++k) {
    const double t = static_cast<double>(k) * dt;
    const simulate::Increments i = simulate::increments_of(flight, t, dt);
    out.time.push_back(start + t);
    out.step.push_back(dt);
    out.angle.push_back(i.angle.cwiseProduct(one + gyro_scale) + dt * gyro_bias + m.angular_random_walk.value * root * random.vector());
    out.velocity.push_back(i.velocity.cwiseProduct(one + force_scale) + dt * force_bias +
                           m.velocity_random_walk.value * root * random.vector());
  }
  return out;
}

core::GnssData gnss_of(const simulate::Flight& flight, double seconds, Random& random) {
  core::GnssData out;
  const double kept = std::exp(-gnss_step / 120.0), fresh = std::sqrt(1 - kept * kept);
  const Vector3d sigma(horizontal, horizontal, vertical);
  Vector3d slow = random.vector();
  const auto fixes = static_cast<size_t>(seconds / gnss_step);
  for (size_t k = 0; k <= fixes; ++k) {
    const double t = static_cast<double>(k) * gnss_step;
    const simulate::Pose pose = flight.pose(t);
    const Matrix3d ned = core::ecef_R_ned(pose.position.latitude, pose.position.longitude);
    slow = kept * slow + fresh * random.vector();
    const Vector3d error = sigma.cwiseProduct(std::sqrt(0.4) * slow + std::sqrt(0.6) * random.vector());
    out.time.push_back(start + t);
    out.position.push_back(core::ecef_of(pose.position) + ned * (core::matrix_of(pose.attitude) * lever + error));
    out.covariance.push_back(ned * sigma.cwiseAbs2().asDiagonal() * ned.transpose());
    out.quality.push_back(core::FixQuality::fixed);
    out.satellites.push_back(12);
  }
  return out;
}

double peak_gb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1e6;  // kB
}

}  // namespace

int main(int argc, char** argv) try {
  const double hours = argc > 1 ? std::max(0.02, std::atof(argv[1])) : 1.0, seconds = 3600.0 * hours;
  simulate::FlightOptions options;
  options.line_length = core::Metres(3000);
  options.cross_lines = 0;
  options.lines = 2 + static_cast<int>(seconds / 120.0);
  const simulate::PlannedFlight flight(options, {48 * core::degree, 10.5 * core::degree, 600.0}, 950.0,
                                       simulate::plan_lines(options, {}, core::degrees(20).value, 0.02), 5.2, 1);
  if (flight.duration() < seconds) throw core::Error("the flight is too short");
  const core::ImuErrorModel model = core::error_model_of(core::ImuGrade::tactical);
  Random random;
  core::ImuData imu = imu_of(flight, seconds, model, random);
  core::GnssData gnss = gnss_of(flight, seconds, random);
  const double before = peak_gb();
  const size_t records = imu.size(), fixes = gnss.size();

  const auto a = Clock::now();
  const std::clock_t cpu = std::clock();
  const trajectory::InsGnssResult result = trajectory::smooth(std::move(imu), std::move(gnss), model, lever, 0.02);
  const double cpu_seconds = static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
  const double wall = std::chrono::duration<double>(Clock::now() - a).count();
  const double allowed = limit_seconds * hours, peak = peak_gb();
  const trajectory::SmootherSpan& span = result.report.figures.span;
  std::printf("%.2f h: %zu IMU records, %zu fixes, %lld nodes, %lld passes\n", hours, records, fixes, static_cast<long long>(span.nodes),
              static_cast<long long>(span.iterations));
  std::printf("cpu %.2f s, wall %.2f s of %.0f s allowed: %.2f and %.2f of it\n", cpu_seconds, wall, allowed, cpu_seconds / allowed,
              wall / allowed);
  std::printf("peak memory %.3f GB (%.3f GB before, of the records): %.2f of the %.0f GB for an hour\n", peak, before, peak / limit_gb,
              limit_gb);
  return result.trajectory.size() == records ? 0 : 1;
} catch (const core::Error& e) {
  std::fprintf(stderr, "%s\n", e.text().c_str());
  return 1;
}
