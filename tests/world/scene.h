// SPDX-License-Identifier: GPL-3.0-or-later
// A zoo of analytic scenes: points with true labels over a terrain that is known everywhere.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/block.h"

namespace swath::test {

/// Columns: x, y, z, time (one per pulse), return number and count, strip, range, class 0, flags 0.
struct Scene {
  std::string name;
  core::Block block;
  std::vector<std::uint8_t> truth;                ///< core::point_class: ground, high_vegetation, building, bridge_deck
  std::function<double(double, double)> terrain;  ///< height of the bare ground, m; arguments relative to the block's origin
};

constexpr double scene_width = 200.0, scene_height = 160.0;  ///< m; x from 0 to width, y from 0 to height
constexpr double scene_noise = 0.03;                         ///< m, standard deviation of the heights

/// "flat", "slope", "scarp", "bridge", "town", "forest", "water", "void", "strip_edge".
std::vector<std::string> scene_names();

/// One pulse per square metre at a random place in each (strip_edge: a second line over part of it). The same scene at every call.
Scene make_scene(const std::string& name);

/// One more point; its other columns hold zeros.
void add_point(core::Block& b, double x, double y, double z);

/// The scene's points in another, random order.
core::Block shuffled(const core::Block& b, unsigned seed, std::vector<std::uint32_t>& rows);

/// Runs `filter(block, own)` tile by tile (squares of `side` metres, the halo's points behind the own ones) and puts the columns
/// classification, flags and ground_probability of the own points together, in the rows of `whole`.
core::Block run_tiled(const core::Block& whole, double side, double halo, const std::function<void(core::Block&, size_t)>& filter);

}  // namespace swath::test
