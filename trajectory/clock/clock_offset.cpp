// SPDX-License-Identifier: GPL-3.0-or-later
// No published source for the whole; second differences instead of Wu and Pan's integrals (2013) as in trajectory/ins/alignment.h, offset
// by correlation as in Skog and Haendel (2011, "Time synchronization errors in loosely coupled GPS-aided inertial navigation systems").
// Deviation: gravity and Coriolis are those of the middle fix; their changes are odd about it and leave less than 1e-5 m/s^2.
#include "trajectory/clock/clock_offset.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "core/statistics.h"
#include "core/time.h"
#include "trajectory/clock/clock_fit.h"
#include "trajectory/clock/clock_windows.h"
#include "trajectory/clock/latency.h"

namespace swath::trajectory {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double widest_fixes = 3.0;             // s between fixes
constexpr std::array half_spans{1.0, 2.0, 4.0};  // s: shaken vehicles, flights
constexpr double least_distance = 1e-3;          // m/s^2
constexpr double largest_sigma = 0.02;           // s
constexpr double sure_sigmas = 4.0;
constexpr double alike = 5.0;            // difference of log likelihoods below which two offsets fit alike
constexpr double apart = 0.5;            // s: nearer minima are one
constexpr double leap_search = 0.5;      // s about the leap seconds: clocks that one receiver set
constexpr double leap_contrast = 0.8;    // records that fit have 0.95
constexpr double velocity_search = 1.0;  // s

/// Sum of the distances at one offset of the grid.
double misfit(const std::vector<ClockWindow>& windows, size_t offset) {
  double sum = 0;
  std::vector<Vector3d> sensed;
  for (const ClockWindow& w : windows) {
    sensed.clear();
    for (const ClockTriple& t : w.triples) sensed.push_back(t.sensed[offset]);
    const Matrix3d R = body_rotation(w, sensed);
    for (size_t i = 0; i < sensed.size(); ++i) sum += (w.triples[i].force - R * sensed[i]).norm();
  }
  return sum;
}

std::string seconds(double v, const char* form = "%.3f s") {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), form, v);  // NOLINT: the formats are the callers' literals
  return text.data();
}

/// The grid's best offset; `alike_triples`: neighbours that count as one. Sets `out.reason` where another fits as well or it lies at the
/// end.
double coarse_offset(const std::vector<ClockWindow>& windows, const ClockGrid& grid, double alike_triples, TimeOffset& out) {
  const size_t offsets = grid.offsets;
  std::vector<double> cost(offsets);
  for (size_t i = 0; i < offsets; ++i) cost[i] = misfit(windows, i);
  const auto best = static_cast<size_t>(std::min_element(cost.begin(), cost.end()) - cost.begin());
  double triples = 0;
  for (const ClockWindow& w : windows) triples += static_cast<double>(w.triples.size());
  out.contrast = 1 - cost[best] / std::max(core::median(cost), 1e-12);
  // Distances that are exponentially distributed have the log likelihood -sum / mean; neighbours within a span are about one.
  const double mean = std::max(cost[best] / triples, least_distance);
  const auto likelihood = [&](size_t i) { return (cost[i] - cost[best]) / mean / alike_triples; };
  for (size_t i = 0; i < offsets; ++i) {
    const bool minimum = (i == 0 || cost[i] <= cost[i - 1]) && (i + 1 == offsets || cost[i] <= cost[i + 1]);
    if (!minimum || std::abs(grid.at(i) - grid.at(best)) < apart || likelihood(i) > alike) continue;
    out.reason = "the motion is too weak or repeats itself: offsets of " + seconds(grid.at(best), "%.2f s") + " and " +
                 seconds(grid.at(i), "%.2f s") + " fit alike";
    break;
  }
  if (best < 2 || best + 3 > offsets) out.reason = "the best offset lies at the end of the search";
  return grid.at(best);
}

/// The offset by a fit on `windows`, which lie on a grid about `middle`.
TimeOffset refined(const std::vector<ClockWindow>& windows, const ClockFit& fit, double middle, TimeOffset out) {
  for (const ClockWindow& w : windows) out.used += static_cast<std::int64_t>(w.triples.size());
  out.value = middle + fit.shift;
  out.rms = fit.rms;
  if (!fit.motion_changes) {
    out.reason = "the motion does not change";
    return out;
  }
  if (out.reason.empty() && (!(fit.sigma < largest_sigma) || std::abs(fit.shift) > 0.5 * apart))
    out.reason = "the motion changes too little against the records' noise (sigma " + seconds(fit.sigma) + ")";
  out.determinable = out.reason.empty();
  if (out.determinable) out.sigma = fit.sigma;
  return out;
}

}  // namespace

bool TimeOffset::is_significant(double floor) const { return determinable && std::abs(value) > std::max(sure_sigmas * sigma, floor); }

TimeOffset imu_clock_offset(const ImuPath& path, const core::GnssData& gnss, const core::ImuErrorModel& spec, const Vector3d& lever_arm,
                            double lever_arm_sigma, double search) {
  TimeOffset out;
  std::vector<double> steps;
  for (size_t k = 1; k < gnss.size(); ++k) steps.push_back(gnss.time[k] - gnss.time[k - 1]);
  const double step = core::median(std::move(steps), widest_fixes + 1);
  if (step > widest_fixes) {
    out.reason = "the fixes are more than 3 s apart";
    return out;
  }
  const auto about = [](double middle, double reach) {
    return ClockGrid{middle, 2 * static_cast<size_t>(std::ceil(reach / clock_grid)) + 5};  // two beyond it on either side
  };
  const ClockGrid whole = about(0.0, search);
  out.reason = "no 20 s of fixes and IMU records without a gap";
  for (const double half_span : half_spans) {
    const std::vector<ClockWindow> windows = clock_windows(path, gnss, lever_arm, step, half_span, whole);
    if (windows.empty()) continue;
    const double spacing = std::max(clock_spacing, step), alike_triples = std::max(half_span, step) / spacing;
    TimeOffset found;
    const ClockGrid fine = about(coarse_offset(windows, whole, alike_triples, found), 0.5 * apart);
    // A consumer grade turns by some hundredths of a radian within a window: what was found is taken out, and the rest is small.
    std::vector<ClockWindow> near = clock_windows(path, gnss, lever_arm, step, half_span, fine);
    const ClockFit first = fit_clock(near, fine, spec, lever_arm_sigma, spacing);
    near = clock_windows(path, gnss, lever_arm, step, half_span, fine, first.sensors);
    found = refined(near, fit_clock(near, fine, spec, lever_arm_sigma, spacing), fine.middle, found);
    if (found.determinable && (!out.determinable || found.sigma < out.sigma)) out = found;
    if (!out.determinable && out.used == 0) out = found;
  }
  return out;
}

std::string leap_seconds_between(const ImuPath& path, const core::GnssData& gnss, const core::ImuErrorModel& spec,
                                 const Vector3d& lever_arm, double lever_arm_sigma) {
  if (gnss.time.empty()) return {};
  const int leap = core::gps_minus_utc_at_gps(gnss.time.front());
  for (const int by : {leap, -leap}) {
    core::GnssData moved = gnss;
    for (double& t : moved.time) t += by;
    const TimeOffset rest = imu_clock_offset(path, moved, spec, lever_arm, lever_arm_sigma, leap_search);
    if (!rest.determinable || rest.contrast < leap_contrast) continue;
    return std::string("they fit with the fixes ") + std::to_string(leap) + " s " + (by > 0 ? "later" : "earlier") +
           ": are the times of the " + (by > 0 ? "GNSS" : "IMU") + " records UTC (" + std::to_string(leap) + " leap seconds)?";
  }
  return {};
}

TimeOffset velocity_lag(const core::GnssData& gnss) {
  TimeOffset out;
  Motion positions, velocities;
  const double epoch = gnss.time.empty() ? 0.0 : gnss.time.front();
  for (size_t k = 1; gnss.has_velocity() && k < gnss.size(); ++k) {
    const double step = gnss.time[k] - gnss.time[k - 1];
    const Vector3d mean = 0.5 * (gnss.velocity[k] + gnss.velocity[k - 1]);
    if (!mean.allFinite() || !(step > 0) || step > widest_fixes) continue;
    const double time = 0.5 * ((gnss.time[k] - epoch) + (gnss.time[k - 1] - epoch));
    positions.time.push_back(time);
    positions.value.emplace_back((gnss.position[k] - gnss.position[k - 1]) / step);
    velocities.time.push_back(time);
    velocities.value.push_back(mean);
  }
  LatencyOptions options;
  options.search.value = velocity_search;
  const LatencyResult found = latency_of_rates(positions, velocities, options);
  out.determinable = found.determinable;
  out.reason = found.reason;
  out.value = -found.latency;
  out.sigma = found.sigma;
  out.used = static_cast<std::int64_t>(found.used);
  out.contrast = found.correlation;
  out.rms = found.rms;
  return out;
}

std::string ClockFindings::advice() const {
  const auto quoted = [](double v) { return "\"" + seconds(v) + "\""; };
  const std::string imu_time = stated.imu_offset ? "state offset = " + quoted(*stated.imu_offset - imu.value) + " in the time of [[imu]]"
                                                 : "change the offset in the time of [[imu]] by " + quoted(-imu.value);
  const std::string antenna = stated.antenna_latency ? "antenna.latency = " + quoted(*stated.antenna_latency + imu.value)
                                                     : "antenna.latency greater by " + quoted(imu.value);
  return "the clocks of IMU and GNSS are " + seconds(std::abs(imu.value)) + " apart (sigma " + seconds(imu.sigma) + "; the IMU's is " +
         (imu.value > 0 ? "ahead" : "behind") + "): " + imu_time + ", or " + antenna + " where the laser runs on the IMU's clock";
}

}  // namespace swath::trajectory
