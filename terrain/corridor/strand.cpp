// SPDX-License-Identifier: GPL-3.0-or-later
// A straight line on the map by total least squares, then a catenary over it. Returns beyond 3.5 sigmas of either are left out.
#include "terrain/corridor/strand.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace swath::terrain {
namespace {

using Eigen::Vector2d;

constexpr double off_strand = 3.5;           // sigmas
constexpr double strand_least_sigma = 0.02;  // m: of both, for that
constexpr double sigmas_of_lines = 2;        // what flight lines differ by is no reason to leave returns out

}  // namespace

Strand fit_strand(const std::vector<WirePoint>& points, std::vector<std::uint32_t> rows) {
  Strand out;
  std::sort(rows.begin(), rows.end());
  out.points = std::move(rows);
  const auto n = static_cast<double>(out.points.size());
  if (out.points.size() < 5) return out;
  std::vector<char> used(out.points.size(), 1);
  for (int round = 0; round < 3; ++round) {  // the line in plan, with returns beyond 3.5 sigmas left out
    double count = 0.0, squares = 0.0;
    Vector2d mean = Vector2d::Zero();
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
    const auto each = [&](auto&& f) {
      for (size_t k = 0; k < out.points.size(); ++k)
        if (used[k]) f(Vector2d(points[out.points[k]].x, points[out.points[k]].y));
    };
    each([&](const Vector2d& p) { mean += p, ++count; });
    mean /= count;
    each([&](const Vector2d& p) { spread += (p - mean) * (p - mean).transpose(); });
    const Vector2d along = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).eigenvectors().col(1);
    out.line = {mean, along.x() < 0.0 || (along.x() == 0.0 && along.y() < 0.0) ? Vector2d(-along) : along};
    each([&](const Vector2d& p) { squares += std::pow(out.line.v(p), 2); });
    out.sigma_v = std::sqrt(squares / std::max(1.0, count - 2.0));
    for (size_t k = 0; k < out.points.size(); ++k)
      used[k] = std::abs(out.line.v({points[out.points[k]].x, points[out.points[k]].y})) <=
                off_strand * std::max(strand_least_sigma, out.sigma_v);
    if (count < 0.5 * n) break;
  }
  std::vector<OnWire> on;
  std::vector<std::uint32_t> rest;
  for (size_t k = 0; k < out.points.size(); ++k) {
    const WirePoint& p = points[out.points[k]];
    if (!used[k]) continue;
    on.push_back({out.line.s({p.x, p.y}), p.z, p.line});
    rest.push_back(out.points[k]);
  }
  out.fit = fit_catenary(on);
  out.points.clear();
  out.first = 1e300, out.last = -1e300;
  for (size_t k = 0; k < on.size(); ++k) {  // what lies off the curve is not the strand's: it may have run on across a support
    if (out.fit.found && std::abs(on[k].z - out.fit.curve.z(on[k].s)) >
                             off_strand * std::max(strand_least_sigma, out.fit.sigma) + sigmas_of_lines * out.fit.sigma_lines)
      continue;
    out.points.push_back(rest[k]);
    out.first = std::min(out.first, on[k].s);
    out.last = std::max(out.last, on[k].s);
  }
  double along2 = 0.0;
  for (const OnWire& r : on) along2 += r.s * r.s;
  out.sigma_at_mean = out.sigma_v / std::sqrt(static_cast<double>(std::max<size_t>(1, on.size())));
  out.sigma_turn = out.sigma_v / std::sqrt(std::max(1.0, along2));
  return out;
}

Range range_along(const Strand& a, const Strand& b) {
  const double first = a.line.s(b.line.at(b.first)), last = a.line.s(b.line.at(b.last));
  return {std::min(first, last), std::max(first, last)};
}

std::optional<Strand> fit_as_one(const std::vector<WirePoint>& points, const Strand& a, const Strand& b) {
  std::vector<std::uint32_t> rows = a.points;
  rows.insert(rows.end(), b.points.begin(), b.points.end());
  const size_t all = rows.size();
  Strand both = fit_strand(points, std::move(rows));
  if (!both.fit.found || both.fit.used + all / 20 < all) return std::nullopt;
  return both;
}

}  // namespace swath::terrain
