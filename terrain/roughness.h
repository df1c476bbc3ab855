// SPDX-License-Identifier: GPL-3.0-or-later
// How rough a TIN's terrain and points are, estimated from the points themselves.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/grid.h"
#include "terrain/tin/tin.h"

namespace swath::terrain {

/// How far a place lies from a triangle's vertices as interpolation sees it, m^2: with barycentric weights w of the place q and the tensor
/// M = sum w_k (p_k - q)(p_k - q)^T, the root of (tr M)^2 + 2 |M|^2. A surface of Hessian H misses its plane by tr(H M) / 2, whose mean
/// square over Gaussian isotropic terrain is proportional to the square of this.
double reach_of(const Tin& tin, std::int32_t triangle, const std::array<double, 3>& w, double x, double y);

/// Expected square of the misfit between a place and the plane of a triangle near it: noise (1 + w.w) + uneven s + curved s^2 / 4, s =
/// reach_of.
struct Roughness {
  double noise = 0.0;   ///< m^2: variance of a point's own error, of that part which its neighbours do not share
  double uneven = 0.0;  ///< m^2 per m^2: terrain whose misfit grows with distance
  double curved = 0.0;  ///< 1/m^2: square of the terrain's curvature, as s weighs it
  bool known = false;
};

/// Roughness on blocks of an absolute lattice, each with its eight neighbours, blended between the blocks' centres.
class RoughnessMap {
 public:
  /// From all pairs of neighbouring triangles within `reach(side)` of the window; edges held by constraints do not count.
  RoughnessMap(const Tin& tin, const Eigen::Vector3d& origin, const core::Lattice& window, double side);
  /// At a place of the Block's frame within the window.
  Roughness at(double x, double y) const;
  /// Metres around a window from which pairs are taken.
  static double reach(double side) { return 2.5 * side; }

 private:
  core::Lattice blocks_;
  Eigen::Vector3d origin_;
  std::vector<Roughness> fitted_;
};

}  // namespace swath::terrain
