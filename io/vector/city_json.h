// SPDX-License-Identifier: GPL-3.0-or-later
// Objects of a city as CityJSON 2.0.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "io/vector/feature_file.h"

namespace swath::io {

/// A plane surface: the first ring runs counter-clockwise as seen from outside (above, of a surface alone), holes clockwise; not closed.
/// CRS units.
struct CitySurface {
  std::string semantics;  ///< RoofSurface, GroundSurface, WallSurface; empty: none
  std::vector<std::vector<Eigen::Vector3d>> rings;
};

struct CityGeometry {
  std::string lod;        ///< "0", "1.2" ...
  bool is_solid = false;  ///< the surfaces close a solid; otherwise a MultiSurface
  std::vector<CitySurface> surfaces;
};

struct CityObject {
  std::string id, type = "Building";
  std::vector<std::pair<std::string, FieldValue>> attributes;  ///< a number that is not finite is left out
  std::vector<CityGeometry> geometries;                        ///< those without surfaces are left out
};

/// CityJSON 2.0 (OGC 20-072r5): vertices are whole multiples of 0.001 CRS units from a whole place; vertices of equal numbers are one, and
/// sides that vanish by that are left out, as are rings with fewer than three sides. `referenceSystem` is the URI of the CRS's EPSG code
/// (of its horizontal part, where the compound has none: `title` names the heights then), left out where it has no code. Throws
/// core::Error: two objects of one id, a coordinate that is not finite, file not writable, disk full; nothing half-written stays.
void write_city_json(const std::filesystem::path& file, const std::vector<CityObject>& objects, const std::string& crs,
                     const std::string& title);

}  // namespace swath::io
