// SPDX-License-Identifier: GPL-3.0-or-later
// Source: cubic Lagrange interpolation in Newton's form (Press et al. 2007, 3.2); rotation vectors and their rates after
// Sola, "Quaternion kinematics for the error-state Kalman filter" (2017), eqs. 101 and 184 (right Jacobian).
// Deviation: none beyond the cubic's own error (header): rotation vectors about a neighbouring record are a smooth chart of the rotations.
#include "trajectory/trajectory.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "trajectory/checks.h"

namespace swath::trajectory {

namespace {

std::string at_record(const std::string& where, size_t record) { return where + ": record " + std::to_string(record); }

void check_times(const std::vector<double>& time, const std::string& where) {
  for (size_t i = 1; i < time.size(); ++i)
    if (time[i] <= time[i - 1])
      throw core::Error("time does not increase: " + core::format_number(time[i]) + " s after " + core::format_number(time[i - 1]) + " s",
                        at_record(where, i), "sort the file by time and remove doubled records");
}

void check(const core::TrajectoryData& d, const std::string& where) {
  const size_t n = d.size();
  const auto whole = [&](const auto& column, const char* name, bool optional) {
    if (optional && column.empty()) return;
    if (column.size() != n)
      throw core::Error(std::string(name) + " has " + std::to_string(column.size()) + " entries, time has " + std::to_string(n), where);
    for (size_t i = 0; i < n; ++i)
      if (!std::isfinite(column[i])) throw core::Error(std::string(name) + " is not a finite number", at_record(where, i));
  };
  whole(d.time, "time", false);
  whole(d.latitude, "latitude", false);
  whole(d.longitude, "longitude", false);
  whole(d.height, "height", false);
  whole(d.roll, "roll", false);
  whole(d.pitch, "pitch", false);
  whole(d.heading, "heading", false);
  whole(d.sigma_north, "sigma_north", true);
  whole(d.sigma_east, "sigma_east", !d.has_sigma());
  whole(d.sigma_down, "sigma_down", !d.has_sigma());
  whole(d.sigma_roll, "sigma_roll", !d.has_sigma());
  whole(d.sigma_pitch, "sigma_pitch", !d.has_sigma());
  whole(d.sigma_heading, "sigma_heading", !d.has_sigma());
  constexpr double pole = core::pi / 2.0;
  for (size_t i = 0; i < n; ++i)
    if (std::abs(d.latitude[i]) > pole)
      throw core::Error("latitude is beyond the pole: " + core::format_number(d.latitude[i]) + " rad", at_record(where, i),
                        "latitudes, longitudes and angles are radians inside: state the unit of the file's columns");
  check_times(d.time, where);
}

// Coefficients of powers of (t - origin) of the polynomial through n <= 4 points (Newton's divided differences, then expanded).
void polynomial(const double* t, const Eigen::Vector3d* y, int n, double origin, Eigen::Vector3d* out) {
  Eigen::Vector3d difference[4];
  for (int i = 0; i < n; ++i) difference[i] = y[i];
  for (int order = 1; order < n; ++order)
    for (int i = n - 1; i >= order; --i) difference[i] = (difference[i] - difference[i - 1]) / (t[i] - t[i - order]);
  for (int i = 0; i < 4; ++i) out[i].setZero();
  for (int i = n - 1; i >= 0; --i) {  // Horner: out = out * (s - (t_i - origin)) + difference_i
    const double root = t[i] - origin;
    for (int k = 3; k > 0; --k) out[k] = out[k - 1] - root * out[k];
    out[0] = difference[i] - root * out[0];
  }
}

}  // namespace

Pose Interval::pose(double t) const {
  const double s = t - start;
  const Eigen::Vector3d w = rotation[0] + s * (rotation[1] + s * (rotation[2] + s * rotation[3]));
  const Eigen::Vector3d w_rate = rotation[1] + s * (2.0 * rotation[2] + s * 3.0 * rotation[3]);
  Pose p;
  p.position = position[0] + s * (position[1] + s * (position[2] + s * position[3]));
  p.velocity = position[1] + s * (2.0 * position[2] + s * 3.0 * position[3]);
  p.ecef_R_body = base_attitude * core::exp_so3(w);
  // Right Jacobian of SO(3) to second order in |w| (eq. 184); what is left is |w|^3 / 24 of the rate.
  p.rate = w_rate - 0.5 * w.cross(w_rate) + w.cross(w.cross(w_rate)) / 6.0;
  return p;
}

Trajectory::Trajectory(core::TrajectoryData data, const TrajectoryOptions& options, const std::string& where) : data_(std::move(data)) {
  check(data_, where);
  const size_t n = data_.size();
  ecef_.reserve(n);
  attitude_.reserve(n);
  for (size_t i = 0; i < n; ++i) {
    ecef_.push_back(core::ecef_of({data_.latitude[i], data_.longitude[i], data_.height[i]}));
    attitude_.push_back(core::ecef_R_ned(data_.latitude[i], data_.longitude[i]) *
                        core::matrix_of({data_.roll[i], data_.pitch[i], data_.heading[i]}));
  }
  find_spans(options, where);
}

Trajectory::Trajectory(PoseRecords records, const TrajectoryOptions& options, const std::string& where)
    : ecef_(std::move(records.position)), attitude_(std::move(records.ecef_R_body)) {
  data_.time = std::move(records.time);
  if (ecef_.size() != data_.size() || attitude_.size() != data_.size()) throw core::Error("columns of poses differ in length", where);
  for (size_t i = 0; i < data_.size(); ++i)
    if (!std::isfinite(data_.time[i]) || !ecef_[i].allFinite() || !attitude_[i].allFinite())
      throw core::Error("a pose is not of finite numbers", at_record(where, i));
  check_times(data_.time, where);
  find_spans(options, where);
}

void Trajectory::find_spans(const TrajectoryOptions& options, const std::string& where) {
  const size_t n = data_.size();
  span_of_.assign(n, -1);
  const double longest = options.max_gap.value + time_rounding;
  for (size_t first = 0; first < n;) {
    size_t last = first;
    while (last + 1 < n && data_.time[last + 1] - data_.time[last] <= longest) ++last;
    if (last > first) {
      for (size_t i = first; i <= last; ++i) span_of_[i] = static_cast<long>(spans_.size());
      spans_.push_back({data_.time[first], data_.time[last]});
      records_.emplace_back(first, last);
    }
    first = last + 1;
  }
  if (spans_.empty())
    throw core::Error("no two of its " + std::to_string(n) + " records are within max_gap (" +
                          core::format_quantity(core::Dimension::time, options.max_gap.value) + ") of each other",
                      where,
                      n < 2 ? "a trajectory needs two records at least" : "raise max_gap if the trajectory's rate is lower than that");
}

long Trajectory::interval_at(double t, long hint) const {
  const long n = static_cast<long>(data_.size());
  const auto holds = [&](long i) {
    return i >= 0 && i + 1 < n && span_of_[i] >= 0 && span_of_[i] == span_of_[i + 1] && t >= data_.time[i] && t <= data_.time[i + 1];
  };
  if (hint >= 0 && holds(hint + 1) && t < data_.time[hint + 2]) return hint + 1;
  const auto after = std::upper_bound(data_.time.begin(), data_.time.end(), t);
  const long i = static_cast<long>(after - data_.time.begin()) - 1;
  if (holds(i)) return i;
  if (holds(i - 1)) return i - 1;  // t is the last record of a span
  return -1;
}

Interval Trajectory::interval(long k) const {
  const auto [span_first, span_last] = records_[static_cast<size_t>(span_of_[k])];
  const long first = std::max(span_first, std::min(k - 1, span_last - 3));
  const int n = static_cast<int>(std::min(first + 3, span_last) - first + 1);
  Interval out;
  out.start = data_.time[k];
  out.end = data_.time[k + 1];
  out.base_attitude = attitude_[k];
  double t[4] = {};
  Eigen::Vector3d place[4], turn[4];
  for (int i = 0; i < n; ++i) {
    t[i] = data_.time[first + i];
    place[i] = ecef_[first + i] - ecef_[k];
    turn[i] = core::log_so3(attitude_[k].transpose() * attitude_[first + i]);
  }
  polynomial(t, place, n, out.start, out.position);
  polynomial(t, turn, n, out.start, out.rotation);
  out.position[0] += ecef_[k];
  return out;
}

std::optional<Pose> Trajectory::pose_at(double t) const {
  const long k = interval_at(t);
  if (k < 0) return std::nullopt;
  return interval(k).pose(t);
}

PoseSigma Trajectory::sigma_in(long k, double t) const {
  PoseSigma s;
  if (!has_sigma()) return s;
  const double w = (t - data_.time[k]) / (data_.time[k + 1] - data_.time[k]);
  const auto mix = [&](const std::vector<float>& c) { return (1.0 - w) * static_cast<double>(c[k]) + w * static_cast<double>(c[k + 1]); };
  s.north = mix(data_.sigma_north);
  s.east = mix(data_.sigma_east);
  s.down = mix(data_.sigma_down);
  s.roll = mix(data_.sigma_roll);
  s.pitch = mix(data_.sigma_pitch);
  s.heading = mix(data_.sigma_heading);
  return s;
}

PoseSigma Trajectory::sigma_at(double t) const {
  const long k = interval_at(t);
  return k < 0 ? PoseSigma{} : sigma_in(k, t);
}

bool Cursor::move(double t) {
  const long k = trajectory_->interval_at(t, number_);
  if (k < 0) return false;
  if (k != number_) interval_ = trajectory_->interval(k);
  number_ = k;
  return true;
}

}  // namespace swath::trajectory
