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

std::uint64_t records_between(const Problem& problem, size_t first, size_t last) {
  std::uint64_t count = 0;
  Increment piece;
  ImuWalk walk(problem.path, problem.nodes[first].time);
  for (size_t k = first; k < last; ++k)
    while (walk.next(problem.nodes[k + 1].time, piece)) count += at_record(problem.path, walk) ? 1 : 0;
  return count;
}

/// Intervals [first, last) between nodes; `count`: records before them, of which every so many are taken.
core::TrajectoryData part_of(const Problem& problem, const std::vector<SmoothedNode>& smoothed, size_t first, size_t last,
                             std::uint64_t count, std::uint64_t every) {
  const std::vector<Node>& nodes = problem.nodes;
  core::TrajectoryData out;
  std::vector<NavState> between;
  for (size_t k = first; k < last; ++k) {
    const Estimate& start = smoothed[k].estimate;
    NavState nav = start.nav;
    ImuWalk walk(problem.path, nodes[k].time);
    between.clear();
    Increment piece;
    while (walk.next(nodes[k + 1].time, piece)) {
      advance(nav, start.corrected(piece));
      nav.time = walk.time();
      if (at_record(problem.path, walk) && count++ % every == 0) between.push_back(nav);
    }
    const NavState& next = smoothed[k + 1].estimate.nav;
    const double length = nodes[k + 1].time - nodes[k].time;
    const Vector3d position = next.position - nav.position, velocity = next.velocity - nav.velocity;
    const Vector3d turn = core::log_so3(next.ecef_R_body * nav.ecef_R_body.transpose());
    const auto a = core::CovarianceSeries::unpack(smoothed[k].covariance), b = core::CovarianceSeries::unpack(smoothed[k + 1].covariance);
    for (NavState& n : between) {
      const double s = (n.time - nodes[k].time) / length;
      n.position += (3 - 2 * s) * s * s * position + (s - 1) * s * s * length * velocity;
      n.velocity += s * velocity;
      n.ecef_R_body = core::exp_so3(s * turn) * n.ecef_R_body;
      append(out, n, (1 - s) * a.diagonal() + s * b.diagonal());
    }
  }
  return out;
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

core::TrajectoryData trajectory_of(const Problem& problem, const std::vector<SmoothedNode>& smoothed, double rate) {
  const ImuPath& path = problem.path;
  const std::vector<Node>& nodes = problem.nodes;
  core::TrajectoryData out;
  for (size_t k = 0; k < nodes.size(); ++k) {
    out.covariance.time.push_back(nodes[k].time);
    out.covariance.upper.push_back(smoothed[k].covariance);
  }
  const double step = (path.end() - path.begin()) / static_cast<double>(path.imu.size());
  const auto every = static_cast<std::uint64_t>(std::max(1.0, std::round(1.0 / (rate * step))));
  const size_t intervals = nodes.empty() ? 0 : nodes.size() - 1, parts = (intervals + intervals_of_a_part - 1) / intervals_of_a_part;
  std::vector<std::uint64_t> before(parts + 1, 0);  // records before each part
  if (every > 1) {
    core::in_parallel(intervals, intervals_of_a_part,
                      [&](size_t first, size_t last) { before[first / intervals_of_a_part + 1] = records_between(problem, first, last); });
    for (size_t p = 0; p < parts; ++p) before[p + 1] += before[p];
  }
  std::vector<core::TrajectoryData> made(parts);
  core::in_parallel(intervals, intervals_of_a_part, [&](size_t first, size_t last) {
    const size_t p = first / intervals_of_a_part;
    made[p] = part_of(problem, smoothed, first, last, before[p], every);
  });
  for (core::TrajectoryData& part : made) {
    append(out, part);
    part = {};
  }
  return out;
}

}  // namespace swath::trajectory
