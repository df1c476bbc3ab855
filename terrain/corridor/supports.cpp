// SPDX-License-Identifier: GPL-3.0-or-later
// Two catenaries over one suspension insulator meet at an angle in height of span / a; that gives the support's station to
// sigma_z / (span / a), a few centimetres. At a tension tower the wires end up to an insulator's length before the axis; their
// continuations meet over it, so that the span is counted from axis to axis.
#include "terrain/corridor/supports.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "core/grid.h"

namespace swath::terrain {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double group_cell = 2.0;               // m: returns in neighbouring cells belong together
constexpr size_t fewest_returns = 3;             // of a support
constexpr double level_height = 2.0;             // m
constexpr size_t fewest_levels = 4;              // whose middles' scatter is believed
constexpr double least_axis_sigma = 0.05;        // m, of a support's axis by its returns
constexpr size_t all_round = 20;                 // returns: of fewer, those of one side may be missing
constexpr double full = 0.5;                     // of the larger extent is the smaller one of levels that are seen from all sides
constexpr double slimmest = 0.15, widest = 0.5;  // m: half the width of supports that are seen from one side
constexpr double most_miss = 1.5;                // m
constexpr double overrun = 4.0;                  // m that returns near a curve run on past its support
constexpr double most_sigma = 1.0;               // m
constexpr double least_turn = 0.03;              // rad: below it lines in plan do not say where they cross
constexpr double least_break = 0.01;             // change of slope in height

Meeting by_height(const Strand& a, const Strand& b, double from, double sigma_line) {
  Meeting m;
  m.s = from;
  double rate = 0.0, sb = 0.0;
  const double turn = a.line.along.dot(b.line.along);
  for (int round = 0; round < 20; ++round) {
    sb = b.line.s(a.line.at(m.s));
    rate = a.fit.curve.dz(m.s) - turn * b.fit.curve.dz(sb);
    if (std::abs(rate) < least_break) return {};
    const double step = (a.fit.curve.z(m.s) - b.fit.curve.z(sb)) / rate;
    m.s -= std::clamp(step, -20.0, 20.0);
    if (std::abs(step) < 1e-9) break;
  }
  sb = b.line.s(a.line.at(m.s));
  m.miss = std::abs(b.line.v(a.line.at(m.s)));
  m.sigma =
      std::sqrt(std::pow(a.fit.sigma_z(m.s), 2) + std::pow(b.fit.sigma_z(sb), 2) + sigma_line * sigma_line * unlike_lines(a.fit, b.fit)) /
      std::abs(rate);
  m.found = true;
  return m;
}

Meeting in_plan(const Strand& a, const Strand& b) {
  const double turn = a.line.along.x() * b.line.along.y() - a.line.along.y() * b.line.along.x();
  if (std::abs(turn) < least_turn) return {};
  Meeting m;
  m.in_plan = true;
  m.s = -b.line.v(a.line.from) / (b.line.along.x() * a.line.along.y() - b.line.along.y() * a.line.along.x());
  const double sb = b.line.s(a.line.at(m.s));
  m.miss = std::abs(a.fit.curve.z(m.s) - b.fit.curve.z(sb));
  m.sigma = std::sqrt(a.variance_across(m.s) + b.variance_across(sb)) / std::abs(turn);
  m.found = true;
  return m;
}

/// Variance of the axis behind returns that may show one side of a support: up to half its width, all values alike.
double unseen_variance(const Eigen::Vector2d& extent, const std::vector<Eigen::Vector2d>& levels, size_t returns) {
  Vector2d mean = Vector2d::Zero();
  for (const Vector2d& l : levels) mean += l / static_cast<double>(levels.size());
  if (returns >= all_round && mean.minCoeff() >= full * mean.maxCoeff()) return 0.0;
  const auto n = static_cast<double>(returns);
  const double width = extent.maxCoeff() * (n + 1.0) / (n - 1.0);  // n values spread evenly reach over (n - 1) / (n + 1) of it on average
  return std::pow(std::clamp(0.5 * width, slimmest, widest), 2) / 3.0;
}

}  // namespace

double unlike_lines(const CatenaryFit& a, const CatenaryFit& b) {
  std::map<std::uint16_t, double> more;  // of a than of b
  for (const LineOfFlight& l : a.lines) more[l.line] += l.share;
  for (const LineOfFlight& l : b.lines) more[l.line] -= l.share;
  double out = 0.0;
  for (const auto& [line, share] : more) out += share * share;
  return out;
}

std::vector<TowerGroup> tower_groups(const std::vector<TowerPoint>& points) {
  using Key = std::pair<std::int64_t, std::int64_t>;
  std::map<Key, std::vector<size_t>> cells;
  for (size_t p = 0; p < points.size(); ++p)
    cells[{core::cell_index(points[p].x, group_cell), core::cell_index(points[p].y, group_cell)}].push_back(p);
  std::vector<TowerGroup> out;
  while (!cells.empty()) {
    std::vector<size_t> rows;
    std::vector<Key> front{cells.begin()->first};
    while (!front.empty()) {
      const Key k = front.back();
      front.pop_back();
      const auto at = cells.find(k);
      if (at == cells.end()) continue;
      rows.insert(rows.end(), at->second.begin(), at->second.end());
      cells.erase(at);
      for (std::int64_t dj = -1; dj <= 1; ++dj)
        for (std::int64_t di = -1; di <= 1; ++di) front.emplace_back(k.first + di, k.second + dj);
    }
    if (rows.size() < fewest_returns) continue;
    TowerGroup g;
    g.returns = rows.size();
    g.bottom = std::numeric_limits<double>::infinity();
    g.top = -g.bottom;
    std::map<std::int64_t, Eigen::AlignedBox2d> levels;
    for (const size_t p : rows) {
      g.bottom = std::min(g.bottom, points[p].z);
      g.top = std::max(g.top, points[p].z);
      levels[core::cell_index(points[p].z, level_height)].extend(Vector2d(points[p].x, points[p].y));
    }
    const auto n = static_cast<double>(levels.size());
    Eigen::AlignedBox2d all;
    for (const auto& [level, box] : levels) {
      g.at += box.center() / n;
      all.extend(box);
    }
    for (const auto& [level, box] : levels)
      g.covariance += (box.center() - g.at) * (box.center() - g.at).transpose() / (n * std::max(1.0, n - 1.0));
    // Of few levels the scatter says little: evenly spread over the width.
    if (levels.size() < fewest_levels) g.covariance = (all.sizes().cwiseAbs2() / 12.0).asDiagonal();
    std::vector<Vector2d> extents;
    for (const auto& [level, box] : levels) extents.push_back(box.sizes());
    g.covariance +=
        (least_axis_sigma * least_axis_sigma + unseen_variance(all.sizes(), extents, rows.size())) * Eigen::Matrix2d::Identity();
    out.push_back(g);
  }
  return out;
}

Meeting meeting_of(const Strand& a, bool a_ends_last, const Strand& b, bool b_ends_last, double reach, double sigma_line) {
  const double end_a = a_ends_last ? a.last : a.first, end_b = b_ends_last ? b.last : b.first;
  const auto is_good = [&](const Meeting& m) {
    if (!m.found || m.miss > most_miss || m.sigma > most_sigma) return false;
    const double past_a = a_ends_last ? m.s - end_a : end_a - m.s;
    const double sb = b.line.s(a.line.at(m.s)), past_b = b_ends_last ? sb - end_b : end_b - sb;
    return past_a > -overrun && past_a < reach && past_b > -overrun && past_b < reach;
  };
  const Meeting plan = in_plan(a, b), height = by_height(a, b, 0.5 * (end_a + a.line.s(b.line.at(end_b))), sigma_line);
  if (is_good(plan) && (!is_good(height) || plan.sigma < height.sigma)) return plan;
  return is_good(height) ? height : Meeting{};
}

}  // namespace swath::terrain
