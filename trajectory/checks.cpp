// SPDX-License-Identifier: GPL-3.0-or-later
// No published source: the tests a surveyor makes when a trajectory comes in. The track is differenced from positions over a second, so
// that it does not depend on recorded velocities; in a turn the difference lags, so turns are left out.
#include "trajectory/checks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/geo/frames.h"
#include "core/statistics.h"
#include "trajectory/ground_velocity.h"

namespace swath::trajectory {

namespace {

constexpr double track_base = 1.0;                    // s over which the track is differenced
constexpr double crab_limit = 20.0 * core::degree;    // wind of 22 m/s across at 60 m/s
constexpr double spread_limit = 5.0 * core::degree;   // gusts move the crab angle by 1-2 deg
constexpr double turned_limit = 40.0 * core::degree;  // over all courses: crab of 20 deg to either side makes 30
constexpr size_t courses = 12;                        // of 30 deg
constexpr double tilt_limit = 80.0 * core::degree;    // no survey aircraft flies so
constexpr double tiny_angle = 0.1 * core::degree;     // the tilt of every aircraft exceeds it somewhere
constexpr double velocity_limit = 1.0;                // m/s between recorded and differenced velocity

// Median of angles about their mean direction.
double median_angle(const std::vector<double>& angles, double& spread) {
  double s = 0.0, c = 0.0;
  for (double a : angles) s += std::sin(a), c += std::cos(a);
  const double mean = std::atan2(s, c);
  std::vector<double> about(angles.size());
  std::transform(angles.begin(), angles.end(), about.begin(), [&](double a) { return core::wrap_pi(a - mean); });
  const double m = core::median(about, 0.0);
  for (double& a : about) a = std::abs(a);
  spread = core::mad_to_sigma * core::median(about, 0.0);
  return core::wrap_pi(mean + m);
}

// Scatter about the median of each course: wind turns the nose to one side on a line and to the other on the line back.
double spread_by_course(const std::vector<double>& angles, const std::vector<double>& course) {
  std::array<std::vector<double>, courses> of;
  for (size_t i = 0; i < angles.size(); ++i) {
    const auto at = static_cast<size_t>(core::wrap_two_pi(course[i]) / (2.0 * core::pi) * static_cast<double>(courses));
    of[std::min(at, courses - 1)].push_back(angles[i]);
  }
  std::vector<double> about;
  for (const std::vector<double>& some : of) {
    if (some.empty()) continue;
    double ignored = 0.0;
    const double middle = median_angle(some, ignored);
    for (const double a : some) about.push_back(std::abs(core::wrap_pi(a - middle)));
  }
  return core::mad_to_sigma * core::median(std::move(about), 0.0);
}

bool finite(const core::TrajectoryData& d, size_t i) {
  const double sum = d.time[i] + d.latitude[i] + d.longitude[i] + d.height[i] + d.roll[i] + d.pitch[i] + d.heading[i];
  return std::isfinite(sum);
}

void check_times(const core::TrajectoryData& d, const CheckOptions& o, TrajectoryChecks& out) {
  std::vector<double> steps;
  for (size_t i = 1; i < d.size(); ++i) {
    const double step = d.time[i] - d.time[i - 1];
    if (step > 0.0) steps.push_back(step);
    if (step == 0.0) ++out.duplicates;
    if (step < 0.0) ++out.backwards;
    if (step > o.max_gap.value + time_rounding) out.gaps.push_back({i - 1, d.time[i - 1], step});
  }
  if (const double step = core::median(std::move(steps), 0.0); step > 0.0) out.rate = 1.0 / step;
}

void check_track(const core::TrajectoryData& d, const CheckOptions& o, TrajectoryChecks& out) {
  std::vector<double> crab, course, speed, difference;
  size_t j = 0, k = 0;
  for (size_t i = 0; i < d.size(); ++i) {
    // Records half a base before and after i; the time may stand still or jump in data that Trajectory would refuse.
    while (j < i && d.time[i] - d.time[j] > 0.5 * track_base) ++j;
    k = std::max(k, i);
    while (k + 1 < d.size() && d.time[k] - d.time[i] < 0.5 * track_base) ++k;
    const double before = d.time[i] - d.time[j], after = d.time[k] - d.time[i];
    if (!finite(d, i) || !finite(d, j) || !finite(d, k) || before <= 0.0 || after <= 0.0 || before + after > 2.0 * track_base) continue;
    const GroundVelocity v = ground_velocity(d, j, k);
    const double v_ground = std::hypot(v.north, v.east);
    speed.push_back(v_ground);
    if (d.has_velocity()) difference.push_back(std::hypot(d.v_north[i] - v.north, d.v_east[i] - v.east));
    if (v_ground < o.min_speed.value || std::abs(d.roll[i]) > o.level_roll.value) continue;
    const GroundVelocity v1 = ground_velocity(d, j, i), v2 = ground_velocity(d, i, k);
    const double turn = core::wrap_pi(std::atan2(v2.east, v2.north) - std::atan2(v1.east, v1.north)) / (0.5 * (before + after));
    if (std::abs(turn) > o.straight_rate.value) continue;
    course.push_back(std::atan2(v.east, v.north));
    crab.push_back(core::wrap_pi(d.heading[i] - course.back()));
  }
  out.straight = crab.size();
  out.speed_median = core::median(std::move(speed));
  out.velocity_difference = core::median(std::move(difference), 0.0);
  if (crab.empty()) return;
  out.crab_median = median_angle(crab, out.crab_range);
  out.crab_spread = spread_by_course(crab, course);
}

void check_angles(const core::TrajectoryData& d, TrajectoryChecks& out) {
  double tilt = 0.0, turn = 0.0;
  for (size_t i = 0; i < d.size(); ++i) {
    if (!finite(d, i)) {
      ++out.not_finite;
      continue;
    }
    tilt = std::max({tilt, std::abs(d.roll[i]), std::abs(d.pitch[i])});
    turn = std::max(turn, std::abs(d.heading[i]));
  }
  if (tilt > tilt_limit || turn > 3.0 * core::pi)
    out.warnings.push_back("roll or pitch reaches " + core::format_number(tilt, 3) + " rad, heading " + core::format_number(turn, 3) +
                           " rad: degrees read as radians?");
  else if (turn < 2.0 * core::pi * core::degree && out.straight > 0 && tilt < tiny_angle)
    out.warnings.push_back("headings are all below 0.11 rad, roll and pitch below 0.1 deg: radians read as degrees?");
}

}  // namespace

TrajectoryChecks check_trajectory(const core::TrajectoryData& d, const CheckOptions& o) {
  TrajectoryChecks out;
  out.records = d.size();
  if (d.size() == 0) return out;
  check_times(d, o, out);
  check_track(d, o, out);
  check_angles(d, out);
  out.motion = check_motion(d, o.min_speed);

  const auto degrees = [](double a) { return core::format_number(std::round(core::to_degrees(a) * 100.0) / 100.0) + " deg"; };
  if (out.duplicates)
    out.warnings.push_back(core::counted(out.duplicates, "record repeats the time before it", "records repeat the time before them"));
  if (out.backwards) out.warnings.push_back(core::counted(out.backwards, "record goes", "records go") + " back in time");
  if (out.not_finite)
    out.warnings.push_back(core::counted(out.not_finite, "record holds", "records hold") + " a value that is not a number");
  if (!out.gaps.empty())
    out.warnings.push_back(core::counted(out.gaps.size(), "gap") + ", the first after record " + std::to_string(out.gaps[0].record));
  if (out.straight > 0 && std::abs(out.crab_median) > crab_limit)
    out.turned.push_back("heading differs from the track by " + degrees(out.crab_median) +
                         " in straight flight: wander angle not removed (or removed twice), IMU axes turned, or another north?");
  if (out.straight > 0 && out.crab_spread > spread_limit)
    out.turned.push_back("heading scatters about the track by " + degrees(out.crab_spread) + " in straight flight");
  else if (out.straight > 0 && out.crab_range > turned_limit)
    out.turned.push_back("heading differs from the track by another angle on each course (spread " + degrees(out.crab_range) +
                         "): sign of heading, or another unit?");
  if (out.velocity_difference > velocity_limit)
    out.warnings.push_back("recorded velocity differs from that of the positions by " + core::format_number(out.velocity_difference, 3) +
                           " m/s (median): wander frame, or other axes?");
  out.turned.insert(out.turned.end(), out.motion.warnings.begin(), out.motion.warnings.end());
  out.warnings.insert(out.warnings.end(), out.turned.begin(), out.turned.end());
  return out;
}

}  // namespace swath::trajectory
