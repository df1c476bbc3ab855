// SPDX-License-Identifier: GPL-3.0-or-later
// Which way the coordinates of a map grow.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "core/geo/crs.h"

namespace swath::core {

/// Empty where x counts east and y north, as PROJ and GIS files give them (northing-easting CRSs are turned round by both), on polar maps
/// (both axes run along meridians), and for what is not a map projection. Else what x and y are: "southing and westing" (EPSG:5513, a
/// mirror image), "westing and southing" (EPSG:2048, upside down), "northing and westing".
std::string turned_axes(const Crs& crs);

/// The same projection with easting and northing, heights as the CRS has them ("EPSG:5514+5705"); empty where EPSG has none.
std::string easting_northing_form(const Crs& crs);

/// The UTM zone to use in place of `crs`, with its heights ("EPSG:32734", "EPSG:25832+5783"): that of `at`, a place in its coordinates
/// (degrees where it is geographic), else of the middle of the map's area of use; where neither is known the form of the codes.
std::string utm_for(const Crs& crs, const std::optional<Eigen::Vector2d>& at = {});

/// Courses, aspects, the light of a relief and the north arrow of a picture all take x to be east and y north. Throws core::usage_error
/// for a CRS in which they are not; the hint names a CRS to use. `where`: file and key, or the option.
void require_easting_northing(const Crs& crs, const std::string& where);

}  // namespace swath::core
