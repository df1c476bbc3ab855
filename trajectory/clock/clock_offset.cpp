// SPDX-License-Identifier: GPL-3.0-or-later
// No published source for the whole; second differences instead of Wu and Pan's integrals (2013) as in trajectory/ins/alignment.h, offset
// by correlation as in Skog and Haendel (2011, "Time synchronization errors in loosely coupled GPS-aided inertial navigation systems"),
// sigma by clusters after Liang and Zeger (1986, "Longitudinal data analysis using generalized linear models").
// Deviation: gravity and Coriolis are those of the middle fix; their changes are odd about it and leave less than 1e-5 m/s^2.
#include "trajectory/clock/clock_offset.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <utility>
#include <vector>

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "core/statistics.h"
#include "core/time.h"
#include "trajectory/clock/clock_windows.h"
#include "trajectory/clock/latency.h"

namespace swath::trajectory {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
constexpr int own = 15;                             // unknowns of a window beside the offset
using VectorN = Eigen::Matrix<double, own + 1, 1>;  // offset; rotation; gyro and accelerometer bias; their scale factors
using MatrixN = Eigen::Matrix<double, own + 1, own + 1>;

constexpr double widest_fixes = 3.0;             // s between fixes
constexpr std::array half_spans{1.0, 2.0, 4.0};  // s: shaken vehicles, flights
constexpr double huber = 2.5;
constexpr double loose_drift = 3e-3, loose_bias = 0.2;      // rad/s, m/s^2: what a window may take beside the stated sensor errors
constexpr double loose_scale = 2e-4;                        // the same of scale factors
constexpr double least_scale = 1e-3;                        // m/s^2
constexpr double largest_sigma = 0.02, least_sigma = 2e-4;  // s
constexpr double sure_sigmas = 4.0;
constexpr double alike = 5.0;  // difference of log likelihoods below which two offsets fit alike
constexpr double apart = 0.5;  // s: nearer minima are one
constexpr int rounds = 15;
constexpr double leap_search = 0.5;      // s about the leap seconds: clocks that one receiver set
constexpr double leap_contrast = 0.8;    // records that fit have 0.95
constexpr double velocity_search = 1.0;  // s

/// What the IMU senses at an offset between the grid's, by the cubic through the four around; and its derivative by the offset.
std::pair<Vector3d, Vector3d> sensed_at(const ClockTriple& t, double offset) {
  const double x = offset / clock_grid + 0.5 * static_cast<double>(t.sensed.size() - 1);
  const auto k = static_cast<size_t>(std::clamp(std::floor(x), 1.0, static_cast<double>(t.sensed.size()) - 3));
  const double s = x - static_cast<double>(k);
  const Vector3d &a = t.sensed[k - 1], &b = t.sensed[k], &c = t.sensed[k + 1], &d = t.sensed[k + 2];
  const Vector3d p1 = c - a / 3 - b / 2 - d / 6, p2 = (a + c) / 2 - b, p3 = (d - a) / 6 + (b - c) / 2;
  return {b + s * (p1 + s * (p2 + s * p3)), (p1 + s * (2 * p2 + s * 3 * p3)) / clock_grid};
}

/// The rotation from the body's axes at the window's beginning to the fixes' (Wahba). `weight`: per triple, or empty.
Matrix3d rotation_of(const ClockWindow& w, const std::vector<Vector3d>& sensed, const std::vector<double>& weight) {
  Matrix3d sum = Matrix3d::Zero();
  for (size_t i = 0; i < w.triples.size(); ++i) sum += (weight.empty() ? 1.0 : weight[i]) * w.triples[i].force * sensed[i].transpose();
  const Eigen::JacobiSVD<Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  return svd.matrixU() * Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
}

/// Sum of the distances at one offset of the grid.
double misfit(const std::vector<ClockWindow>& windows, size_t offset) {
  double sum = 0;
  std::vector<Vector3d> sensed;
  for (const ClockWindow& w : windows) {
    sensed.clear();
    for (const ClockTriple& t : w.triples) sensed.push_back(t.sensed[offset]);
    const Matrix3d R = rotation_of(w, sensed, {});
    for (size_t i = 0; i < sensed.size(); ++i) sum += (w.triples[i].force - R * sensed[i]).norm();
  }
  return sum;
}

/// The common offset at one round: normal equations of each window with its own unknowns taken out.
struct Round {
  std::vector<double> normal, right;        // per window, of the offset
  std::vector<std::vector<Vector3d>> left;  // residuals with the windows' unknowns taken out
  double step() const {
    const double n = std::accumulate(normal.begin(), normal.end(), 0.0);
    return n > 0 ? std::accumulate(right.begin(), right.end(), 0.0) / n : 0.0;
  }
};

double huber_weight(double residual, double scale) {
  const double z = std::abs(residual) / scale;
  return z > huber ? huber / z : 1.0;
}

/// `before`: residuals of the round before, for the weights; empty at first.
void solve_window(const ClockWindow& w, double offset, const Vector3d& scale, const VectorN& prior, const std::vector<Vector3d>& before,
                  Round& out) {
  std::vector<Vector3d> sensed, rate;
  std::vector<double> whole(before.empty() ? 0 : w.triples.size(), 1.0);
  for (const ClockTriple& t : w.triples) {
    const auto [value, slope] = sensed_at(t, offset);
    sensed.push_back(value);
    rate.push_back(slope);
  }
  for (size_t i = 0; i < whole.size(); ++i)
    for (int a = 0; a < 3; ++a) whole[i] = std::min(whole[i], huber_weight(before[i][a], scale[a]));
  const Matrix3d R = rotation_of(w, sensed, whole);
  MatrixN normal = prior.asDiagonal();
  VectorN right = VectorN::Zero();
  std::vector<Eigen::Matrix<double, 3, own + 1>> rows;
  std::vector<Vector3d> residual;
  for (size_t i = 0; i < w.triples.size(); ++i) {
    const ClockTriple& t = w.triples[i];
    Eigen::Matrix<double, 3, own + 1> J;
    const Vector3d turned = R * sensed[i];
    J << R * rate[i], -core::skew(turned), -core::skew(turned) * R * t.drift, R * t.turn, -core::skew(turned) * R * t.scale,
        R * t.turn * (t.turn.transpose() * sensed[i]).asDiagonal().toDenseMatrix();
    const Vector3d r = t.force - turned;
    for (int a = 0; a < 3; ++a) {
      const double weight = (before.empty() ? 1.0 : huber_weight(before[i][a], scale[a])) / (scale[a] * scale[a]);
      normal += weight * J.row(a).transpose() * J.row(a);
      right += weight * r[a] * J.row(a).transpose();
    }
    rows.push_back(J);
    residual.push_back(r);
  }
  const Eigen::Matrix<double, own, own> theirs = normal.bottomRightCorner<own, own>();
  const Eigen::LDLT<Eigen::Matrix<double, own, own>> solver(theirs);
  const Eigen::Matrix<double, own, 1> by_offset = solver.solve(normal.block<own, 1>(1, 0)), by_right = solver.solve(right.tail<own>());
  out.normal.push_back(normal(0, 0) - normal.block<own, 1>(1, 0).dot(by_offset));
  out.right.push_back(right[0] - normal.block<own, 1>(1, 0).dot(by_right));
  for (size_t i = 0; i < residual.size(); ++i) residual[i] -= rows[i].rightCols<own>() * by_right;
  out.left.push_back(std::move(residual));
}

Vector3d scale_of(const std::vector<std::vector<Vector3d>>& left) {
  Vector3d out;
  for (int a = 0; a < 3; ++a) {
    std::vector<double> sizes;
    for (const auto& window : left)
      for (const Vector3d& r : window) sizes.push_back(std::abs(r[a]));
    out[a] = std::max(least_scale, core::mad_to_sigma * core::median(std::move(sizes), 0.0));
  }
  return out;
}

std::string seconds(double v, const char* form = "%.3f s") {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), form, v);  // NOLINT: the formats are the callers' literals
  return text.data();
}

/// The grid's best offset; `alike_triples`: neighbours that count as one. Sets `out.reason` where another fits as well or it lies at the
/// end.
double coarse_offset(const std::vector<ClockWindow>& windows, size_t offsets, double alike_triples, TimeOffset& out) {
  std::vector<double> cost(offsets);
  for (size_t i = 0; i < offsets; ++i) cost[i] = misfit(windows, i);
  const auto best = static_cast<size_t>(std::min_element(cost.begin(), cost.end()) - cost.begin());
  const auto value = [&](size_t i) { return (static_cast<double>(i) - 0.5 * static_cast<double>(offsets - 1)) * clock_grid; };
  double triples = 0;
  for (const ClockWindow& w : windows) triples += static_cast<double>(w.triples.size());
  out.contrast = 1 - cost[best] / std::max(core::median(cost), 1e-12);
  // Distances that are exponentially distributed have the log likelihood -sum / mean; neighbours within a span are about one.
  const double mean = std::max(cost[best] / triples, least_scale);
  const auto likelihood = [&](size_t i) { return (cost[i] - cost[best]) / mean / alike_triples; };
  for (size_t i = 0; i < offsets; ++i) {
    const bool minimum = (i == 0 || cost[i] <= cost[i - 1]) && (i + 1 == offsets || cost[i] <= cost[i + 1]);
    if (!minimum || std::abs(value(i) - value(best)) < apart || likelihood(i) > alike) continue;
    out.reason = "the motion is too weak or repeats itself: offsets of " + seconds(value(best), "%.2f s") + " and " +
                 seconds(value(i), "%.2f s") + " fit alike";
    break;
  }
  if (best < 2 || best + 3 > offsets) out.reason = "the best offset lies at the end of the search";
  return value(best);
}

/// Sigma of the common offset from the scatter of the windows' own answers and from the residuals' noise.
double sigma_of(const Round& r, double alike_triples, double speed, double lever_sigma) {
  const double n = std::accumulate(r.normal.begin(), r.normal.end(), 0.0), step = r.step();
  double scores = 0, squares = 0;
  for (size_t i = 0; i < r.normal.size(); ++i) {
    scores += std::pow(r.right[i] - r.normal[i] * step, 2);
    squares += r.normal[i] * r.normal[i];
  }
  // Few windows say little of their own scatter: the residuals' noise counts like two more.
  const double windows = n * n / squares;  // of equal weight
  const double noise = alike_triples / n, scatter = scores / (n * n) * windows;
  const double sigma = std::sqrt((scatter + 2 * noise) / (windows + 1));
  return std::sqrt(sigma * sigma + std::pow(lever_sigma / std::max(speed, 1.0), 2) + least_sigma * least_sigma);
}

TimeOffset refine(const std::vector<ClockWindow>& windows, double coarse, double search, const core::ImuErrorModel& spec,
                  double lever_sigma, double alike_triples, TimeOffset out) {
  VectorN prior = VectorN::Zero();
  prior.segment<3>(1).setConstant(1.0);
  prior.segment<3>(4).setConstant(1 / std::pow(loose_drift + 3 * spec.gyro_bias.value, 2));
  prior.segment<3>(7).setConstant(1 / std::pow(loose_bias + 3 * spec.accelerometer_bias.value, 2));
  prior.segment<3>(10).setConstant(1 / std::pow(loose_scale + 3 * spec.gyro_scale.value, 2));
  prior.segment<3>(13).setConstant(1 / std::pow(loose_scale + 3 * spec.accelerometer_scale.value, 2));
  Vector3d scale = Vector3d::Constant(0.1);
  Round round;
  double offset = coarse;
  for (int i = 0; i < rounds; ++i) {
    Round next;
    for (size_t w = 0; w < windows.size(); ++w)
      solve_window(windows[w], offset, scale, prior, i == 0 ? std::vector<Vector3d>{} : round.left[w], next);
    round = std::move(next);
    scale = scale_of(round.left);
    if (!std::isfinite(round.step())) break;
    const double step = std::clamp(round.step(), -2 * clock_grid, 2 * clock_grid);
    offset = std::clamp(offset + step, -search, search);
    if (i > 2 && std::abs(step) < 1e-5) break;
  }
  double speed = 0, weight = 0;
  for (size_t w = 0; w < windows.size(); ++w) {
    speed += round.normal[w] * windows[w].speed;
    weight += round.normal[w];
    out.used += static_cast<std::int64_t>(windows[w].triples.size());
  }
  out.value = offset;
  out.rms = scale;
  if (!(weight > 0)) {
    out.reason = "the motion does not change";
    return out;
  }
  const double sigma = sigma_of(round, alike_triples, speed / weight, lever_sigma);
  if (out.reason.empty() && (!(sigma < largest_sigma) || std::abs(offset - coarse) > 0.5 * apart))
    out.reason = "the motion changes too little against the records' noise (sigma " + seconds(sigma) + ")";
  out.determinable = out.reason.empty();
  if (out.determinable) out.sigma = sigma;
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
  const size_t offsets = 2 * static_cast<size_t>(std::ceil(search / clock_grid)) + 5;  // two beyond the search on either side
  out.reason = "no 20 s of fixes and IMU records without a gap";
  for (const double half_span : half_spans) {
    const std::vector<ClockWindow> windows =
        clock_windows(path, gnss, lever_arm, 0.5 * static_cast<double>(offsets - 1) * clock_grid, step, half_span, offsets);
    if (windows.empty()) continue;
    const double alike_triples = std::max(half_span, step) / std::max(clock_spacing, step);
    TimeOffset found;
    const double coarse = coarse_offset(windows, offsets, alike_triples, found);
    found = refine(windows, coarse, search, spec, lever_arm_sigma, alike_triples, found);
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
