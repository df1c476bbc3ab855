// SPDX-License-Identifier: GPL-3.0-or-later
// Moving least squares (Lancaster & Salkauskas 1981, Math. Comp. 37) on rasters: the normal equations of all cells are convolutions of the
// data with a Gaussian times 1, x, y, x^2, x y, y^2, and these separate into a pass along rows and one along columns. Every sum runs in the
// order of the kernel, so a cell's result does not depend on the extent of the raster. Breaks: Kuwahara et al. 1976 in the smooth form of
// Papari, Petkov & Campisi 2007 (IEEE Trans. Image Process. 16), with planes in place of means.
#include "filters/ground/moving_planes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/wide.h"

namespace swath::filters {
namespace {

using Kernel = std::vector<float>;

/// The Gaussian times distance to the power 0, 1, 2; index 0 stands for -reach.
std::array<Kernel, 3> kernels(double sigma) {
  const int r = reach(sigma);
  std::array<Kernel, 3> k;
  for (int d = -r; d <= r; ++d) {
    const double g = std::exp(-0.5 * d * d / (sigma * sigma));
    k[0].push_back(static_cast<float>(g));
    k[1].push_back(static_cast<float>(g * d));
    k[2].push_back(static_cast<float>(g * d * d));
  }
  return k;
}

SWATH_WIDE Raster along_rows(const Raster& in, const Kernel& k) {
  Raster out(in.nx, in.ny, 0.0F);
  const int r = static_cast<int>(k.size()) / 2;
  std::vector<float> padded(static_cast<size_t>(in.nx + 2 * r), 0.0F);
  for (int j = 0; j < in.ny; ++j) {
    std::copy_n(in.value.data() + in.at(0, j), in.nx, padded.data() + r);
    float* to = out.value.data() + out.at(0, j);
    for (int d = 0; d <= 2 * r; ++d) {
      const float w = k[static_cast<size_t>(d)];
      const float* from = padded.data() + d;
      for (int i = 0; i < in.nx; ++i) to[i] += w * from[i];
    }
  }
  return out;
}

SWATH_WIDE Raster along_columns(const Raster& in, const Kernel& k) {
  Raster out(in.nx, in.ny, 0.0F);
  const int r = static_cast<int>(k.size()) / 2;
  for (int j = 0; j < in.ny; ++j) {
    float* to = out.value.data() + out.at(0, j);
    for (int d = -r; d <= r; ++d) {
      if (j + d < 0 || j + d >= in.ny) continue;
      const float w = k[static_cast<size_t>(d + r)];
      const float* from = in.value.data() + in.at(0, j + d);
      for (int i = 0; i < in.nx; ++i) to[i] += w * from[i];
    }
  }
  return out;
}

}  // namespace

Raster blur(const Raster& in, double sigma) {
  const Kernel k = kernels(sigma)[0];
  return along_columns(along_rows(in, k), k);
}

int reach(double sigma) { return static_cast<int>(std::ceil(2.5 * sigma)); }

PlaneField fit_planes(const CellSums& data, double sigma, double prior) {
  const std::array<Kernel, 3> k = kernels(sigma);
  const Raster w0 = along_rows(data.weight, k[0]), w1 = along_rows(data.weight, k[1]), w2 = along_rows(data.weight, k[2]);
  const Raster v0 = along_rows(data.value, k[0]), v1 = along_rows(data.value, k[1]);
  const Raster s = along_columns(w0, k[0]), sx = along_columns(w1, k[0]), sy = along_columns(w0, k[1]);
  const Raster sxx = along_columns(w2, k[0]), sxy = along_columns(w1, k[1]), syy = along_columns(w0, k[2]);
  const Raster sv = along_columns(v0, k[0]), svx = along_columns(v1, k[0]), svy = along_columns(v0, k[1]);
  const Raster svv = along_columns(along_rows(data.square, k[0]), k[0]);

  const int nx = data.weight.nx, ny = data.weight.ny;
  const Raster zeros(nx, ny, 0.0F);
  PlaneField f{zeros, zeros, zeros, s, zeros};
  const double spread = prior * sigma * sigma;
  for (size_t c = 0; c < s.value.size(); ++c) {
    if (s.value[c] <= 0.0F) continue;
    // Cholesky of [m x y; x xx xy; y xy yy].
    const double m = s.value[c] + prior, x = sx.value[c], y = sy.value[c];
    const double lx = x / m, ly = y / m;
    const double xx = sxx.value[c] + spread - lx * x, xy = sxy.value[c] - lx * y, yy = syy.value[c] + spread - ly * y;
    const double lxy = xy / xx;
    const double rest = yy - lxy * xy;
    const double v = sv.value[c], vx = svx.value[c] - lx * v, vy = svy.value[c] - ly * v - lxy * vx;
    const double north = vy / rest, east = (vx - xy * north) / xx, height = v / m - lx * east - ly * north;
    f.height.value[c] = static_cast<float>(height);
    f.east.value[c] = static_cast<float>(east);
    f.north.value[c] = static_cast<float>(north);
    const double left = svv.value[c] - height * v - east * svx.value[c] - north * svy.value[c];
    f.variance.value[c] = static_cast<float>(std::max(0.0, left / m));
  }
  return f;
}

Raster across_breaks(std::span<const PlaneChoice> fields, double noise) {
  constexpr std::array<std::pair<int, int>, 9> places{{{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {1, -1}, {-1, 1}}};
  const int nx = fields[0].planes.height.nx, ny = fields[0].planes.height.ny;
  Raster out(nx, ny, 0.0F), weights = out, quality = out;
  const auto floor = static_cast<float>(noise * noise);
  for (const auto& [p, step] : fields) {
    for (size_t c = 0; c < quality.value.size(); ++c) {
      const float q = 1.0F / (p.variance.value[c] + floor);
      quality.value[c] = p.support.value[c] * q * q * q;
    }
    for (const auto& [a, b] : places) {
      const int di = a * step, dj = b * step;
      const auto fi = static_cast<float>(di), fj = static_cast<float>(dj);
      for (int j = std::max(0, -dj); j < ny - std::max(0, dj); ++j)
        for (int i = std::max(0, -di); i < nx - std::max(0, di); ++i) {
          const size_t c = out.at(i, j), n = out.at(i + di, j + dj);
          const float w = quality.value[n];
          weights.value[c] += w;
          out.value[c] += w * (p.height.value[n] - p.east.value[n] * fi - p.north.value[n] * fj);
        }
    }
  }
  for (size_t c = 0; c < out.value.size(); ++c) out.value[c] = weights.value[c] > 0.0F ? out.value[c] / weights.value[c] : 0.0F;
  return out;
}

}  // namespace swath::filters
