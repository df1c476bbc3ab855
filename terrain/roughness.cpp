// SPDX-License-Identifier: GPL-3.0-or-later
// Every edge of the TIN is an experiment: the vertex beyond it against the plane on this side. Its misfit has the same form as the error of
// interpolation within the triangle, so what it shows of the terrain holds there. Isotropic Gaussian terrain: E[H11^2] = E[H22^2] = 3 c,
// E[H11 H22] = E[H12^2] = c (Longuet-Higgins 1957, "The statistical analysis of a random, moving surface"), hence E[(H:M)^2] =
// c ((tr M)^2 + 2 |M|^2). Terms are fitted by least squares with weights 1 / (1 + s / s0)^2, none negative, as all are variances.
// Sums are of integers, so that they do not depend on the order of the triangles, which differs from tile to tile.
#include "terrain/roughness.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "core/wide.h"
#include "terrain/tin/delaunay.h"
#include "terrain/tin/tin_surface.h"

namespace swath::terrain {
namespace {

constexpr double s0 = 4.0;                // m^2
constexpr double largest = 1e4;           // m^2: of a squared misfit
constexpr std::int64_t least_pairs = 12;  // per neighbourhood

/// Sums of the normal equations over (1, s, s^2/4), per block.
struct Sums {
  std::array<std::int64_t, 9> v{};
  std::int64_t pairs = 0;
  void add(const Sums& o) {
    for (size_t k = 0; k < v.size(); ++k) v[k] += o.v[k];
    pairs += o.pairs;
  }
};
// Resolution of the nine sums: each far below what a single pair adds, none over 63 bits for 10^4 pairs.
constexpr std::array<double, 9> scale{0x1p30, 0x1p30, 0x1p30, 0x1p30, 0x1p24, 0x1p16, 0x1p34, 0x1p34, 0x1p32};

/// Pairs of neighbouring triangles at work: b and c of one, and the vertex f beyond their edge, from the triangle's first vertex.
struct Pairs {
  static constexpr size_t size = 256;
  using Values = std::array<double, size>;
  Values bx, by, bz, cx, cy, cz, fx, fy, fz;
  std::array<Values, 9> terms;  ///< times `scale`
  std::array<size_t, size> block;
};

// Of the tensor M.
inline double length_of(double xx, double xy, double yy) {
  return std::sqrt((xx + yy) * (xx + yy) + 2.0 * (xx * xx + 2.0 * xy * xy + yy * yy));
}

/// As weights(), height_in() and reach_of(): M = sum w_k p_k p_k^T - q q^T.
SWATH_WIDE void work_out(Pairs& p) {
  for (size_t e = 0; e < Pairs::size; ++e) {
    const double bx = p.bx[e], by = p.by[e], cx = p.cx[e], cy = p.cy[e], fx = p.fx[e], fy = p.fy[e];
    const double inverse = 1.0 / (bx * cy - by * cx);
    const double wb = (fx * cy - fy * cx) * inverse, wc = (bx * fy - by * fx) * inverse, wa = 1.0 - wb - wc;
    const double misfit = p.fz[e] - wb * p.bz[e] - wc * p.cz[e];
    const double xx = wb * bx * bx + wc * cx * cx - fx * fx, yy = wb * by * by + wc * cy * cy - fy * fy;
    const double xy = wb * bx * by + wc * cx * cy - fx * fy, s = length_of(xx, xy, yy), square = misfit * misfit;
    const double share = 1.0 / (1.0 + wa * wa + wb * wb + wc * wc);
    const double y = (largest < square ? largest : square) * share, x1 = s * share, x2 = 0.25 * s * s * share;
    const double near = s0 / (s0 + s), w = near * near;
    p.terms[0][e] = w * scale[0], p.terms[1][e] = w * x1 * scale[1], p.terms[2][e] = w * x2 * scale[2];
    p.terms[3][e] = w * x1 * x1 * scale[3], p.terms[4][e] = w * x1 * x2 * scale[4], p.terms[5][e] = w * x2 * x2 * scale[5];
    p.terms[6][e] = w * y * scale[6], p.terms[7][e] = w * y * x1 * scale[7], p.terms[8][e] = w * y * x2 * scale[8];
  }
}

void add(const Pairs& p, size_t count, std::vector<Sums>& sums) {
  for (size_t e = 0; e < count; ++e) {
    Sums& to = sums[p.block[e]];
    for (size_t k = 0; k < to.v.size(); ++k) to.v[k] += static_cast<std::int64_t>(p.terms[k][e]);
    ++to.pairs;
  }
}

Roughness fit(const Sums& sums) {
  Roughness out;
  if (sums.pairs < least_pairs) return out;
  std::array<double, 9> t;
  for (size_t k = 0; k < t.size(); ++k) t[k] = static_cast<double>(sums.v[k]) / scale[k];
  Eigen::Matrix3d normal;
  normal << t[0], t[1], t[2], t[1], t[3], t[4], t[2], t[4], t[5];
  const Eigen::Vector3d right(t[6], t[7], t[8]);
  double least = std::numeric_limits<double>::infinity();
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  for (unsigned set = 1; set < 8; ++set) {  // which of the three terms take part
    Eigen::Matrix3d a = Eigen::Matrix3d::Identity();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (int i = 0; i < 3; ++i) {
      if (!((set >> i) & 1u)) continue;
      b[i] = right[i];
      for (int j = 0; j < 3; ++j)
        if ((set >> j) & 1u) a(i, j) = normal(i, j);
    }
    const Eigen::FullPivLU<Eigen::Matrix3d> lu(a);
    if (!lu.isInvertible()) continue;
    const Eigen::Vector3d x = lu.solve(b);
    if (!x.allFinite() || x.minCoeff() < 0.0) continue;
    const double squares = x.dot(normal * x) - 2.0 * x.dot(right);
    if (squares < least) least = squares, best = x;
  }
  return {best[0], best[1], best[2], true};
}

}  // namespace

double reach_of(const Tin& tin, std::int32_t triangle, const std::array<double, 3>& w, double x, double y) {
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (size_t k = 0; k < 3; ++k) {
    const auto v = static_cast<size_t>(tin.triangles[static_cast<size_t>(triangle)][k]);
    const double dx = tin.x[v] - x, dy = tin.y[v] - y;
    xx += w[k] * dx * dx;
    xy += w[k] * dx * dy;
    yy += w[k] * dy * dy;
  }
  return length_of(xx, xy, yy);
}

RoughnessMap::RoughnessMap(const Tin& tin, const Eigen::Vector3d& origin, const core::Lattice& window, double side) : origin_(origin) {
  const auto block = [side](double v) { return core::cell_index(v, side); };
  blocks_ = {side, block(window.west()) - 1, block(window.south()) - 1, 0, 0};
  blocks_.nx = static_cast<int>(block(window.east()) + 2 - blocks_.i0);
  blocks_.ny = static_cast<int>(block(window.north()) + 2 - blocks_.j0);
  const core::Lattice wide{side, blocks_.i0 - 1, blocks_.j0 - 1, blocks_.nx + 2, blocks_.ny + 2};
  std::vector<Sums> sums(wide.size());
  const double west = origin.x() - wide.west(), south = origin.y() - wide.south();
  // Edges are gathered without branches, which no processor would foresee.
  struct Edge {
    std::int32_t triangle, p, q, far;
  };
  constexpr std::int32_t batch = 256;
  std::array<Edge, 3 * batch> edges;
  const auto at_work = std::make_unique<Pairs>();
  Pairs& pairs = *at_work;
  size_t n = 0;
  const auto size = static_cast<std::int32_t>(tin.size());
  for (std::int32_t begin = 0; begin < size; begin += batch) {
    size_t count = 0;
    for (std::int32_t t = begin; t < std::min(begin + batch, size); ++t) {
      const auto& v = tin.triangles[t];
      for (int k = 0; k < 3; ++k) {
        const std::int32_t other = tin.across[t][k];
        if (other < 0) continue;
        const auto& u = tin.triangles[other];
        const std::int32_t p = v[(k + 1) % 3], q = v[(k + 2) % 3], far = u[0] ^ u[1] ^ u[2] ^ p ^ q;
        edges[count] = {t, p, q, far};
        count += is_before(tin.place(v[k]), tin.place(far));  // from the triangle that comes first, whatever their numbers in this tile
      }
    }
    for (size_t e = 0; e < count; ++e) {
      const auto [t, p, q, far] = edges[e];
      const double i = (0.5 * (tin.x[p] + tin.x[q]) + west) / side, j = (0.5 * (tin.y[p] + tin.y[q]) + south) / side;
      if (!(i >= 0.0 && j >= 0.0 && i < wide.nx && j < wide.ny)) continue;
      if (!tin.constrained.empty() &&
          std::binary_search(tin.constrained.begin(), tin.constrained.end(), std::pair<std::int32_t, std::int32_t>(std::minmax(p, q))))
        continue;
      const auto& v = tin.triangles[t];
      const double x0 = tin.x[v[0]], y0 = tin.y[v[0]], z0 = tin.z[v[0]];
      pairs.bx[n] = tin.x[v[1]] - x0, pairs.by[n] = tin.y[v[1]] - y0, pairs.bz[n] = tin.z[v[1]] - z0;
      pairs.cx[n] = tin.x[v[2]] - x0, pairs.cy[n] = tin.y[v[2]] - y0, pairs.cz[n] = tin.z[v[2]] - z0;
      pairs.fx[n] = tin.x[far] - x0, pairs.fy[n] = tin.y[far] - y0, pairs.fz[n] = tin.z[far] - z0;
      pairs.block[n++] = wide.at(static_cast<int>(i), static_cast<int>(j));
      if (n < Pairs::size) continue;
      work_out(pairs);
      add(pairs, std::exchange(n, 0), sums);
    }
  }
  work_out(pairs);
  add(pairs, n, sums);
  fitted_.resize(blocks_.size());
  for (int j = 0; j < blocks_.ny; ++j)
    for (int i = 0; i < blocks_.nx; ++i) {
      Sums pooled;
      for (int dj = 0; dj < 3; ++dj)
        for (int di = 0; di < 3; ++di) pooled.add(sums[wide.at(i + di, j + dj)]);
      fitted_[blocks_.at(i, j)] = fit(pooled);
    }
}

Roughness RoughnessMap::at(double x, double y) const {
  // Between the centres of four blocks; those without pairs have no say.
  const double u = (x + origin_.x()) / blocks_.cell - 0.5 - static_cast<double>(blocks_.i0);
  const double v = (y + origin_.y()) / blocks_.cell - 0.5 - static_cast<double>(blocks_.j0);
  const int i = std::clamp(static_cast<int>(std::floor(u)), 0, blocks_.nx - 2),
            j = std::clamp(static_cast<int>(std::floor(v)), 0, blocks_.ny - 2);
  Roughness out;
  double total = 0.0;
  for (int dj = 0; dj < 2; ++dj)
    for (int di = 0; di < 2; ++di) {
      const Roughness& r = fitted_[blocks_.at(i + di, j + dj)];
      const double w = std::max(0.0, 1.0 - std::abs(u - i - di)) * std::max(0.0, 1.0 - std::abs(v - j - dj));
      if (!r.known) continue;
      total += w;
      out.noise += w * r.noise;
      out.uneven += w * r.uneven;
      out.curved += w * r.curved;
    }
  if (!(total > 0.0)) return {};
  return {out.noise / total, out.uneven / total, out.curved / total, true};
}

}  // namespace swath::terrain
