// SPDX-License-Identifier: GPL-3.0-or-later
// The trajectory as a function of time: position, attitude, velocity and body rates at any instant between its records.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/config/option.h"
#include "core/records/trajectory_data.h"

namespace swath::trajectory {

struct TrajectoryOptions {
  core::Seconds max_gap{0.1};
};

template <class V>
void describe(TrajectoryOptions& o, V& v) {
  v.option("max_gap", o.max_gap, core::above(0.0), "Longest step between two records that is interpolated over; a longer one is a gap.");
}

/// The body at one instant.
struct Pose {
  Eigen::Vector3d position;     ///< IMU centre, ecef, m
  Eigen::Matrix3d ecef_R_body;  ///< attitude
  Eigen::Vector3d velocity;     ///< of the IMU centre relative to the Earth, ecef axes, m/s
  Eigen::Vector3d rate;         ///< rotation of body relative to ecef, body axes, rad/s
};

/// Columns of poses by time: s, ecef m, attitude.
struct PoseRecords {
  std::vector<double> time;
  std::vector<Eigen::Vector3d> position;
  std::vector<Eigen::Matrix3d> ecef_R_body;
};

/// One-sigma uncertainties at one instant: m and rad.
struct PoseSigma {
  double north = 0.0, east = 0.0, down = 0.0, roll = 0.0, pitch = 0.0, heading = 0.0;
};

/// A continuous stretch [first, last], GPS time s.
struct Span {
  double first = 0.0, last = 0.0;
  bool operator==(const Span&) const = default;
};

/// Between two records: with s = t - start,
///   position(t) = p0 + p1 s + p2 s^2 + p3 s^3,  ecef_R_body(t) = base_attitude * exp(w0 + w1 s + w2 s^2 + w3 s^3).
struct Interval {
  double start = 0.0, end = 0.0;  ///< GPS time, s
  Eigen::Vector3d position[4];    ///< ecef, m, m/s, m/s^2, m/s^3
  Eigen::Vector3d rotation[4];    ///< rad, rad/s ...
  Eigen::Matrix3d base_attitude;  ///< ecef_R_body at the interval's first record
  Pose pose(double t) const;
};

/// Interpolates ECEF position and attitude by the cubic through the four records nearest to the interval (Lagrange), attitude on rotation
/// vectors relative to the interval's first record: no Euler angle is ever interpolated, so that heading may cross north and +-180 deg.
/// At the ends of a span the four records lie to one side; a span of three or two records is interpolated by a parabola or a line.
/// Intervals longer than max_gap are outside. Immutable, safe to share between threads.
/// Error of the interpolation at 200 Hz for a motion of 2 Hz: 3.7e-7 of its amplitude (6.5e-7 in a span's first and last interval); a roll
/// of +-2 deg at 2 Hz gives 0.013 mm at 1 km (0.023 mm), one at 5 Hz 0.5 mm.
class Trajectory {
 public:
  /// Throws core::Error{where: "<where>: record N"} where times do not increase, a value is not finite, columns differ in length, or no two
  /// records are close enough to make a span.
  explicit Trajectory(core::TrajectoryData data, const TrajectoryOptions& options = {}, const std::string& where = "trajectory");
  /// Through poses as they are, without sigmas; of data() it has the times alone. Times must increase and values be finite.
  explicit Trajectory(PoseRecords records, const TrajectoryOptions& options = {}, const std::string& where = "trajectory");

  const std::vector<Span>& spans() const { return spans_; }
  bool covers(double t) const { return interval_at(t) >= 0; }
  /// Nothing where t is outside every span.
  std::optional<Pose> pose_at(double t) const;
  bool has_sigma() const { return data_.has_sigma(); }
  /// Linear between records; zeros where the file has none or t is outside.
  PoseSigma sigma_at(double t) const;
  const core::TrajectoryData& data() const { return data_; }

  /// The number of the interval (its first record) that holds t, or -1. `hint`: where to look first.
  long interval_at(double t, long hint = -1) const;
  Interval interval(long first_record) const;
  PoseSigma sigma_in(long first_record, double t) const;

 private:
  void find_spans(const TrajectoryOptions& options, const std::string& where);

  core::TrajectoryData data_;
  std::vector<Eigen::Vector3d> ecef_;
  std::vector<Eigen::Matrix3d> attitude_;  // ecef_R_body
  std::vector<long> span_of_;              // per record; -1 for a lone record
  std::vector<Span> spans_;
  std::vector<std::pair<long, long>> records_;  // first and last record of each span
};

/// Follows a trajectory through times that mostly stay in one interval: the interval's polynomials are made once. One per thread.
class Cursor {
 public:
  explicit Cursor(const Trajectory& t) : trajectory_(&t) {}
  /// False where t is outside every span (the interval is then left as it was).
  bool seek(double t) {
    if (number_ >= 0 && t >= interval_.start && t < interval_.end) return true;
    return move(t);
  }
  /// Of the last successful seek.
  const Interval& interval() const { return interval_; }
  long number() const { return number_; }
  Pose pose(double t) const { return interval_.pose(t); }
  PoseSigma sigma(double t) const { return trajectory_->sigma_in(number_, t); }

 private:
  bool move(double t);
  const Trajectory* trajectory_;
  Interval interval_;
  long number_ = -1;
};

}  // namespace swath::trajectory
