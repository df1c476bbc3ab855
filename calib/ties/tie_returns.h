// SPDX-License-Identifier: GPL-3.0-or-later
// The raw returns near given planes, picked out of a whole flight.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "calib/ties/facets.h"

namespace swath::calib {

/// Where returns of one plane are looked for.
struct PlaneRegion {
  Eigen::Vector3d centre, normal;        ///< local frame, m; unit
  double reach = 0.0;                    ///< m to either side of the plane
  std::vector<CellIndex3> cells;         ///< the plane within these, or, where empty,
  std::vector<Eigen::Vector2d> outline;  ///< within this polygon of coordinates along plane_axes(normal) from the centre, m,
  double margin = 0.0;                   ///< and so far from its edges, m
  std::vector<FacetLook> looks;          ///< returns to be expected of each line; of others as of the largest
  std::uint32_t wanted = 0;              ///< returns of one look that are enough
};

/// A return near a plane.
struct NearReturn {
  double time = 0.0, angle = 0.0, forward = 0.0, range = 0.0;  ///< as recorded: s, rad, none, m
  Eigen::Vector3f place;                                       ///< from the region's centre, local frame, m
  std::uint32_t line = 0;                                      ///< index into the lines
  std::uint64_t draw = 0;                                      ///< of the record's time and range: the lowest draws are an even sample
};

/// Reads the stream once: last returns in each region, as they come. Where a look has far more than `wanted`, an even share of about 1.5
/// times that. `side`: of the cells. `lines`: by id.
std::vector<std::vector<NearReturn>> collect_returns(const ShotStream& stream, LocalPoints& points, const std::vector<PlaneRegion>& regions,
                                                     double side, const std::vector<TieLine>& lines);

/// Is a point inside a polygon and at least `margin` from its edges?
bool is_inside(const std::vector<Eigen::Vector2d>& polygon, const Eigen::Vector2d& p, double margin);

}  // namespace swath::calib
