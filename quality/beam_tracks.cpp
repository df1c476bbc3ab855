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

std::vector<PulseSpan> spans_in(const core::Block& b, size_t own, const core::Box& box) {
  std::vector<PulseSpan> out;
  if (b.time.empty() || b.strip.empty() || b.return_number.empty() || b.return_count.empty()) return out;
  std::vector<size_t> rows;
  for (size_t p = 0; p < own; ++p)
    if (b.return_count[p] > 1 && core::is_usable(b, p) && box.holds(b.origin.x() + b.x[p], b.origin.y() + b.y[p])) rows.push_back(p);
  const auto pulse = [&](size_t p) { return std::tuple(b.strip[p], b.time[p]); };
  std::sort(rows.begin(), rows.end(),
            [&](size_t p, size_t q) { return std::tuple(pulse(p), b.return_number[p]) < std::tuple(pulse(q), b.return_number[q]); });
  for (size_t k = 0; k < rows.size();) {
    size_t end = k + 1;
    while (end < rows.size() && pulse(rows[end]) == pulse(rows[k])) ++end;
    const size_t p = rows[k], q = rows[end - 1];
    k = end;
    if (!(b.z[p] - b.z[q] >= least_span)) continue;
    out.push_back({b.time[p], b.origin.x() + b.x[p], b.origin.y() + b.y[p], b.origin.z() + b.z[p], static_cast<float>(b.x[q] - b.x[p]),
                   static_cast<float>(b.y[q] - b.y[p]), static_cast<float>(b.z[q] - b.z[p]), b.strip[p]});
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
