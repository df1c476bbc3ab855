// SPDX-License-Identifier: GPL-3.0-or-later
// Planes grown over the cells of plane_cells.h, and the choice of those that tie the lines best.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "calib/ties/plane_cells.h"
#include "core/report.h"

namespace swath::calib {

struct FacetOptions {
  double piece = 12.0;         ///< largest side, m
  double roughness = 0.08;     ///< largest rms of one line about its plane, m
  double extent = 1.5;         ///< least half extent in the plane, m
  double mismatch = 0.05;      ///< rms by which lines may miss one another, m
  std::uint32_t returns = 12;  ///< fewest of one look
  size_t most = 3000;          ///< facets chosen
  bool thin_walls = false;     ///< walls that leave a cell few returns
};

/// Returns of one line in one look on a facet.
struct FacetLook {
  std::uint32_t line = 0;
  double first = 0.0, last = 0.0;  ///< s
  std::uint32_t n = 0;
};

/// A plane piece that two looks or more have seen.
struct Facet {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero(),
                  normal = Eigen::Vector3d::UnitZ();  ///< m; unit, up (towards the scanner is not known yet)
  Eigen::Vector2d half = Eigen::Vector2d::Zero();     ///< along plane_axes(normal), m
  TieKind kind = TieKind::ground;
  double slope = 0.0;  ///< rad
  std::vector<CellIndex3> cells;
  std::vector<FacetLook> looks;  ///< by line, then time
};

/// Facets grown from the flattest cells outwards, steep ones all, level ones from seeds spread over the block; then at most `most` of them,
/// with walls and slopes preferred and every kind spread evenly. Deterministic. Counted in the tally: cells and why they were refused.
std::vector<Facet> find_facets(const PlaneCells& cells, const FacetOptions& options, core::Tally& tally);

/// At most `most`, taken in turn from squares of side `square` of the block, those seen by most lines and widest first.
std::vector<Facet> spread(std::vector<Facet> facets, size_t most, double square);

constexpr double level_slope = 0.0872664625997165;  ///< 5 deg, rad
constexpr double wall_slope = 1.0471975511965976;   ///< 60 deg, rad

}  // namespace swath::calib
