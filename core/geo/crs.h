// SPDX-License-Identifier: GPL-3.0-or-later
// Coordinate reference systems and the transformations between them, through PROJ.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "core/geo/crs_facts.h"

namespace swath::core {

/// A coordinate reference system: "EPSG:32632", compound "EPSG:25832+7837" (also "EPSG:25832+EPSG:7837"), with ellipsoidal heights
/// "EPSG:25832+ellipsoidal", WKT (WKT2, WKT1 of GDAL, ESRI or LAStools), PROJ text. A shift to WGS 84 (TOWGS84) that WKT holds beside a
/// datum known by its code is not used, as in GDAL. Holds plain facts only: copies may be used from any thread.
class Crs {
 public:
  Crs() = default;
  /// Throws Error where PROJ does not know it; hint names the nearest remedy.
  explicit Crs(const std::string& definition);

  bool empty() const { return !facts_; }
  std::string name() const;
  std::string wkt() const;    ///< WKT2:2019
  std::string wkt1() const;   ///< WKT1 GDAL form (LAS WKT VLR), falls back to WKT2 where WKT1 cannot hold it
  int epsg() const;           ///< code of the CRS (of its horizontal part where compound), 0 where it has none
  int vertical_epsg() const;  ///< code of the vertical part, 0 where none
  bool is_geographic() const;
  bool is_projected() const;
  bool is_geocentric() const;
  Heights heights() const;
  bool has_vertical() const;                ///< compound with a vertical part (heights over a geoid, a level, or an unknown datum)
  bool has_height_unit() const;             ///< it states the unit of heights
  std::string vertical_name() const;        ///< vertical datum's name, unknown_heights or ellipsoidal_heights
  Crs horizontal() const;                   ///< without heights
  double metres_per_unit() const;           ///< of the horizontal axes (geographic: 0)
  double vertical_metres_per_unit() const;  ///< of heights
  std::string unit_name() const;
  std::string vertical_unit_name() const;
  /// Area of use in degrees; false where PROJ states none.
  bool area_of_use(double& west, double& south, double& east, double& north) const;
  /// Text that distinguishes this CRS, for fingerprints.
  std::string key() const { return wkt(); }

  /// Throws Error where the CRS is empty.
  const CrsFacts& facts() const;

 private:
  std::shared_ptr<const CrsFacts> facts_;
};

/// ECEF of WGS84, EPSG:4978.
Crs wgs84_ecef();
/// Geodetic WGS84 3D, EPSG:4979.
Crs wgs84_geodetic();

/// A transformation between two CRSs by PROJ, easting-northing axis order (longitude before latitude, degrees for geographic CRSs),
/// best available operation. Refuses ballpark operations and those whose grids are missing: Error names the grid file and how to get it.
/// Refused is also a second-best operation, where a missing grid would give 1 m or better by EPSG's statement and no installed operation
/// is as good over the same area; coarser grids (1.5 m and up, as WGS 84 to NAD83) are let go, accuracy() then states what is left.
/// Heights: a CRS that does not state its system and one that counts from a geoid or level have no relation, and Error says so; two that
/// state none hand heights through as they are; beside ellipsoidal heights (ECEF, geodetic 3D) an unstated system is ellipsoidal in metres,
/// as in the map coordinates of raw records.
/// One object is for one thread; copy() makes another.
class Transform {
 public:
  Transform(const Crs& from, const Crs& to);
  ~Transform();
  Transform(Transform&&) noexcept;
  Transform& operator=(Transform&&) noexcept;
  Transform copy() const;

  /// Throws Error where PROJ gives no finite result (outside the projection's domain).
  Eigen::Vector3d operator()(const Eigen::Vector3d& p) const;
  /// In place, arrays of n; coordinates with no finite result become NaN and are counted in the result.
  size_t apply(double* x, double* y, double* z, size_t n) const;
  std::string description() const;  ///< of the operation PROJ chose (for the last point, where it has a choice)
  double accuracy() const;          ///< of that operation, as EPSG states it, m; negative where unknown or not yet chosen

 private:
  struct State;
  explicit Transform(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace swath::core
