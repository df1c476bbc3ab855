// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/ins_output.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

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

size_t parts_of(size_t intervals) { return (intervals + intervals_of_a_part - 1) / intervals_of_a_part; }

/// The walk is at the end of a record that is not a bridge, not at a cut.
bool at_record(const ImuPath& path, const ImuWalk& walk) {
  return std::abs(walk.time() - path.imu.time[walk.record()]) < same_record && !path.is_bridged(walk.record());
}

/// The output's states in the interval from node k on, moved so that they end at the next node.
void states_between(const Problem& problem, const OutputRecords& records, size_t k, const Estimate& start, const NavState& next,
                    std::vector<NavState>& out) {
  const std::vector<Node>& nodes = problem.nodes;
  NavState nav = start.nav;
  ImuWalk walk(problem.path, nodes[k].time);
  std::uint64_t count = records.before(k);
  out.clear();
  Increment piece;
  while (walk.next(nodes[k + 1].time, piece)) {
    advance(nav, start.corrected(piece));
    nav.time = walk.time();
    if (at_record(problem.path, walk) && records.takes(count++)) out.push_back(nav);
  }
  const double length = nodes[k + 1].time - nodes[k].time;
  const Vector3d position = next.position - nav.position, velocity = next.velocity - nav.velocity;
  const Vector3d turn = core::log_so3(next.ecef_R_body * nav.ecef_R_body.transpose());
  for (NavState& n : out) {
    const double s = (n.time - nodes[k].time) / length;
    n.position += (3 - 2 * s) * s * s * position + (s - 1) * s * s * length * velocity;
    n.velocity += s * velocity;
    n.ecef_R_body = core::exp_so3(s * turn) * n.ecef_R_body;
  }
}

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

OutputRecords::OutputRecords(const Problem& problem, double rate) {
  const ImuPath& path = problem.path;
  const double step = (path.end() - path.begin()) / static_cast<double>(path.imu.size());
  every_ = static_cast<std::uint64_t>(std::max(1.0, std::round(1.0 / (rate * step))));
  if (every_ == 1 || problem.nodes.size() < 2) return;
  before_.assign(problem.nodes.size(), 0);
  core::in_parallel(problem.nodes.size() - 1, intervals_of_a_part, [&](size_t first, size_t last) {
    Increment piece;
    ImuWalk walk(path, problem.nodes[first].time);
    for (size_t k = first; k < last; ++k)
      while (walk.next(problem.nodes[k + 1].time, piece)) before_[k + 1] += at_record(path, walk) ? 1 : 0;
  });
  for (size_t k = 1; k < before_.size(); ++k) before_[k] += before_[k - 1];
}

core::TrajectoryData trajectory_of(const Problem& problem, const std::vector<SmoothedNode>& smoothed, double rate) {
  const std::vector<Node>& nodes = problem.nodes;
  core::TrajectoryData out;
  for (size_t k = 0; k < nodes.size(); ++k) {
    out.covariance.time.push_back(nodes[k].time);
    out.covariance.upper.push_back(smoothed[k].covariance);
  }
  if (nodes.size() < 2) return out;
  const OutputRecords records(problem, rate);
  std::vector<core::TrajectoryData> made(parts_of(nodes.size() - 1));
  core::in_parallel(nodes.size() - 1, intervals_of_a_part, [&](size_t first, size_t last) {
    core::TrajectoryData& mine = made[first / intervals_of_a_part];
    std::vector<NavState> between;
    for (size_t k = first; k < last; ++k) {
      const Covariance a = core::CovarianceSeries::unpack(smoothed[k].covariance),
                       b = core::CovarianceSeries::unpack(smoothed[k + 1].covariance);
      states_between(problem, records, k, smoothed[k].estimate, smoothed[k + 1].estimate.nav, between);
      for (const NavState& n : between) {
        const double s = (n.time - nodes[k].time) / (nodes[k + 1].time - nodes[k].time);
        append(mine, n, (1 - s) * a.diagonal() + s * b.diagonal());
      }
    }
  });
  for (core::TrajectoryData& part : made) {
    append(out, part);
    part = {};
  }
  return out;
}

PoseRecords poses_of(const Problem& problem, const std::vector<Estimate>& estimates, const OutputRecords& records,
                     const std::vector<char>& wanted) {
  if (estimates.size() != problem.nodes.size() || wanted.size() + 1 != estimates.size())
    throw std::logic_error("estimates, intervals and instants do not belong together");
  std::vector<PoseRecords> made(parts_of(wanted.size()));
  core::in_parallel(wanted.size(), intervals_of_a_part, [&](size_t first, size_t last) {
    PoseRecords& mine = made[first / intervals_of_a_part];
    std::vector<NavState> between;
    for (size_t k = first; k < last; ++k) {
      if (!wanted[k]) continue;
      states_between(problem, records, k, estimates[k], estimates[k + 1].nav, between);
      for (const NavState& n : between) {
        mine.time.push_back(n.time);
        mine.position.push_back(n.position);
        mine.ecef_R_body.push_back(n.ecef_R_body);
      }
    }
  });
  size_t size = 0;
  for (const PoseRecords& part : made) size += part.time.size();
  PoseRecords out;
  const auto join = [&](auto column) {
    (out.*column).reserve(size);
    for (PoseRecords& part : made) {
      (out.*column).insert((out.*column).end(), (part.*column).begin(), (part.*column).end());
      part.*column = {};
    }
  };
  join(&PoseRecords::time);
  join(&PoseRecords::position);
  join(&PoseRecords::ecef_R_body);
  return out;
}

}  // namespace swath::trajectory
