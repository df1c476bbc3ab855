// SPDX-License-Identifier: GPL-3.0-or-later
// No published source: v_ground = airspeed * (cos, sin)(heading - bias) + wind, linear but for the bias, which is sought; a coordinated
// turn banks by atan(speed * rate of turn / gravity). Deviation: wind and airspeed are constant and there is no sideslip, which makes
// errors of one to three degrees (a helicopter more).
#include "trajectory/flight_checks.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/config/units.h"
#include "core/geo/frames.h"
#include "trajectory/ground_velocity.h"

namespace swath::trajectory {
namespace {

constexpr double step = 1.0;            // s between samples
constexpr double longest_sample = 2.0;  // s that a sample may span
constexpr double slowest = 10.0;        // m/s
constexpr size_t most_samples = 4000;
constexpr size_t fewest_samples = 20;
constexpr double gravity = 9.81;                // m/s^2
constexpr double turning = 1.5 * core::degree;  // rad/s
constexpr double least_spread = 0.15;           // of the directions: 1 - length of their mean; a single direction has 0
constexpr double independent = 15.0;            // s after which gusts are new

struct Sample {
  double north = 0.0, east = 0.0;  // m/s
  double turn = 0.0;               // rad/s
  double heading = 0.0, roll = 0.0, pitch = 0.0;
  double rise = 0.0, recorded_rise = 0.0;  // m
};

std::vector<size_t> nodes_of(const core::TrajectoryData& d) {
  std::vector<size_t> out;
  if (d.size() == 0) return out;
  double covered = 0.0;
  for (size_t i = 1; i < d.size(); ++i)
    if (const double dt = d.time[i] - d.time[i - 1]; dt <= longest_sample) covered += dt;
  const double every = std::max(step, covered / most_samples);
  // Spans of one step, `every` apart; a gap is passed over.
  size_t at = 0;
  for (double t = d.time.front(); t + step <= d.time.back(); t = std::max(t + every, d.time[at] + 0.5 * every)) {
    at = static_cast<size_t>(std::lower_bound(d.time.begin() + static_cast<std::ptrdiff_t>(at), d.time.end(), t) - d.time.begin());
    if (out.empty() || out.back() != at) out.push_back(at);
  }
  return out;
}

size_t record_at(const core::TrajectoryData& d, size_t from, double t) {
  return static_cast<size_t>(std::lower_bound(d.time.begin() + static_cast<std::ptrdiff_t>(from), d.time.end(), t) - d.time.begin());
}

std::vector<Sample> samples_of(const core::TrajectoryData& d) {
  std::vector<Sample> out;
  for (const size_t a : nodes_of(d)) {
    const size_t m = record_at(d, a, d.time[a] + 0.5 * step), b = record_at(d, m, d.time[a] + step);
    if (b >= d.size() || m == a || b == m || d.time[b] - d.time[a] > longest_sample) continue;
    const GroundVelocity v = ground_velocity(d, a, b), v1 = ground_velocity(d, a, m), v2 = ground_velocity(d, m, b);
    Sample s;
    s.north = v.north, s.east = v.east;
    s.turn = core::wrap_pi(std::atan2(v2.east, v2.north) - std::atan2(v1.east, v1.north)) / (0.5 * (d.time[b] - d.time[a]));
    s.heading = d.heading[m], s.roll = d.roll[m], s.pitch = d.pitch[m];
    s.rise = d.height[b] - d.height[a];
    if (d.has_velocity())
      for (size_t i = a; i < b; ++i) s.recorded_rise -= 0.5 * (d.v_down[i] + d.v_down[i + 1]) * (d.time[i + 1] - d.time[i]);
    if (std::hypot(v.north, v.east) > slowest && std::isfinite(s.heading + s.roll + s.pitch + s.rise)) out.push_back(s);
  }
  return out;
}

/// Airspeed and wind for one bias; the sum of squares that is left.
double wind_fit(const std::vector<Sample>& all, double bias, Eigen::Vector3d& x) {
  Eigen::Matrix3d N = Eigen::Matrix3d::Zero();
  Eigen::Vector3d r = Eigen::Vector3d::Zero();
  double squares = 0;
  for (const Sample& s : all) {
    const double c = std::cos(s.heading - bias), e = std::sin(s.heading - bias);
    const Eigen::Vector3d rows[2] = {{c, 1, 0}, {e, 0, 1}};
    const double seen[2] = {s.north, s.east};
    for (int k = 0; k < 2; ++k) N += rows[k] * rows[k].transpose(), r += rows[k] * seen[k], squares += seen[k] * seen[k];
  }
  x = N.ldlt().solve(r);
  return std::max(0.0, squares - x.dot(r));
}

std::optional<HeadingFit> heading_of(const std::vector<Sample>& all) {
  if (all.size() < fewest_samples) return std::nullopt;
  // A heading that stays while the track turns is that of a craft that flies sideways: neither wind nor bias follows from it.
  Eigen::Vector2d track = Eigen::Vector2d::Zero(), heading = Eigen::Vector2d::Zero();
  for (const Sample& s : all) {
    track += Eigen::Vector2d(s.north, s.east).normalized();
    heading += Eigen::Vector2d(std::cos(s.heading), std::sin(s.heading));
  }
  for (const Eigen::Vector2d& mean : {track, heading})
    if (1 - (mean / static_cast<double>(all.size())).norm() < least_spread) return std::nullopt;
  Eigen::Vector3d x;
  double best = 0, least = 1e300;
  const auto look = [&](double bias) {
    const double left = wind_fit(all, bias, x);
    if (x[0] > 0 && left < least) least = left, best = bias;  // backwards through the air is the other bias
  };
  for (int k = -36; k < 36; ++k) look(k * 5.0 * core::degree);
  for (double width = 2.5 * core::degree; width > 0.01 * core::degree; width *= 0.5) {
    const double middle = best;
    look(middle - width), look(middle + width);
  }
  HeadingFit out;
  const double least_at = wind_fit(all, best, x);
  out.bias = core::wrap_pi(best);
  out.airspeed = x[0];
  out.wind = x.tail<2>().norm();
  const auto n = static_cast<double>(all.size());
  const double variance = least_at / (2 * n);
  out.misfit = std::sqrt(variance) / std::max(1.0, out.airspeed);
  constexpr double h = 1.0 * core::degree;
  Eigen::Vector3d y;
  const double curve = (wind_fit(all, best + h, y) + wind_fit(all, best - h, y) - 2 * least_at) / (h * h);
  out.sigma = curve > 0 ? std::sqrt(2 * variance / curve * independent / step) : core::pi;
  return out;
}

/// y = factor * x.
std::optional<FactorFit> factor_of(const std::vector<std::pair<double, double>>& xy, double smallest) {
  if (xy.size() < fewest_samples) return std::nullopt;
  double xx = 0, product = 0, yy = 0;
  for (const auto& [x, y] : xy) xx += x * x, product += x * y, yy += y * y;
  const auto n = static_cast<double>(xy.size());
  if (std::sqrt(xx / n) < smallest) return std::nullopt;
  FactorFit out;
  out.factor = product / xx;
  out.correlation = yy > 0 ? product / std::sqrt(xx * yy) : 0.0;
  out.samples = xy.size();
  double left = 0;
  for (const auto& [x, y] : xy) left += std::pow(y - out.factor * x, 2);
  out.sigma = std::sqrt(left / (n - 1) / xx);
  return out;
}

}  // namespace

FlightChecks check_flight(const core::TrajectoryData& d) {
  const std::vector<Sample> all = samples_of(d);
  FlightChecks out;
  out.heading = heading_of(all);
  std::vector<std::pair<double, double>> roll, pitch, climb;
  for (const Sample& s : all) {
    if (std::abs(s.turn) > turning) {
      const double bank = std::atan(std::hypot(s.north, s.east) * s.turn / gravity);
      roll.emplace_back(bank, s.roll);
      pitch.emplace_back(bank, s.pitch);
    }
    if (d.has_velocity()) climb.emplace_back(s.recorded_rise, s.rise);
  }
  out.roll_turns = factor_of(roll, 3.0 * core::degree);
  out.pitch_turns = factor_of(pitch, 3.0 * core::degree);
  out.climb = factor_of(climb, 0.1);
  return out;
}

}  // namespace swath::trajectory
