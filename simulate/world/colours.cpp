// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/world/colours.h"

#include <algorithm>
#include <cmath>

#include "core/block.h"
#include "core/floor_div.h"

namespace swath::simulate {
namespace {

namespace point_class = core::point_class;

/// In [0, 1), of a node of a lattice.
double at_node(std::int64_t i, std::int64_t j, std::uint64_t salt) {
  std::uint64_t h = static_cast<std::uint64_t>(i) * 0x9e3779b97f4a7c15u ^ (static_cast<std::uint64_t>(j) + salt) * 0xc2b2ae3d27d4eb4fu;
  h = (h ^ (h >> 29)) * 0xbf58476d1ce4e5b9u;
  h ^= h >> 32;
  return static_cast<double>(h >> 11) * 0x1p-53;
}

/// Smooth between the nodes of a lattice of `side` metres, 0 to 1.
double patches(double x, double y, double side, std::uint64_t salt) {
  const double u = x / side, v = y / side;
  const std::int64_t i = core::floor_of(u), j = core::floor_of(v);
  const auto ease = [](double t) { return t * t * (3.0 - 2.0 * t); };
  const double a = ease(u - static_cast<double>(i)), b = ease(v - static_cast<double>(j));
  return (1 - b) * ((1 - a) * at_node(i, j, salt) + a * at_node(i + 1, j, salt)) +
         b * ((1 - a) * at_node(i, j + 1, salt) + a * at_node(i + 1, j + 1, salt));
}

struct Paint {
  std::array<double, 3> dark, bright;
};

Paint paint_of(std::uint8_t kind) {
  switch (kind) {
    case point_class::ground:
      return {{84, 92, 48}, {196, 178, 116}};
    case point_class::water:
      return {{20, 44, 66}, {44, 82, 104}};
    case point_class::building:
      return {{118, 58, 46}, {216, 150, 130}};
    case point_class::bridge_deck:
      return {{110, 110, 112}, {176, 176, 172}};
    case point_class::low_vegetation:
    case point_class::medium_vegetation:
      return {{58, 96, 34}, {150, 176, 74}};
    case point_class::high_vegetation:
      return {{22, 52, 18}, {86, 128, 52}};
    default:
      return {{90, 90, 90}, {200, 200, 200}};
  }
}

}  // namespace

std::array<std::uint8_t, 3> colour_of(std::uint8_t kind, const Eigen::Vector3d& p, std::int64_t seed) {
  constexpr std::uint64_t wide = 1, middle = 2, fine = 3, grain = 4;
  const auto salt = [&](std::uint64_t which) { return 31 * static_cast<std::uint64_t>(seed) + 7 * which + 1009 * kind; };
  const double x = p.x() + 0.37 * p.z(), y = p.y() - 0.53 * p.z();  // walls and crowns change with height, too
  const double value = 0.35 * patches(x, y, 23.0, salt(wide)) + 0.3 * patches(x, y, 5.0, salt(middle)) +
                       0.2 * patches(x, y, 1.1, salt(fine)) + 0.15 * patches(x, y, 0.3, salt(grain));
  const Paint paint = paint_of(kind);
  std::array<std::uint8_t, 3> out{};
  const double share = std::clamp(1.6 * (value - 0.5) + 0.5, 0.0, 1.0);
  for (size_t k = 0; k < 3; ++k) out[k] = static_cast<std::uint8_t>(std::lround(paint.dark[k] + share * (paint.bright[k] - paint.dark[k])));
  return out;
}

}  // namespace swath::simulate
