// SPDX-License-Identifier: GPL-3.0-or-later
// No published source. In a coordinated turn the bank is the arctangent of the acceleration across the track over gravity; sideslip and
// gusts scatter about that, a reversed sign of roll does not. Cars and boats lean little and outwards: no warning has a slope of theirs.
#include "trajectory/motion_checks.h"

#include <algorithm>
#include <cmath>

#include "core/geo/frames.h"
#include "trajectory/ground_velocity.h"

namespace swath::trajectory {
namespace {

constexpr double base = 1.0;               // s before and after a record over which velocities are differenced
constexpr double standard_gravity = 9.81;  // m/s2
constexpr double min_across = 1.0;         // m/s2: a bank of 6 deg, well above gusts
constexpr double min_turning = 5.0;        // s
constexpr double min_climb = 0.05;         // m over two bases, rms: below, noise decides
constexpr double min_correlation = 0.8, min_correlation_of_heights = 0.95;  // heights have less noise
constexpr double feet_per_metre = 1.0 / 0.3048;

/// Sums of a line through the origin.
struct Slope {
  double xx = 0.0, xy = 0.0, yy = 0.0;
  void add(double x, double y) { xx += x * x, xy += x * y, yy += y * y; }
  double value() const { return xx > 0.0 ? xy / xx : 0.0; }
  double correlation() const { return xx > 0.0 && yy > 0.0 ? xy / std::sqrt(xx * yy) : 0.0; }
};

/// Climb since the first record by the recorded vertical velocity, m.
std::vector<double> climbed(const core::TrajectoryData& d) {
  std::vector<double> out(d.has_velocity() ? d.size() : 0, 0.0);
  for (size_t i = 1; i < out.size(); ++i) {
    const double step = -0.5 * (d.v_down[i] + d.v_down[i - 1]) * (d.time[i] - d.time[i - 1]);
    out[i] = out[i - 1] + (std::isfinite(step) ? step : 0.0);
  }
  return out;
}

struct Sums {
  Slope roll, pitch, climb;
  size_t climbs = 0;
  double turning = 0.0;
};

Sums sums_of(const core::TrajectoryData& d, double min_speed) {
  Sums out;
  const std::vector<double> climb = climbed(d);
  size_t j = 0, k = 0;
  for (size_t i = 0; i < d.size(); ++i) {
    while (j < i && d.time[i] - d.time[j] > base) ++j;
    k = std::max(k, i);
    while (k + 1 < d.size() && d.time[k] - d.time[i] < base) ++k;
    const double before = d.time[i] - d.time[j], after = d.time[k] - d.time[i];
    // Both sides nearly whole: the ends of the file and its gaps are left out.
    if (!(before > 0.7 * base && after > 0.7 * base && after < 1.3 * base)) continue;
    if (!climb.empty()) {
      const double dh = d.height[k] - d.height[j];
      if (std::isfinite(dh)) out.climb.add(climb[k] - climb[j], dh), ++out.climbs;
    }
    const GroundVelocity v1 = ground_velocity(d, j, i), v2 = ground_velocity(d, i, k);
    const double north = 0.5 * (v1.north + v2.north), east = 0.5 * (v1.east + v2.east), speed = std::hypot(north, east);
    const double span = 0.5 * (before + after);
    const double across = (north * (v2.east - v1.east) - east * (v2.north - v1.north)) / (span * speed);
    if (!(speed > min_speed && std::abs(across) > min_across) || !std::isfinite(d.roll[i] + d.pitch[i])) continue;
    const double bank = std::atan(across / standard_gravity);
    out.roll.add(bank, core::wrap_pi(d.roll[i]));
    out.pitch.add(bank, core::wrap_pi(d.pitch[i]));
    out.turning += i > 0 ? std::clamp(d.time[i] - d.time[i - 1], 0.0, base) : 0.0;
  }
  return out;
}

void judge_turns(const Sums& s, MotionChecks& out) {
  if (s.turning < min_turning) return;
  out.turning = s.turning;
  out.roll_per_bank = s.roll.value();
  out.pitch_per_bank = s.pitch.value();
  if (out.roll_per_bank < -0.5 && s.roll.correlation() < -min_correlation)
    out.warnings.push_back("roll leans out of the turns by as much as an aircraft banks into them: sign of roll reversed?");
  else if (std::abs(out.roll_per_bank) < 0.5 && std::abs(out.pitch_per_bank) > 0.5 && std::abs(s.pitch.correlation()) > min_correlation)
    out.warnings.push_back("pitch follows the turns as roll should: roll and pitch swapped, or axes turned?");
}

void judge_heights(const Sums& s, MotionChecks& out) {
  if (s.climbs == 0 || std::sqrt(s.climb.xx / static_cast<double>(s.climbs)) < min_climb) return;
  out.climb_ratio = s.climb.value();
  const double r = out.climb_ratio, correlation = s.climb.correlation();
  if (std::abs(correlation) < min_correlation_of_heights) return;
  if (std::abs(r / feet_per_metre - 1.0) < 0.05)
    out.warnings.push_back("heights change " + core::format_number(std::round(r * 1000) / 1000) +
                           " times as much as the recorded vertical velocity says: heights in feet?");
  else if (r < 0.0)
    out.warnings.push_back(
        "heights rise where the recorded vertical velocity says that they fall: velocity counted up, or its sign reversed?");
  else if (std::abs(r - 1.0) > 0.2)
    out.warnings.push_back("heights change " + core::format_number(std::round(r * 1000) / 1000) +
                           " times as much as the recorded vertical velocity says: check the units of both");
}

}  // namespace

MotionChecks check_motion(const core::TrajectoryData& d, core::MetresPerSecond min_speed) {
  MotionChecks out;
  const Sums s = sums_of(d, min_speed.value);
  judge_turns(s, out);
  out.turns_contradict = !out.warnings.empty();
  const size_t before = out.warnings.size();
  judge_heights(s, out);
  out.heights_contradict = out.warnings.size() > before;
  return out;
}

}  // namespace swath::trajectory
