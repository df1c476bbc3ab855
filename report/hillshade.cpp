// SPDX-License-Identifier: GPL-3.0-or-later
// Slope by Horn's third-order differences (Proc. IEEE 69(1), 1981, eq. on p. 18); brightness by Lambert's cosine law.
// Several lights: Mark, USGS Open-File Report 92-422: azimuths 225, 270, 315, 360 deg, each weighted by sin^2(aspect - azimuth); the four
// weights always sum to 2. Deviation: Mark fixes the altitude at 30 deg, here it is the option's.
#include "report/hillshade.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace swath::report {
namespace {

struct Slope {
  double east = 0.0, north = 0.0;  ///< rise per run
};

Slope slope_at(const core::Lattice& l, const std::vector<float>& height, int i, int j, double exaggeration) {
  const double centre = height[l.at(i, j)];
  const auto z = [&](int di, int dj) {
    if (!l.holds(i + di, j + dj)) return centre;
    const double v = height[l.at(i + di, j + dj)];
    return std::isnan(v) ? centre : v;
  };
  const double k = exaggeration / (8.0 * l.cell);
  return {k * ((z(1, 1) + 2 * z(1, 0) + z(1, -1)) - (z(-1, 1) + 2 * z(-1, 0) + z(-1, -1))),
          k * ((z(-1, 1) + 2 * z(0, 1) + z(1, 1)) - (z(-1, -1) + 2 * z(0, -1) + z(1, -1)))};
}

/// Cosine of the angle between the surface's normal and the light.
double lit(const Slope& s, double azimuth, double altitude) {
  const double length = std::sqrt(1.0 + s.east * s.east + s.north * s.north);
  const double toward = -(s.east * std::sin(azimuth) + s.north * std::cos(azimuth));
  return std::max(0.0, (std::sin(altitude) + std::cos(altitude) * toward) / length);
}

double lit_from_four(const Slope& s, double altitude) {
  if (s.east == 0.0 && s.north == 0.0) return std::sin(altitude);
  const double aspect = std::atan2(-s.east, -s.north);  // of the downward slope, from north clockwise
  constexpr std::array<double, 4> azimuths{225.0, 270.0, 315.0, 360.0};
  double sum = 0.0;
  for (const double degrees : azimuths) {
    const double azimuth = degrees * core::degree;
    const double w = std::sin(aspect - azimuth);
    sum += w * w * lit(s, azimuth, altitude);
  }
  return sum / 2.0;
}

}  // namespace

std::vector<float> hillshade(const core::Lattice& l, const std::vector<float>& height, const HillshadeOptions& o) {
  std::vector<float> out(l.size(), std::numeric_limits<float>::quiet_NaN());
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) {
      if (std::isnan(height[l.at(i, j)])) continue;
      const Slope s = slope_at(l, height, i, j, o.exaggeration);
      const double v = o.multidirectional ? lit_from_four(s, o.altitude.value) : lit(s, o.azimuth.value, o.altitude.value);
      out[l.at(i, j)] = static_cast<float>(v);
    }
  return out;
}

}  // namespace swath::report
