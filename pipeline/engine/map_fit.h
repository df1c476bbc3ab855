// SPDX-License-Identifier: GPL-3.0-or-later
// Does the map projection of a run suit the place of its data?
#pragma once

#include <string>

#include "stages/stage.h"

namespace swath::pipeline {

/// Deviations from 1 of the map's scale. Cells, densities, areas, slopes and volumes are those of the map. UTM deviates by up to 0.1 % at a
/// zone's edge and 0.3 % half a zone beyond it, national grids by less than 0.1 %: from 0.5 % on another projection is usual, and a
/// warning is due. Projections of whole continents and poles, which are in use for products, deviate by up to 8 % (polar stereographic at
/// 60 deg, EPSG:3413): beyond 10 % areas are wrong by 20 % and more, and no survey's products are meant (EPSG:3857 from 25 deg of
/// latitude).
constexpr double warned_scale = 0.005, refused_scale = 0.10;
/// Degrees outside the CRS's area of use: half a UTM zone, as for the fixes and trajectories of a flight.
constexpr double warned_outside = 3.0;

struct MapFit {
  double scale = 1.0;    ///< of lengths at the data, where it differs most from 1
  double area = 1.0;     ///< of areas
  double outside = 0.0;  ///< the area of use, degrees
  std::string zone{};    ///< a UTM zone that suits the place
};

/// Nothing where the place of the data is not known, or lies outside what the projection can show. Of several places of the data (its
/// corner, its middle) the one that suits best: a stray point is not held against the projection.
std::optional<MapFit> map_fit(const stages::Context& context);

/// Throws core::Error (usage) where the scale is off by more than `refused_scale`; `where` names what has the CRS. `from_command_line`: the
/// CRS is --crs.
void require_map_fit(const stages::Context& context, const std::string& where, bool from_command_line);

/// Sentences of the report.
std::string scale_warning(const std::string& crs, double scale);
std::string outside_warning(const std::string& crs, double degrees);

}  // namespace swath::pipeline
