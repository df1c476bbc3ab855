// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/ins_output.h"

#include <cmath>

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"

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
  const auto every = static_cast<size_t>(std::max(1.0, std::round(1.0 / (rate * step))));
  constexpr double same = 1e-6;  // s

  std::vector<NavState> between;
  size_t count = 0;
  for (size_t k = 0; k + 1 < nodes.size(); ++k) {
    const Estimate& start = smoothed[k].estimate;
    NavState nav = start.nav;
    ImuWalk walk(path, nodes[k].time);
    between.clear();
    Increment piece;
    while (walk.next(nodes[k + 1].time, piece)) {
      advance(nav, start.corrected(piece));
      nav.time = walk.time();
      const size_t record = walk.record();
      const bool whole = std::abs(walk.time() - path.imu.time[record]) < same;  // not at a cut
      if (whole && !path.is_bridged(record) && count++ % every == 0) between.push_back(nav);
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

}  // namespace swath::trajectory
