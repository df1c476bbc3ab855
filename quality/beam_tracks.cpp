// SPDX-License-Identifier: GPL-3.0-or-later
// The line through two returns of a pulse leads to the scanner: with r = (dx, dy) / -dz, the scanner at S + v t and a first return at p,
//   S_xy + v t + r S_z = p_xy + r p_z,
// two equations for each pulse, linear in S and v. The noise of r, that of two places over their distance, makes S_z low by its square over
// that of the scan's own spread, 0.2 % at 3 m: 0.001 of r at the rim of the swath. Weights follow the distance of the two returns.
// All pulses of a few seconds are in one adjustment.
#include "quality/beam_tracks.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/statistics.h"
#include "quality/known_time.h"

namespace swath::quality {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Unknowns = Eigen::Matrix<double, 5, 1>;  // S, v

constexpr double least_span = 3.0;          // m
constexpr size_t fewest_spans = 30;         // pulses
constexpr double uneven = 0.5;              // m, of the aircraft's motion within the window
constexpr double far_off = 4.0;             // sigmas
constexpr double widest_run_sigma = 0.005;  // of a run
constexpr int rounds = 4;

struct Row {
  Vector2d run, right;
  double t, weight;
};

Unknowns solve(const std::vector<Row>& rows, Eigen::Matrix<double, 5, 5>& inverse) {
  Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
  Unknowns right = Unknowns::Zero();
  for (const Row& r : rows)
    for (int a = 0; a < 2; ++a) {
      Unknowns row = Unknowns::Zero();
      row[a] = 1.0, row[2] = r.run[a], row[3 + a] = r.t;
      normal += r.weight * row * row.transpose(), right += r.weight * r.right[a] * row;
    }
  inverse = normal.inverse();
  return inverse * right;
}

}  // namespace

std::vector<PulseReturn> pulse_returns_in(const core::Block& b, size_t own, const std::vector<core::Box>& boxes) {
  std::vector<PulseReturn> out;
  if (b.time.empty() || b.strip.empty() || b.return_number.empty() || b.return_count.empty()) return out;
  for (size_t p = 0; p < own; ++p) {
    if (b.return_count[p] < 2 || !core::is_usable(b, p) || !is_known_time(b.time[p])) continue;
    const Vector3d at = b.origin + Vector3d(b.x[p], b.y[p], b.z[p]);
    if (std::none_of(boxes.begin(), boxes.end(), [&](const core::Box& box) { return box.holds(at.x(), at.y()); })) continue;
    out.push_back({b.time[p], at.x(), at.y(), at.z(), b.strip[p], b.return_number[p]});
  }
  return out;
}

std::vector<PulseSpan> spans_of(std::vector<PulseReturn> returns) {
  const auto pulse = [](const PulseReturn& r) { return std::tuple(r.line, r.time); };
  std::sort(returns.begin(), returns.end(), [&](const PulseReturn& a, const PulseReturn& b) {
    return std::tuple(pulse(a), a.number, a.x, a.y, a.z) < std::tuple(pulse(b), b.number, b.x, b.y, b.z);
  });
  std::vector<PulseSpan> out;
  for (size_t k = 0; k < returns.size();) {
    size_t end = k + 1;
    while (end < returns.size() && pulse(returns[end]) == pulse(returns[k])) ++end;
    const PulseReturn &first = returns[k], &last = returns[end - 1];
    k = end;
    if (!(first.z - last.z >= least_span)) continue;
    out.push_back({first.time, first.x, first.y, first.z, static_cast<float>(last.x - first.x), static_cast<float>(last.y - first.y),
                   static_cast<float>(last.z - first.z), first.line});
  }
  return out;
}

std::optional<ScannerTrack> ScannerTrack::around(double time, const std::vector<PulseSpan>& spans) {
  std::vector<Row> rows;
  Vector3d middle = Vector3d::Zero();
  size_t n = 0;
  for (const PulseSpan& s : spans)
    if (std::abs(s.time - time) <= track_window) middle += Vector3d(s.x, s.y, s.z), ++n;
  if (n < fewest_spans) return std::nullopt;
  middle /= static_cast<double>(n);
  for (const PulseSpan& s : spans) {
    if (std::abs(s.time - time) > track_window) continue;
    const Vector3d p = Vector3d(s.x, s.y, s.z) - middle;
    const auto dz = static_cast<double>(s.dz);
    const Vector2d run(static_cast<double>(s.dx) / -dz, static_cast<double>(s.dy) / -dz);
    rows.push_back({run, p.head<2>() + run * p.z(), s.time - time, dz * dz});
  }
  Eigen::Matrix<double, 5, 5> inverse;
  Unknowns x = Unknowns::Zero();
  double scale = 0.0;
  for (int round = 0; round < rounds; ++round) {
    x = solve(rows, inverse);
    std::vector<double> off;
    for (const Row& r : rows) off.push_back(std::sqrt(r.weight) * (x.head<2>() + r.t * x.tail<2>() + r.run * x[2] - r.right).norm());
    scale = core::median(off) / 1.1774;  // of both components: Rayleigh
    std::vector<Row> kept;
    for (size_t k = 0; k < rows.size(); ++k)
      if (off[k] <= far_off * scale) kept.push_back(rows[k]);
    if (kept.size() == rows.size()) break;
    rows = std::move(kept);
  }
  if (rows.size() < fewest_spans || !(x[2] > 0.0)) return std::nullopt;
  ScannerTrack out;
  out.time_ = time, out.at_ = x.head<3>() + middle, out.speed_ = x.tail<2>();
  const double run = x.head<2>().norm() / x[2];
  const double squares = scale * scale * (0.5 * (inverse(0, 0) + inverse(1, 1)) + run * run * inverse(2, 2)) + uneven * uneven;
  out.sigma_ = std::sqrt(squares) / x[2];
  return out.sigma_ <= widest_run_sigma ? std::optional(out) : std::nullopt;
}

Vector2d ScannerTrack::run(double time, const Vector3d& p) const {
  return (p.head<2>() - at_.head<2>() - (time - time_) * speed_) / (at_.z() - p.z());
}

}  // namespace swath::quality
