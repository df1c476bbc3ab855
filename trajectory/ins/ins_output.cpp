// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/ins_output.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "core/parallel.h"

namespace swath::trajectory {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Covariance = Eigen::Matrix<double, 9, 9>;

void append(core::TrajectoryData& out, const NavState& nav, const Eigen::Matrix<double, 9, 1>& variance) {
  const core::Geodetic g = core::geodetic_of(nav.position);
  const Matrix3d ned = core::ecef_R_ned(g.latitude, g.longitude);
  const core::Attitude a = core::attitude_of(ned.transpose() * nav.ecef_R_body);
  const Vector3d v = ned.transpose() * nav.velocity;
  out.time.push_back(nav.time);
  out.latitude.push_back(g.latitude);
  out.longitude.push_back(g.longitude);
  out.height.push_back(g.height);
  out.roll.push_back(a.roll);
  out.pitch.push_back(a.pitch);
  out.heading.push_back(a.heading);
  out.v_north.push_back(v.x());
  out.v_east.push_back(v.y());
  out.v_down.push_back(v.z());
  const auto sigma = [&variance](Eigen::Index i) { return static_cast<float>(std::sqrt(std::max(0.0, variance[i]))); };
  out.sigma_north.push_back(sigma(0));
  out.sigma_east.push_back(sigma(1));
  out.sigma_down.push_back(sigma(2));
  out.sigma_roll.push_back(sigma(6));
  out.sigma_pitch.push_back(sigma(7));
  out.sigma_heading.push_back(sigma(8));
}

constexpr double same_record = 1e-6;  // s
constexpr size_t intervals_of_a_part = 256;

/// The walk is at the end of a record that is not a bridge, not at a cut.
bool at_record(const ImuPath& path, const ImuWalk& walk) {
  return std::abs(walk.time() - path.imu.time[walk.record()]) < same_record && !path.is_bridged(walk.record());
}

/// Which of the IMU's records make an output at no more than a rate: every so many, counted from the flight's first.
class Thinning {
 public:
  Thinning(const Problem& problem, double rate) {
    const ImuPath& path = problem.path;
    const double step = (path.end() - path.begin()) / static_cast<double>(path.imu.size());
    every_ = static_cast<std::uint64_t>(std::max(1.0, std::round(1.0 / (rate * step))));
    const size_t intervals = problem.nodes.size() - 1, parts = (intervals + intervals_of_a_part - 1) / intervals_of_a_part;
    before_.assign(parts + 1, 0);
    if (every_ == 1) return;
    core::in_parallel(intervals, intervals_of_a_part, [&](size_t first, size_t last) {
      std::uint64_t& count = before_[first / intervals_of_a_part + 1];
      Increment piece;
      ImuWalk walk(path, problem.nodes[first].time);
      for (size_t k = first; k < last; ++k)
        while (walk.next(problem.nodes[k + 1].time, piece)) count += at_record(path, walk) ? 1 : 0;
    });
    for (size_t p = 0; p < parts; ++p) before_[p + 1] += before_[p];
  }
  size_t parts() const { return before_.size() - 1; }
  bool takes_all() const { return every_ == 1; }
  std::uint64_t before(size_t part) const { return before_[part]; }
  bool takes(std::uint64_t record) const { return record % every_ == 0; }

 private:
  std::uint64_t every_ = 1;
  std::vector<std::uint64_t> before_;  ///< records before each part; where all are taken nobody counts
};

/// Gives the output's states of one interval after another, moved so that they end at the next node. One per part of the intervals.
class Between {
 public:
  Between(const Problem& problem, const Thinning& thinning, size_t part)
      : problem_(problem), thinning_(thinning), count_(thinning.before(part)) {}

  /// From node k on; valid until the next call.
  const std::vector<NavState>& states(size_t k, const Estimate& start, const NavState& next) {
    const std::vector<Node>& nodes = problem_.nodes;
    NavState nav = start.nav;
    ImuWalk walk(problem_.path, nodes[k].time);
    states_.clear();
    Increment piece;
    while (walk.next(nodes[k + 1].time, piece)) {
      advance(nav, start.corrected(piece));
      nav.time = walk.time();
      if (at_record(problem_.path, walk) && thinning_.takes(count_++)) states_.push_back(nav);
    }
    const double length = nodes[k + 1].time - nodes[k].time;
    const Vector3d position = next.position - nav.position, velocity = next.velocity - nav.velocity;
    const Vector3d turn = core::log_so3(next.ecef_R_body * nav.ecef_R_body.transpose());
    for (NavState& n : states_) {
      const double s = (n.time - nodes[k].time) / length;
      n.position += (3 - 2 * s) * s * s * position + (s - 1) * s * s * length * velocity;
      n.velocity += s * velocity;
      n.ecef_R_body = core::exp_so3(s * turn) * n.ecef_R_body;
    }
    return states_;
  }
  /// Counts the records of an interval that nobody wants.
  void pass(size_t k) {
    if (thinning_.takes_all()) return;
    Increment piece;
    ImuWalk walk(problem_.path, problem_.nodes[k].time);
    while (walk.next(problem_.nodes[k + 1].time, piece)) count_ += at_record(problem_.path, walk) ? 1 : 0;
  }

 private:
  const Problem& problem_;
  const Thinning& thinning_;
  std::uint64_t count_;
  std::vector<NavState> states_;
};

void append(core::TrajectoryData& out, const core::TrajectoryData& part) {
  using Data = core::TrajectoryData;
  constexpr std::array doubles{&Data::time,  &Data::latitude, &Data::longitude, &Data::height, &Data::roll,
                               &Data::pitch, &Data::heading,  &Data::v_north,   &Data::v_east, &Data::v_down};
  constexpr std::array floats{&Data::sigma_north, &Data::sigma_east,  &Data::sigma_down,
                              &Data::sigma_roll,  &Data::sigma_pitch, &Data::sigma_heading};
  const auto add = [&](auto column) { (out.*column).insert((out.*column).end(), (part.*column).begin(), (part.*column).end()); };
  for (const auto column : doubles) add(column);
  for (const auto column : floats) add(column);
}

}  // namespace

core::TrajectoryData trajectory_of(const Problem& problem, const std::vector<SmoothedNode>& smoothed, double rate) {
  const std::vector<Node>& nodes = problem.nodes;
  core::TrajectoryData out;
  for (size_t k = 0; k < nodes.size(); ++k) {
    out.covariance.time.push_back(nodes[k].time);
    out.covariance.upper.push_back(smoothed[k].covariance);
  }
  if (nodes.size() < 2) return out;
  const Thinning thinning(problem, rate);
  std::vector<core::TrajectoryData> made(thinning.parts());
  core::in_parallel(nodes.size() - 1, intervals_of_a_part, [&](size_t first, size_t last) {
    const size_t part = first / intervals_of_a_part;
    Between between(problem, thinning, part);
    for (size_t k = first; k < last; ++k) {
      const Covariance a = core::CovarianceSeries::unpack(smoothed[k].covariance),
                       b = core::CovarianceSeries::unpack(smoothed[k + 1].covariance);
      for (const NavState& n : between.states(k, smoothed[k].estimate, smoothed[k + 1].estimate.nav)) {
        const double s = (n.time - nodes[k].time) / (nodes[k + 1].time - nodes[k].time);
        append(made[part], n, (1 - s) * a.diagonal() + s * b.diagonal());
      }
    }
  });
  for (core::TrajectoryData& part : made) {
    append(out, part);
    part = {};
  }
  return out;
}

PoseRecords poses_of(const Problem& problem, const std::vector<Estimate>& estimates, double rate, const std::vector<char>& wanted) {
  PoseRecords out;
  const Thinning thinning(problem, rate);
  std::vector<PoseRecords> made(thinning.parts());
  core::in_parallel(wanted.size(), intervals_of_a_part, [&](size_t first, size_t last) {
    PoseRecords& mine = made[first / intervals_of_a_part];
    Between between(problem, thinning, first / intervals_of_a_part);
    for (size_t k = first; k < last; ++k) {
      if (!wanted[k]) {
        between.pass(k);
        continue;
      }
      for (const NavState& n : between.states(k, estimates[k], estimates[k + 1].nav)) {
        mine.time.push_back(n.time);
        mine.position.push_back(n.position);
        mine.ecef_R_body.push_back(n.ecef_R_body);
      }
    }
  });
  for (PoseRecords& part : made) {
    out.time.insert(out.time.end(), part.time.begin(), part.time.end());
    out.position.insert(out.position.end(), part.position.begin(), part.position.end());
    out.ecef_R_body.insert(out.ecef_R_body.end(), part.ecef_R_body.begin(), part.ecef_R_body.end());
    part = {};
  }
  return out;
}

}  // namespace swath::trajectory
