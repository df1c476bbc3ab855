// SPDX-License-Identifier: GPL-3.0-or-later
// A corridor with a power line whose wires are exact catenaries, and its returns.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/block.h"

namespace swath::test {

/// z(u) = low + a (cosh((u - middle) / a) - 1), u metres from `from` along `along` (unit).
struct TrueWire {
  Eigen::Vector2d from, along;
  double length, a, middle, low;
  int span;
  double z(double u) const;
  double sag() const;
  Eigen::Vector3d at(double u) const;
};

struct LineOfWires {
  unsigned seed = 1;
  double density = 8.0;                                           ///< pulses per m2
  std::vector<double> turns{0.0, 0.12, 0.0};                      ///< rad: each span's direction against that before it
  double span = 180.0, a = 700.0;                                 ///< m
  std::vector<Eigen::Vector2d> arms{{-4, 22}, {0, 26}, {4, 22}};  ///< across, and above the ground at the support, m
  std::vector<Eigen::Vector2d> bundle{{0, 0}};                    ///< places of a bundle's wires about its middle: across, up, m
  double footprint = 0.25, noise = 0.02;                          ///< m: width of the beam; sigma of a height
  double slope = 0.05, waves = 1.5;                               ///< of the ground: rise / run, m
  bool trees = true;
  int flight_lines = 2;
  double step = 0.0;  ///< m: height of the second flight line against the first
};

/// Block: x, y, z, strip, return numbers, classification (all 0), flags, height above the true ground.
struct PowerLineScene {
  core::Block block;
  std::vector<std::uint8_t> truth;  ///< ground, high_vegetation, wire, 15 of pylons
  std::vector<TrueWire> wires;      ///< of a bundle its middle
  std::vector<Eigen::Vector2d> pylons;
  std::function<double(double, double)> terrain;  ///< arguments relative to the block's origin
};

constexpr std::uint8_t tower_class = 15;

PowerLineScene make_power_line(const LineOfWires& o);

}  // namespace swath::test
