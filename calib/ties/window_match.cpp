// SPDX-License-Identifier: GPL-3.0-or-later
// Source: least-squares matching of surfaces (Maas, "Least-squares matching with airborne laserscanning data in a TIN structure", 2000) on
// cells. Deviations: every whole shift is tried in place of a gradient's descent, because boresights of half a degree put houses beside
// their own images; differences are bounded (Geman-McClure), because trees and walls differ between lines whatever the shift.
#include "calib/ties/window_match.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/statistics.h"

namespace swath::calib {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double bound = 1.5;         // m: a difference counts as this at most
constexpr double seen_cells = 0.4;    // of a window that a line must have seen
constexpr double shared_cells = 0.3;  // of a window that both lines must have seen
constexpr double independence = 0.2;  // share of the cells whose misfits are independent: neighbours see the same roof edge
constexpr double locking = 0.07;      // cells: what the quadric leaves of the true place between whole shifts
constexpr double rise_floor = 0.05;   // m: what errors of range and scan scale make of heights

// Plane through values at (x, y), by sums.
struct PlaneSums {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0, d = 0, dx = 0, dy = 0;
  void add(double px, double py, double v, double w = 1.0) {
    const double wx = w * px, wy = w * py;
    n += w, x += wx, y += wy, xx += wx * px, xy += wx * py, yy += wy * py, d += w * v, dx += wx * v, dy += wy * v;
  }
  Vector3d solve() const {
    Matrix3d N;
    N << n, x, y, x, xx, xy, y, xy, yy;
    return N.ldlt().solve(Vector3d(d, dx, dy));
  }
};

}  // namespace

std::optional<Relief> relief_of(const Raster& r) {
  PlaneSums s;
  for (int y = 0; y < r.ny; ++y)
    for (int x = 0; x < r.nx; ++x)
      if (const float z = r.z[static_cast<size_t>(y * r.nx + x)]; !std::isnan(z)) s.add(x, y, static_cast<double>(z));
  if (s.n < seen_cells * r.nx * r.ny || s.n < 12.0) return std::nullopt;
  const Vector3d plane = s.solve();
  const auto residual = [&](int x, int y) {
    return static_cast<double>(r.z[static_cast<size_t>(y * r.nx + x)]) - plane[0] - plane[1] * x - plane[2] * y;
  };
  double squares = 0.0, m = 0.0, sum = 0.0, n = 0.0;
  for (int y = 0; y + 2 < r.ny; ++y)
    for (int x = 0; x + 2 < r.nx; ++x) {
      const double here = residual(x, y), east = residual(x + 2, y), north = residual(x, y + 2);
      if (std::isnan(here)) continue;
      squares += here * here, m += 1.0;
      if (!std::isnan(east)) sum += here * east, n += 1.0;
      if (!std::isnan(north)) sum += here * north, n += 1.0;
    }
  if (m == 0.0 || n == 0.0) return std::nullopt;
  return Relief{std::sqrt(squares / m), std::sqrt(std::max(sum / n, 0.0))};
}

std::optional<ShiftFit> fit_shift(const Raster& a, const Raster& b, int margin_x, int margin_y, int shift_x, int shift_y, int refits) {
  const double mx = 0.5 * (a.nx - 1), my = 0.5 * (a.ny - 1);
  const auto for_each_difference = [&](auto&& f) {
    for (int y = 0; y < a.ny; ++y) {
      const float* za = a.z.data() + static_cast<size_t>(y) * static_cast<size_t>(a.nx);
      const float* zb = b.z.data() + static_cast<size_t>(y + margin_y + shift_y) * static_cast<size_t>(b.nx) + (margin_x + shift_x);
      for (int x = 0; x < a.nx; ++x) {
        const auto d = static_cast<double>(zb[x] - za[x]);
        if (!std::isnan(d)) f(x - mx, y - my, d);
      }
    }
  };
  PlaneSums s;
  for_each_difference([&](double x, double y, double d) { s.add(x, y, d); });
  const double cells = s.n;
  if (cells < shared_cells * a.nx * a.ny || cells < 12.0) return std::nullopt;
  Vector3d plane = s.solve();
  for (int k = 0; k < refits; ++k) {
    PlaneSums again;
    for_each_difference([&](double x, double y, double d) {
      const double r = (d - plane[0] - plane[1] * x - plane[2] * y) / bound, w = 1.0 / (1.0 + r * r);
      again.add(x, y, d, w * w);
    });
    plane = again.solve();
  }
  double cost = 0.0;
  for_each_difference([&](double x, double y, double d) {
    const double r = d - plane[0] - plane[1] * x - plane[2] * y, r2 = r * r;
    cost += r2 / (1.0 + r2 / (bound * bound));
  });
  return ShiftFit{static_cast<int>(cells), cost / cells, plane[0]};
}

double ShiftCosts::operator()(double x, double y) const {
  const double fx = std::floor(x), fy = std::floor(y);
  if (!(fx >= -margin_x && fy >= -margin_y && fx < margin_x && fy < margin_y)) return 1.0;
  const int ix = static_cast<int>(fx), iy = static_cast<int>(fy);
  const double u = x - fx, v = y - fy;
  const auto q = [&](int i, int j) { return static_cast<double>(share[at(i, j)]); };
  return (1 - v) * ((1 - u) * q(ix, iy) + u * q(ix + 1, iy)) + v * ((1 - u) * q(ix, iy + 1) + u * q(ix + 1, iy + 1));
}

ShiftCosts shift_costs(const Raster& a, const Raster& b, int margin_x, int margin_y, const std::vector<char>& wanted) {
  ShiftCosts out{margin_x, margin_y, {}, 0.0};
  out.share.assign(static_cast<size_t>((2 * margin_x + 1) * (2 * margin_y + 1)), -1.0f);
  std::vector<double> costs;
  for (int y = -margin_y; y <= margin_y; ++y)
    for (int x = -margin_x; x <= margin_x; ++x) {
      if (!wanted.empty() && !wanted[out.at(x, y)]) continue;
      if (const auto f = fit_shift(a, b, margin_x, margin_y, x, y)) {
        out.share[out.at(x, y)] = static_cast<float>(f->cost);
        costs.push_back(f->cost);
      }
    }
  out.typical = core::median(std::move(costs), 0.0);
  for (float& s : out.share) s = s >= 0.0f && out.typical > 0.0 ? static_cast<float>(static_cast<double>(s) / out.typical) : 1.0f;
  return out;
}

std::optional<SubcellShift> subcell_shift(const Raster& a, const Raster& b, const ShiftCosts& costs, const Vector2d& near, int reach) {
  const int cx = static_cast<int>(std::lround(near.x())), cy = static_cast<int>(std::lround(near.y()));
  int bx = 0, by = 0;
  double lowest = 1e30;
  for (int y = std::max(cy - reach, -costs.margin_y); y <= std::min(cy + reach, costs.margin_y); ++y)
    for (int x = std::max(cx - reach, -costs.margin_x); x <= std::min(cx + reach, costs.margin_x); ++x)
      if (const double q = static_cast<double>(costs.share[costs.at(x, y)]); q < lowest) lowest = q, bx = x, by = y;
  if (lowest > 1e29 || std::abs(bx - cx) == reach || std::abs(by - cy) == reach) return std::nullopt;
  if (std::abs(bx) >= costs.margin_x || std::abs(by) >= costs.margin_y) return std::nullopt;

  // cost = q0 + gx x + gy y + hxx x^2 / 2 + hxy x y + hyy y^2 / 2 over the nine, by least squares; the rise as a plane.
  double cost[3][3], mean = 0, gx = 0, gy = 0, sxx = 0, syy = 0, hxy = 0, rise = 0, rx = 0, ry = 0;
  int cells = 0;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      const auto f = fit_shift(a, b, costs.margin_x, costs.margin_y, bx + x, by + y, 3);
      if (!f) return std::nullopt;
      const double c = f->cost;
      cost[y + 1][x + 1] = c;
      mean += c / 9.0, gx += c * x / 6.0, gy += c * y / 6.0, sxx += c * x * x, syy += c * y * y, hxy += c * x * y / 4.0;
      rise += f->rise / 9.0, rx += f->rise * x / 6.0, ry += f->rise * y / 6.0;
      if (x == 0 && y == 0) cells = f->cells;
    }
  const double hxx = sxx - 6.0 * mean, hyy = syy - 6.0 * mean;
  Matrix2d H;
  H << hxx, hxy, hxy, hyy;
  const Eigen::SelfAdjointEigenSolver<Matrix2d> e(H);
  const double noise = std::max(cost[1][1], 1e-6), n = independence * cells;
  if (e.eigenvalues()[1] <= 0.0) return std::nullopt;
  // Along a direction without relief the shift stays in the middle, with a large variance.
  SubcellShift out;
  Vector2d offset = Vector2d::Zero();
  out.covariance = locking * locking * Matrix2d::Identity();
  for (int k = 0; k < 2; ++k) {
    const Vector2d axis = e.eigenvectors().col(k);
    const double curve = std::max(e.eigenvalues()[k], 1e-9), variance = 2.0 * noise / (n * curve);
    if (variance < 1.0) offset += axis * std::clamp(-axis.dot(Vector2d(gx, gy)) / curve, -1.5, 1.5);
    out.covariance += std::min(variance < 1.0 ? variance : variance + 1.0, 1e6) * axis * axis.transpose();
  }
  out.shift = Vector2d(bx, by) + offset;
  out.rise = rise + rx * offset.x() + ry * offset.y();
  out.rise_variance = noise / n + rise_floor * rise_floor;
  out.share = costs.typical > 0.0 ? cost[1][1] / costs.typical : 1.0;
  return out;
}

}  // namespace swath::calib
