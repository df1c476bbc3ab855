// SPDX-License-Identifier: GPL-3.0-or-later
// Heights of a TIN at the cell centres of a lattice and at single places.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/grid.h"
#include "terrain/tin/tin.h"

namespace swath::terrain {

/// Barycentric weights of (x, y) for the triangle's three vertices; they add up to 1.
std::array<double, 3> weights(const Tin& tin, std::int32_t triangle, double x, double y);

/// Height of the triangle's plane at (x, y), m (Block frame). Always from the vertices in their order: the same bits in every tile.
double height_in(const Tin& tin, std::int32_t triangle, double x, double y);

/// Rise per metre eastward and northward of the triangle's plane.
Eigen::Vector2d gradient(const Tin& tin, std::int32_t triangle);

/// For each cell of `window` (row-major as in core::Grid) the triangle that covers its centre, -1 where none does. `origin` is the
/// Block's. A centre exactly on an edge belongs to the triangle whose vertices come first in lexicographic order.
std::vector<std::int32_t> triangles_at_centres(const Tin& tin, const Eigen::Vector3d& origin, const core::Lattice& window);

/// For each place (Block frame, m) the triangle that covers it, -1 where none does; ties as above. Cost is about one pass over the
/// triangles, so ask for all places at once.
std::vector<std::int32_t> triangles_at(const Tin& tin, const std::vector<double>& x, const std::vector<double>& y);

}  // namespace swath::terrain
