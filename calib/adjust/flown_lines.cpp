// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/flown_lines.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geo/frames.h"
#include "core/statistics.h"

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
    const double range = shots.range[i];
    if (range == s.range) ++s.repeated;
    if (range > s.longest) {
      s.longest = range;
      s.at_limit = 0;
    }
    if (range == s.longest) ++s.at_limit;
    s.range = range;
    if (s.returns++ % every || !cursor.seek(t)) continue;
    const trajectory::Pose pose = cursor.pose(t);
    const Return r{shots.angle[i], shots.forward.empty() ? 0.0 : shots.forward[i], range};
    const Eigen::Vector3d ned = ecef_R_ned_at(pose).transpose() * (geometry_.ecef_point(pose, r) - pose.position);
    if (!ned.allFinite()) continue;
    s.height += ned.z();
    s.aside = std::max(s.aside, ned.head<2>().norm());
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
    line.width = 2 * s.aside;
    line.repeated = static_cast<double>(s.repeated) / static_cast<double>(s.returns);
    line.at_limit = static_cast<double>(s.at_limit) / static_cast<double>(s.returns);
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

double side_for(const std::vector<FlownLine>& lines, double returns) {
  std::vector<double> sides;
  for (const FlownLine& l : lines)
    if (l.returns > 0 && l.width > 0.05 * l.height && l.length > 0)
      sides.push_back(std::sqrt(returns * l.length * l.width / static_cast<double>(l.returns)));
  return core::median(std::move(sides), 0.0);
}

std::vector<Finding> check_lines(const std::vector<FlownLine>& lines) {
  constexpr double most_repeated = 0.5, most_at_limit = 0.05;
  constexpr double most_shared = 0.1;  // of the shorter line's time
  std::vector<Finding> out;
  const auto share = [](double v) { return std::to_string(static_cast<int>(std::lround(100 * v))) + " %"; };
  for (const FlownLine& l : lines) {
    const std::string name = "line " + std::to_string(l.id);
    if (l.at_limit > most_at_limit && l.at_limit < 1 - most_at_limit)
      out.push_back({name + ": " + share(l.at_limit) + " of the ranges have one and the same largest value: the ranges are saturated",
                     "leave those records out: they were no echoes of the ground",
                     {},
                     true});
    else if (l.repeated > most_repeated)
      out.push_back({name + ": " + share(l.repeated) + " of the ranges repeat the one before: the ranges are constant",
                     "check the column and the unit of the ranges",
                     {},
                     true});
    if (!std::isfinite(l.height))
      out.push_back(
          {name + " lies outside the trajectory", "compare the time scales of laser and trajectory with `swath info`", {}, false});
  }
  for (size_t a = 0; a < lines.size(); ++a)
    for (size_t b = a + 1; b < lines.size(); ++b) {
      const double shared = std::min(lines[a].last, lines[b].last) - std::max(lines[a].first, lines[b].first);
      const double shorter = std::min(lines[a].last - lines[a].first, lines[b].last - lines[b].first);
      if (shared > most_shared * shorter && shared > 0)
        out.push_back({"lines " + std::to_string(lines[a].id) + " and " + std::to_string(lines[b].id) + " lie in one another in time",
                       "their numbers are mixed: see the column `line` of the laser records and the [[line]] tables of survey.toml",
                       {},
                       false});
    }
  return out;
}

}  // namespace swath::calib
