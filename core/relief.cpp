// SPDX-License-Identifier: GPL-3.0-or-later
// Slope by third-order differences: Horn 1981, "Hill shading and the reflectance map", Proc. IEEE 69(1), p. 18.
// Several lights: Mark 1992, USGS Open-File Report 92-422: azimuths 225, 270, 315 and 360 deg, each weighted by sin^2(aspect - azimuth);
// the weights sum to 2. Deviation: Mark fixes the altitude at 30 deg, here it is the option's.
#include "core/relief.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace swath::core {
namespace {

/// Heights of the 3 x 3 cells around (i, j) of `own`, from the south-west.
std::array<double, 9> around(const Grid& model, const Lattice& own, int i, int j) {
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

Grid like(const Grid& model, const Lattice& own, const Gradients& g) {
  Grid out(own);
  for (int j = 0; j < own.ny; ++j)
    for (int i = 0; i < own.nx; ++i) {
      const size_t at = own.at(i, j);
      out.reason[at] =
          model.reason[model.lattice.at(static_cast<int>(own.i0 + i - model.lattice.i0), static_cast<int>(own.j0 + j - model.lattice.j0))];
      if (std::isnan(g.east[at]) && out.reason[at] == Void::none) out.reason[at] = Void::no_data;
    }
  return out;
}

}  // namespace

Gradients gradients(const Grid& model, const Lattice& own) {
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

Grid slope(const Grid& model, const Lattice& own) {
  const Gradients g = gradients(model, own);
  Grid out = like(model, own, g);
  for (size_t k = 0; k < own.size(); ++k)
    out.height[k] =
        static_cast<float>(std::atan(std::hypot(static_cast<double>(g.east[k]), static_cast<double>(g.north[k]))) * 180.0 / M_PI);
  return out;
}

Grid hillshade(const Grid& model, const Lattice& own, const Light& o) {
  const Gradients g = gradients(model, own);
  Grid out = like(model, own, g);
  struct Ray {
    double azimuth, east, north;
  };
  std::vector<Ray> rays;
  const double level = std::cos(o.altitude.value), up = std::sin(o.altitude.value);
  for (const double azimuth :
       o.multidirectional ? std::vector{225.0 * degree, 270.0 * degree, 315.0 * degree, 360.0 * degree} : std::vector{o.azimuth.value})
    rays.push_back({azimuth, level * std::sin(azimuth), level * std::cos(azimuth)});
  for (size_t k = 0; k < own.size(); ++k) {
    if (std::isnan(g.east[k])) continue;
    const double e = o.exaggeration * static_cast<double>(g.east[k]), n = o.exaggeration * static_cast<double>(g.north[k]);
    const double aspect = o.multidirectional ? std::atan2(-e, -n) : 0.0;  // of the downward slope
    double sum = 0.0;
    for (const Ray& ray : rays) {
      const double cosine = (up - e * ray.east - n * ray.north) / std::sqrt(1.0 + e * e + n * n);
      const double w = std::sin(aspect - ray.azimuth);
      sum += (o.multidirectional ? w * w / 2.0 : 1.0) * std::max(0.0, cosine);
    }
    out.height[k] = static_cast<float>(255.0 * sum);
  }
  return out;
}

}  // namespace swath::core
