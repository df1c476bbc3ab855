// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/cell_planes.h"

#include <algorithm>
#include <cmath>

namespace swath::quality {
namespace {

constexpr double steepest_plane = 1.5;  // rise / run: farther up, a plane of heights says little
constexpr double least_spread = 0.15;   // of a cell, rms about the mean along the worse direction: 0.29 for an even spread
constexpr double farthest = 0.35;       // of a cell, from the mean of the returns to the centre

}  // namespace

void PlaneSums::add(double px, double py, double pz) {
  n += 1, x += px, y += py, z += pz;
  xx += px * px, xy += px * py, yy += py * py;
  xz += px * pz, yz += py * pz, zz += pz * pz;
}

void PlaneSums::add(const PlaneSums& o) {
  n += o.n, x += o.x, y += o.y, z += o.z;
  xx += o.xx, xy += o.xy, yy += o.yy;
  xz += o.xz, yz += o.yz, zz += o.zz;
}

std::optional<CellPlane> plane_of(const PlaneSums& m, double cx, double cy, double cell) {
  const double mx = m.x / m.n, my = m.y / m.n, mz = m.z / m.n;
  const double xx = m.xx / m.n - mx * mx, xy = m.xy / m.n - mx * my, yy = m.yy / m.n - my * my;
  const double half = 0.5 * (xx + yy), narrow = half - std::sqrt(std::max(0.0, half * half - (xx * yy - xy * xy)));
  if (!(narrow > least_spread * least_spread * cell * cell) || std::hypot(mx - cx, my - cy) > farthest * cell) return std::nullopt;
  const double xz = m.xz / m.n - mx * mz, yz = m.yz / m.n - my * mz, zz = m.zz / m.n - mz * mz;
  const double det = xx * yy - xy * xy, bx = (yy * xz - xy * yz) / det, by = (xx * yz - xy * xz) / det;
  if (!(bx * bx + by * by <= steepest_plane * steepest_plane)) return std::nullopt;
  const double rest = std::max(0.0, zz - bx * xz - by * yz) * m.n / (m.n - 3);
  return CellPlane{mz + bx * (cx - mx) + by * (cy - my), std::sqrt(rest), bx, by};
}

double quartile_of(double freedom) {
  constexpr double normal = -0.6745;
  const double part = 2.0 / (9.0 * freedom);
  return std::pow(1.0 - part + normal * std::sqrt(part), 1.5);
}

}  // namespace swath::quality
