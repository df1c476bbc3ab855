// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/roof_returns.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <tuple>

#include "quality/known_time.h"

namespace swath::quality {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double farthest_from_plane = 60.0;  // m above or below the plane
constexpr float not_known = std::numeric_limits<float>::quiet_NaN();
constexpr double flattest = 2.0;  // m that a beam runs for each metre it comes down

/// Twice the area that the corners go around counter-clockwise.
double turn_of(const std::vector<Vector3d>& corners) {
  double sum = 0.0;
  for (size_t k = 0; k < corners.size(); ++k) {
    const Vector2d a = (corners[k] - corners[0]).head<2>(), b = (corners[(k + 1) % corners.size()] - corners[0]).head<2>();
    sum += a.x() * b.y() - a.y() * b.x();
  }
  return sum;
}

bool is_inside(const std::vector<RoofSide>& sides, const Vector2d& p) {
  bool in = false;
  for (size_t k = 0; k < sides.size(); ++k) {
    const Vector2d &a = sides[k].from, &b = sides[(k + 1) % sides.size()].from;
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) in = !in;
  }
  return in;
}

/// A target as the returns are compared with it.
struct At {
  RoofPlane plane;
  std::vector<RoofSide> sides;
  Vector2d low, high;  // m from the first corner
  explicit At(const RoofTarget& t) : plane(t), sides(sides_of(t)), low(Vector2d::Zero()), high(Vector2d::Zero()) {
    for (const RoofSide& s : sides) low = low.cwiseMin(s.from), high = high.cwiseMax(s.from);
    low.array() -= roof_band, high.array() += roof_band;
  }
  bool holds(const Vector2d& p, double around = roof_band) const {
    const double more = around - roof_band;
    if ((p.array() < low.array() - more).any() || (p.array() > high.array() + more).any()) return false;
    return place_at(sides, p).out <= around;
  }
};

std::tuple<std::int32_t, std::int32_t, double> pulse_of(const RoofReturn& r) { return {r.target, r.line, r.time}; }

/// By target, line and time, whatever the order before.
void sort_returns(std::vector<RoofReturn>& returns) {
  std::sort(returns.begin(), returns.end(), [](const RoofReturn& a, const RoofReturn& b) {
    return std::tuple(pulse_of(a), a.number, a.x, a.y, a.above) < std::tuple(pulse_of(b), b.number, b.x, b.y, b.above);
  });
}

}  // namespace

std::vector<RoofSide> sides_of(const RoofTarget& t) {
  const double turn = turn_of(t.corners) >= 0.0 ? 1.0 : -1.0;
  const size_t n = t.corners.size();
  std::vector<RoofSide> out;
  for (size_t k = 0; k < n; ++k) {
    const Vector2d a = (t.corners[k] - t.corners[0]).head<2>(), d = (t.corners[(k + 1) % n] - t.corners[k]).head<2>();
    const Vector2d along = d.norm() > 0.0 ? Vector2d(d.normalized()) : Vector2d(1.0, 0.0);
    out.push_back({a, along, turn * Vector2d(along.y(), -along.x()), d.norm()});
  }
  return out;
}

PlaceAtRoof place_at(const std::vector<RoofSide>& sides, const Vector2d& at) {
  PlaceAtRoof best;
  double nearest = std::numeric_limits<double>::infinity();
  for (size_t k = 0; k < sides.size(); ++k) {
    const double along = sides[k].along.dot(at - sides[k].from);
    const double d = (at - sides[k].from - std::clamp(along, 0.0, sides[k].length) * sides[k].along).norm();
    if (d < nearest) nearest = d, best = {k, d, std::min(along, sides[k].length - along)};
  }
  if (is_inside(sides, at)) best.out = -best.out;
  return best;
}

RoofPlane::RoofPlane(const RoofTarget& t) {
  Vector3d middle = Vector3d::Zero();
  for (const Vector3d& c : t.corners) middle += (c - t.corners[0]) / static_cast<double>(t.corners.size());
  Eigen::Matrix2d a = Eigen::Matrix2d::Zero();
  Vector2d r = Vector2d::Zero();
  for (const Vector3d& c : t.corners) {
    const Vector3d d = c - t.corners[0] - middle;
    a += d.head<2>() * d.head<2>().transpose();
    r += d.head<2>() * d.z();
  }
  slope = a.fullPivLu().solve(r);
  height = t.corners[0].z() + middle.z() - slope.dot(middle.head<2>());
}

Vector2d crossing_of(const RoofReturn& r, const RoofPlane& plane, double raise) {
  const Vector2d run(static_cast<double>(r.run_x), static_cast<double>(r.run_y));
  const double up = (raise - static_cast<double>(r.above)) / (1.0 + plane.slope.dot(run));
  return Vector2d(static_cast<double>(r.x), static_cast<double>(r.y)) - up * run;
}

core::Box reach_of(const RoofTarget& target) {
  const Vector3d& first = target.corners.front();
  core::Box out{first.x(), first.y(), first.x(), first.y()};
  for (const Vector3d& c : target.corners)
    out = {std::min(out.x0, c.x()), std::min(out.y0, c.y()), std::max(out.x1, c.x()), std::max(out.y1, c.y())};
  return out.grown(flattest * farthest_from_plane + roof_band);
}

bool is_near(const RoofTarget& target, const core::Box& box) {
  const core::Box reach = reach_of(target);
  return reach.x0 < box.x1 && box.x0 <= reach.x1 && reach.y0 < box.y1 && box.y0 <= reach.y1;
}

std::vector<RoofReturn> returns_at_roofs(const core::Block& b, size_t own, const std::vector<Vector3d>& scanner,
                                         const std::vector<RoofTarget>& targets) {
  std::vector<RoofReturn> found;
  if (b.time.empty() || b.strip.empty()) return found;
  for (size_t t = 0; t < targets.size(); ++t) {
    const At at(targets[t]);
    const Vector3d first = targets[t].corners[0];
    const Vector2d low = at.low.array() - flattest * farthest_from_plane, high = at.high.array() + flattest * farthest_from_plane;
    for (size_t p = 0; p < own; ++p) {
      const Vector3d place = b.origin + Vector3d(b.x[p], b.y[p], b.z[p]);
      const Vector2d here = (place - first).head<2>();
      if ((here.array() < low.array()).any() || (here.array() > high.array()).any() || !core::is_usable(b, p)) continue;
      const double above = place.z() - at.plane.at(here);
      if (std::abs(above) > farthest_from_plane) continue;
      RoofReturn r{static_cast<std::int32_t>(t),
                   b.strip[p],
                   b.time[p],
                   static_cast<float>(here.x()),
                   static_cast<float>(here.y()),
                   static_cast<float>(above),
                   not_known,
                   not_known,
                   b.return_number.empty() ? 0 : b.return_number[p]};
      if (scanner.empty()) {
        if (at.holds(here, roof_band + beside_roof)) found.push_back(r);
        continue;
      }
      const Vector3d beam = Vector3d(b.x[p], b.y[p], b.z[p]) - scanner[p];
      const Vector2d run = beam.head<2>() / -beam.z();
      if (!(beam.z() < 0.0) || !(run.norm() < flattest)) continue;
      r.run_x = static_cast<float>(run.x()), r.run_y = static_cast<float>(run.y());
      if (at.holds(here) || at.holds(crossing_of(r, at.plane, 0.0))) found.push_back(r);
    }
  }
  return found;
}

std::vector<double> find_runs(std::vector<RoofReturn>& returns, const std::vector<PulseSpan>& spans,
                              const std::vector<RoofTarget>& targets) {
  // A line may pass a target several times, or slowly: slices of its time have a track each.
  using Pass = std::tuple<std::int32_t, std::int32_t, std::int64_t>;  // target, line, slice
  const auto pass_of = [](const RoofReturn& r) {
    return Pass(r.target, r.line, static_cast<std::int64_t>(std::floor(r.time / track_window)));
  };
  std::erase_if(returns, [](const RoofReturn& r) { return !is_known_time(r.time); });
  sort_returns(returns);
  std::map<std::int32_t, std::vector<PulseSpan>> by_line;
  for (const PulseSpan& s : spans) by_line[s.line].push_back(s);
  struct Times {
    double sum = 0.0, n = 0.0;
  };
  std::map<Pass, Times> times;
  for (const RoofReturn& r : returns) times[pass_of(r)].sum += r.time, ++times[pass_of(r)].n;
  std::map<Pass, ScannerTrack> tracks;
  std::vector<double> squares(targets.size(), 0.0), n(targets.size(), 0.0);
  for (const auto& [pass, t] : times) {
    const auto target = static_cast<size_t>(std::get<0>(pass));
    const core::Box reach = reach_of(targets[target]);
    std::vector<PulseSpan> near;
    for (const PulseSpan& s : by_line[std::get<1>(pass)])
      if (reach.holds(s.x, s.y)) near.push_back(s);
    const auto track = ScannerTrack::around(t.sum / t.n, near);
    if (!track) continue;
    tracks.emplace(pass, *track);
    squares[target] += t.n * track->run_sigma() * track->run_sigma(), n[target] += t.n;
  }
  std::vector<RoofPlane> planes(targets.begin(), targets.end());
  std::erase_if(returns, [&](RoofReturn& r) {
    const auto track = tracks.find(pass_of(r));
    if (track == tracks.end()) return true;
    const auto target = static_cast<size_t>(r.target);
    const Vector2d at(static_cast<double>(r.x), static_cast<double>(r.y));
    const Vector2d place = targets[target].corners[0].head<2>() + at;
    const Vector2d run = track->second.run(r.time, {place.x(), place.y(), planes[target].at(at) + static_cast<double>(r.above)});
    r.run_x = static_cast<float>(run.x()), r.run_y = static_cast<float>(run.y());
    return !(run.norm() < flattest);
  });
  for (size_t t = 0; t < targets.size(); ++t) squares[t] = n[t] > 0.0 ? std::sqrt(squares[t] / n[t]) : 0.0;
  return squares;
}

std::vector<RoofReturn> first_of_pulses(std::vector<RoofReturn> returns) {
  sort_returns(returns);
  returns.erase(std::unique(returns.begin(), returns.end(), [](const auto& a, const auto& b) { return pulse_of(a) == pulse_of(b); }),
                returns.end());
  return returns;
}

}  // namespace swath::quality
