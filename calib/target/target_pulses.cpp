// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/target/target_pulses.h"

#include <algorithm>
#include <cmath>

namespace swath::calib {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double margin = 5.0;    // m of surroundings beyond where the target may appear
constexpr double steepest = 2.2;  // tangent of the widest beams: farther targets are out of reach
constexpr size_t sampled = 16;    // every so many returns show the swath's width

class Collector {
 public:
  Collector(const ShotGeometry& geometry, const trajectory::Trajectory& trajectory, const RoofTarget& target, double search, size_t most)
      : geometry_(geometry), cursor_(trajectory), target_(target), centre_(target.centre()), search_(search), most_(most) {
    for (const Vector2d& c : target.corners) radius_ = std::max(radius_, (c - centre_).norm());
  }

  void take(int line, const core::Shots& s) {
    if (out_.lines.empty() || out_.lines.back().line != line) {
      const auto same = std::find_if(out_.lines.begin(), out_.lines.end(), [line](const LinePulses& l) { return l.line == line; });
      if (same == out_.lines.end()) {
        out_.lines.push_back({line, {}, 1});
        seen_.push_back(0);
        at_ = out_.lines.size() - 1;
      } else {
        at_ = static_cast<size_t>(same - out_.lines.begin());
      }
      last_time_ = std::nan("");
    }
    for (size_t i = 0; i < s.size(); ++i) take_return(s, i);
    out_.returns += s.size();
  }
  CollectedPulses result() { return std::move(out_); }

 private:
  void take_return(const core::Shots& s, size_t i) {
    const double forward = s.forward.empty() ? 0.0 : s.forward[i];
    if (!s.return_count.empty() && s.return_count[i] > 1) out_.several_returns = true;
    if (s.time[i] == last_time_ && s.angle[i] == last_angle_ && forward == last_forward_) {
      out_.several_returns = true;
      if (!kept_) return;
      TargetPulses& p = out_.lines[at_].pulses;
      p.last.back() = std::max(p.last.back(), s.range[i]);
      p.first.back() = std::min(p.first.back(), s.range[i]);
      if (p.returns.back() < 255) ++p.returns.back();
      return;
    }
    last_time_ = s.time[i], last_angle_ = s.angle[i], last_forward_ = forward;
    kept_ = false;
    if (!std::isfinite(s.angle[i]) || !std::isfinite(s.range[i]) || s.range[i] <= 0.0 || std::abs(forward) > 1.0) return;
    const double t = geometry_.time(s.time[i]);
    if (!cursor_.seek(t)) {
      ++out_.outside;
      return;
    }
    if (i % sampled == 0) {
      const Vector3d beam = geometry_.beam()(geometry_.angle(s.angle[i]), forward).direction;
      if (beam.z() > 0.1) out_.widest = std::max(out_.widest, std::abs(beam.y() / beam.z()));
    }
    if (cursor_.number() != interval_) {
      interval_ = cursor_.number();
      const Vector3d scanner = local(cursor_.pose(t).position);
      const double height = scanner.z() - target_.up(centre_);
      out_of_reach_ = (scanner.head<2>() - centre_).norm() > steepest * std::abs(height) + radius_ + margin;
    }
    if (out_of_reach_) return;
    const Vector3d p = local(geometry_.ecef_point(cursor_.pose(t), {s.angle[i], forward, s.range[i]}));
    if ((p.head<2>() - centre_).norm() > radius_ + margin + search_ * geometry_.range(s.range[i])) return;
    if (seen_[at_]++ % out_.lines[at_].kept_one_in != 0) return;
    LinePulses& line = out_.lines[at_];
    if (line.pulses.size() >= most_) {
      line.pulses.halve();
      line.kept_one_in *= 2;
    }
    line.pulses.time.push_back(s.time[i]);
    line.pulses.angle.push_back(s.angle[i]);
    line.pulses.forward.push_back(forward);
    line.pulses.first.push_back(s.range[i]);
    line.pulses.last.push_back(s.range[i]);
    line.pulses.returns.push_back(1);
    kept_ = true;
  }
  Vector3d local(const Vector3d& ecef) const { return target_.frame.local_R_ecef * (ecef - target_.frame.origin); }

  const ShotGeometry& geometry_;
  trajectory::Cursor cursor_;
  const RoofTarget& target_;
  Vector2d centre_;
  double search_, radius_ = 0.0;
  size_t most_;
  CollectedPulses out_;
  std::vector<std::uint64_t> seen_;  // pulses near the target, by line
  size_t at_ = 0;
  double last_time_ = std::nan(""), last_angle_ = 0.0, last_forward_ = 0.0;
  bool kept_ = false, out_of_reach_ = false;
  long interval_ = -1;
};

}  // namespace

CollectedPulses collect_pulses(const ShotStream& shots, const ShotGeometry& geometry, const trajectory::Trajectory& trajectory,
                               const RoofTarget& target, double search, size_t most) {
  Collector collector(geometry, trajectory, target, search, most);
  shots([&](int line, const core::Shots& batch) { collector.take(line, batch); });
  return collector.result();
}

}  // namespace swath::calib
