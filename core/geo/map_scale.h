// SPDX-License-Identifier: GPL-3.0-or-later
// How true a map is at a place, and how far that place lies from where its CRS is meant to be used.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "core/geo/crs.h"

namespace swath::core {

/// Scale of a map projection at a place: lengths on the map by lengths on the ellipsoid, in the directions in which they differ most.
struct MapScale {
  double smallest = 1.0, largest = 1.0;
  /// That of the two farther from 1.
  double worst() const { return largest - 1.0 > 1.0 - smallest ? largest : smallest; }
  double area() const { return smallest * largest; }
};

/// A place in degrees from Greenwich, by the CRS's own datum.
struct Place {
  double longitude = 0.0, latitude = 0.0;
};

/// The place of map coordinates (units of the CRS); nothing where the CRS is not a map projection or the point lies outside its domain.
std::optional<Place> place_on_earth(const Crs& map, const Eigen::Vector2d& at);
/// Scale there: the axes of Tissot's ellipse.
std::optional<MapScale> map_scale(const Crs& map, const Eigen::Vector2d& at);

/// How far a place lies outside the CRS's area of use, degrees; 0 inside and where PROJ states no area.
double degrees_outside(const Crs& crs, const Place& place);

/// "EPSG:32632", the UTM zone of a place; "EPSG:25832" where `datum` is ETRS89 and EPSG has the zone; "EPSG:326xx" for no place.
std::string utm_zone(const Place& place, const Crs& datum = {});

}  // namespace swath::core
