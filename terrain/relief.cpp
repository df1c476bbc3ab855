// SPDX-License-Identifier: GPL-3.0-or-later
// Horn 1981, "Hill shading and the reflectance map".
#include "terrain/relief.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace swath::terrain {
namespace {

/// Heights of the 3 x 3 cells around (i, j) of `own`, from the south-west.
std::array<double, 9> around(const core::Grid& model, const core::Lattice& own, int i, int j) {
  const auto at = [&](int di, int dj) {
    const auto mi = own.i0 + i + di - model.lattice.i0, mj = own.j0 + j + dj - model.lattice.j0;
    if (mi < 0 || mj < 0 || mi >= model.lattice.nx || mj >= model.lattice.ny) return std::numeric_limits<double>::quiet_NaN();
    return static_cast<double>(model.height[model.lattice.at(static_cast<int>(mi), static_cast<int>(mj))]);
  };
  std::array<double, 9> z;
  for (int dj = -1; dj <= 1; ++dj)
    for (int di = -1; di <= 1; ++di) z[static_cast<size_t>(3 * (dj + 1) + di + 1)] = at(di, dj);
  const std::array<double, 9> known = z;
  for (size_t k = 0; k < 9; ++k)
    if (std::isnan(z[k])) z[k] = std::isnan(known[8 - k]) ? z[4] : 2.0 * z[4] - known[8 - k];
  return z;
}

core::Grid like(const core::Grid& model, const core::Lattice& own, const Gradients& g) {
  core::Grid out(own);
  for (int j = 0; j < own.ny; ++j)
    for (int i = 0; i < own.nx; ++i) {
      const size_t at = own.at(i, j);
      out.reason[at] =
          model.reason[model.lattice.at(static_cast<int>(own.i0 + i - model.lattice.i0), static_cast<int>(own.j0 + j - model.lattice.j0))];
      if (std::isnan(g.east[at]) && out.reason[at] == core::Void::none) out.reason[at] = core::Void::no_data;
    }
  return out;
}

}  // namespace

Gradients gradients(const core::Grid& model, const core::Lattice& own) {
  Gradients g;
  g.east.assign(own.size(), std::numeric_limits<float>::quiet_NaN());
  g.north = g.east;
  for (int j = 0; j < own.ny; ++j)
    for (int i = 0; i < own.nx; ++i) {
      const auto z = around(model, own, i, j);
      if (std::isnan(z[4])) continue;
      const double run = 8.0 * own.cell;
      g.east[own.at(i, j)] = static_cast<float>(((z[2] + 2.0 * z[5] + z[8]) - (z[0] + 2.0 * z[3] + z[6])) / run);
      g.north[own.at(i, j)] = static_cast<float>(((z[6] + 2.0 * z[7] + z[8]) - (z[0] + 2.0 * z[1] + z[2])) / run);
    }
  return g;
}

core::Grid slope(const core::Grid& model, const core::Lattice& own) {
  const Gradients g = gradients(model, own);
  core::Grid out = like(model, own, g);
  for (size_t k = 0; k < own.size(); ++k)
    out.height[k] =
        static_cast<float>(std::atan(std::hypot(static_cast<double>(g.east[k]), static_cast<double>(g.north[k]))) * 180.0 / M_PI);
  return out;
}

core::Grid hillshade(const core::Grid& model, const core::Lattice& own, const ReliefOptions& o) {
  const Gradients g = gradients(model, own);
  core::Grid out = like(model, own, g);
  const double level = std::cos(o.altitude.value);
  const std::array<double, 3> light{level * std::sin(o.azimuth.value), level * std::cos(o.azimuth.value), std::sin(o.altitude.value)};
  for (size_t k = 0; k < own.size(); ++k) {
    const double e = o.exaggeration * static_cast<double>(g.east[k]), n = o.exaggeration * static_cast<double>(g.north[k]);
    const double cosine = (light[2] - e * light[0] - n * light[1]) / std::sqrt(1.0 + e * e + n * n);
    out.height[k] = std::isnan(cosine) ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(255.0 * std::max(0.0, cosine));
  }
  return out;
}

}  // namespace swath::terrain
