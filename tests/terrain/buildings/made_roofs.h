// SPDX-License-Identifier: GPL-3.0-or-later
// Returns of roofs with known shape.
#pragma once

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "terrain/buildings/find_buildings.h"

namespace swath::terrain::test {

/// Height of a roof at a place, not a number beside it.
using Roof = std::function<double(double, double)>;

constexpr double off_roof = std::numeric_limits<double>::quiet_NaN();

/// Returns in the square from 0 to `side`, `density` of them per m2, with noise of `sigma` in height.
inline std::vector<RoofReturn> returns_of(const Roof& roof, double side, double density, double sigma, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(0.0, side);
  std::normal_distribution<double> noise(0.0, sigma);
  std::vector<RoofReturn> out;
  for (int k = 0; k < static_cast<int>(side * side * density); ++k) {
    const double x = place(random), y = place(random), z = roof(x, y), error = noise(random);
    if (std::isfinite(z)) out.push_back({x, y, z + error});
  }
  return out;
}

/// Of a house turned by `angle` about its middle: half its length and width, eaves and ridge along its length.
inline Roof gable(double mx, double my, double angle, double half_length, double half_width, double eaves, double ridge) {
  return [=](double x, double y) {
    const double u = std::cos(angle) * (x - mx) + std::sin(angle) * (y - my), v = -std::sin(angle) * (x - mx) + std::cos(angle) * (y - my);
    if (std::abs(u) > half_length || std::abs(v) > half_width) return off_roof;
    return ridge - (ridge - eaves) * std::abs(v) / half_width;
  };
}

/// Level ground at height 0, returns everywhere.
inline Surroundings3d open_ground() {
  return {[](const Eigen::Vector2d&) { return 0.0; }, [](const Eigen::Vector2d&) { return true; }};
}

}  // namespace swath::terrain::test
