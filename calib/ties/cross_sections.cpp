// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/cross_sections.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace swath::calib {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double beyond = 10.0;  // m
constexpr double apart = 60.0;   // m

/// A direction in the local frame in which a cut shows most.
Vector3d direction_of(const TiePlane& plane) {
  constexpr double level = 0.05;  // sine of the slope
  const auto axes = plane_axes(plane.normal);
  if (plane.normal.head<2>().norm() > level) return axes[1];
  return plane.half.x() >= plane.half.y() ? axes[0] : axes[1];
}

double half_length(const TiePlane& plane, const Vector3d& direction) {
  const auto axes = plane_axes(plane.normal);
  return std::abs(direction.dot(axes[0])) > 0.5 ? plane.half.x() : plane.half.y();
}

}  // namespace

std::vector<SectionPlan> plan_sections(const TieSet& ties, const MapPatches& map, double unit, size_t most) {
  std::vector<std::set<std::uint32_t>> seen(ties.planes.size());
  for (const TieGroup& g : ties.groups) seen[g.plane].insert(g.line);
  std::vector<size_t> order;
  for (size_t k = 0; k < ties.planes.size(); ++k)
    if (ties.planes[k].kind == TieKind::roof || (ties.planes[k].kind == TieKind::target && ties.planes[k].half.maxCoeff() > 4.0))
      order.push_back(k);
  const auto rank = [&](size_t k) {
    const TiePlane& p = ties.planes[k];
    return std::tuple(p.kind != TieKind::target, -static_cast<double>(seen[k].size()) * p.normal.head<2>().norm(), k);
  };
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return rank(a) < rank(b); });

  std::vector<SectionPlan> out;
  std::vector<Vector3d> taken;
  for (const size_t k : order) {
    const TiePlane& p = ties.planes[k];
    if (out.size() == most) break;
    if (std::any_of(taken.begin(), taken.end(), [&](const Vector3d& t) { return (t - p.centre).norm() < apart; })) continue;
    const Vector3d along = direction_of(p), step = (half_length(p, along) + beyond) * along;
    const auto on_map = [&](const Vector3d& local) -> Vector2d { return unit * map(ties.frame.to_ecef(local)).head<2>(); };
    SectionPlan plan;
    plan.name = p.name.empty() ? std::string(name_of(p.kind)) + " " + std::to_string(k + 1) : p.name;
    plan.ends = {on_map(p.centre - step), on_map(p.centre + step)};
    out.push_back(std::move(plan));
    taken.push_back(p.centre);
  }
  return out;
}

void SectionReturns::add(int line, const core::Block& b) {
  for (size_t k = 0; k < plans_.size(); ++k) {
    const Vector2d way = plans_[k].ends[1] - plans_[k].ends[0];
    const double length = way.norm();
    const Vector2d along = way / length, across(-along.y(), along.x());
    const Vector2d from = plans_[k].ends[0] - b.origin.head<2>();
    OfLine* kept = nullptr;
    for (size_t i = 0; i < b.size(); ++i) {
      const Vector2d d = Vector2d(b.x[i], b.y[i]) - from;
      if (std::abs(across.dot(d)) > 0.5 * plans_[k].width) continue;
      const double at = along.dot(d);
      if (at < 0 || at > length) continue;
      if (!kept) kept = &returns_[k][line];
      if (kept->along.size() >= most_of_line) break;
      kept->along.push_back(at);
      kept->height.push_back(b.z[i] + b.origin.z());
    }
  }
}

}  // namespace swath::calib
