// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/flown_lines.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/frames.h"

namespace swath::calib {
namespace {

constexpr std::uint64_t every = 101;  // returns between two samples of the height: odd, and no divisor of usual scan lengths

}  // namespace

void FlownLines::add(int line, const core::Shots& shots) {
  const auto [at, fresh] = sums_.try_emplace(line);
  Sums& s = at->second;
  trajectory::Cursor cursor(trajectory_);
  for (size_t i = 0; i < shots.size(); ++i) {
    const double t = geometry_.time(shots.time[i]);
    if (s.returns == 0) s.first = s.last = t;
    s.first = std::min(s.first, t);
    s.last = std::max(s.last, t);
    if (s.returns++ % every || !cursor.seek(t)) continue;
    const trajectory::Pose pose = cursor.pose(t);
    const Return r{shots.angle[i], shots.forward.empty() ? 0.0 : shots.forward[i], shots.range[i]};
    const double below = ecef_R_ned_at(pose).col(2).dot(geometry_.ecef_point(pose, r) - pose.position);
    if (!std::isfinite(below)) continue;
    s.height += below;
    ++s.samples;
  }
}

std::vector<FlownLine> FlownLines::lines() const {
  std::vector<FlownLine> out;
  for (const auto& [id, s] : sums_) {
    FlownLine line;
    line.id = id;
    line.first = s.first;
    line.last = s.last;
    line.returns = s.returns;
    line.height = s.height / static_cast<double>(s.samples);
    line.heading = line.speed = line.length = std::numeric_limits<double>::quiet_NaN();
    const auto from = trajectory_.pose_at(s.first), to = trajectory_.pose_at(s.last);
    if (from && to) {
      const Eigen::Vector3d way = ecef_R_ned_at(*from).transpose() * (to->position - from->position);
      line.heading = core::wrap_two_pi(std::atan2(way.y(), way.x()));
      line.length = way.head<2>().norm();
      line.speed = line.length / std::max(1e-9, s.last - s.first);
    }
    out.push_back(line);
  }
  return out;
}

double between_courses(double a, double b) { return std::abs(core::wrap_pi(a - b)); }

}  // namespace swath::calib
