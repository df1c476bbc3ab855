// SPDX-License-Identifier: GPL-3.0-or-later
// A wire peaks over its support: one curve through the returns of both sides opens downwards there, or scatters. Where one catenary fits
// both sides as well as each side's own, nothing holds the wire up.
#include "terrain/corridor/passing.h"

#include <algorithm>
#include <cmath>

namespace swath::terrain {
namespace {

using Eigen::Vector2d;

constexpr double at_group = 4.0;  // m along: strands that a support separates end within, before or behind it
constexpr double in_line = 0.02;  // of the gap, across: strands of one wire

/// Whether b begins behind the group where a ends, or ends where a begins, both near its axis: a's and b's wires may be one.
bool faces(const Strand& a, const Strand& b, const Vector2d& group, const StrandOptions& o) {
  const double s = a.line.s(group);
  if (std::abs(a.line.v(group)) > support_beside) return false;
  const auto [low, high] = range_along(a, b);
  const double gap = low > a.last ? low - a.last : a.first - high;
  const bool between = (a.last <= s + at_group && low >= s - at_group) || (high <= s + at_group && a.first >= s - at_group);
  if (!between || gap > o.join) return false;
  return std::abs(a.line.v(b.line.at(0.5 * (b.first + b.last)))) <= o.tube + in_line * (b.length() + std::max(0.0, gap));
}

bool are_one_curve(const std::vector<WirePoint>& points, const Strand& a, const Strand& b) {
  const std::optional<Strand> both = fit_as_one(points, a, b);
  return both && both->fit.curve.kappa > 0.0 && both->fit.sigma <= joint_growth * std::max(a.fit.sigma, b.fit.sigma);
}

}  // namespace

std::vector<char> passed_by_wires(const std::vector<WirePoint>& points, const std::vector<Strand>& strands,
                                  const std::vector<TowerGroup>& groups, const StrandOptions& o) {
  std::vector<char> out(groups.size(), 0);
  for (size_t g = 0; g < groups.size(); ++g) {
    int run_on = 0, broken = 0;
    for (size_t i = 0; i < strands.size(); ++i)
      for (size_t j = i + 1; j < strands.size(); ++j)
        if (faces(strands[i], strands[j], groups[g].at, o)) ++(are_one_curve(points, strands[i], strands[j]) ? run_on : broken);
    out[g] = run_on > broken;
  }
  return out;
}

}  // namespace swath::terrain
