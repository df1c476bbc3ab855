// SPDX-License-Identifier: GPL-3.0-or-later
// The WGS84 ellipsoid, its frames and its gravity, and coordinate reference systems through PROJ.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>

namespace swath::core {

/// WGS84 defining and derived constants (NIMA TR8350.2).
namespace wgs84 {
constexpr double a = 6378137.0;            ///< semi-major axis, m
constexpr double f = 1.0 / 298.257223563;  ///< flattening
constexpr double b = a * (1.0 - f);        ///< semi-minor axis, m
constexpr double e2 = f * (2.0 - f);       ///< first eccentricity squared
constexpr double gm = 3.986004418e14;      ///< m^3/s^2
constexpr double omega = 7.292115e-5;      ///< rotation, rad/s
}  // namespace wgs84

/// Latitude, longitude (rad), ellipsoidal height (m).
struct Geodetic {
  double latitude = 0.0, longitude = 0.0, height = 0.0;
};

Eigen::Vector3d ecef_of(const Geodetic& g);
/// Closed to 1e-9 m for heights from -10 km to 10 000 km.
Geodetic geodetic_of(const Eigen::Vector3d& ecef);
/// Columns: north, east, down in ecef.
Eigen::Matrix3d ecef_R_ned(double latitude, double longitude);
double meridian_radius(double latitude);        ///< M, m
double prime_vertical_radius(double latitude);  ///< N, m
/// Normal gravity at height, m/s^2: Somigliana closed form with the second-order height term (TR8350.2, 4-1 and 4-3).
double normal_gravity(double latitude, double height);

/// A coordinate reference system: "EPSG:32632", compound "EPSG:25832+7837" (also "EPSG:25832+EPSG:7837"), WKT, PROJ text.
class Crs {
 public:
  Crs() = default;
  /// Throws Error where PROJ does not know it; hint names the nearest remedy.
  explicit Crs(const std::string& definition);

  bool empty() const { return !state_; }
  std::string name() const;
  std::string wkt() const;    ///< WKT2:2019
  std::string wkt1() const;   ///< WKT1 GDAL form (LAS WKT VLR), falls back to WKT2 where WKT1 cannot hold it
  int epsg() const;           ///< code of the CRS (of its horizontal part where compound), 0 where it has none
  int vertical_epsg() const;  ///< code of the vertical part, 0 where none
  bool is_geographic() const;
  bool is_projected() const;
  bool is_geocentric() const;
  bool has_vertical() const;                ///< compound with a vertical part (heights over a geoid or a level)
  std::string vertical_name() const;        ///< vertical datum's name, or "ellipsoidal height"
  double metres_per_unit() const;           ///< of the horizontal axes (degrees: 0)
  double vertical_metres_per_unit() const;  ///< of heights
  std::string unit_name() const;
  std::string vertical_unit_name() const;
  /// Area of use in degrees; false where PROJ states none.
  bool area_of_use(double& west, double& south, double& east, double& north) const;
  /// Text that distinguishes this CRS, for fingerprints.
  std::string key() const { return wkt(); }

  struct State;
  const std::shared_ptr<const State>& state() const { return state_; }

 private:
  std::shared_ptr<const State> state_;
};

/// ECEF of WGS84, EPSG:4978.
Crs wgs84_ecef();
/// Geodetic WGS84 3D, EPSG:4979.
Crs wgs84_geodetic();

/// A transformation between two CRSs by PROJ, easting-northing axis order (longitude before latitude, degrees for geographic CRSs),
/// best available operation. Refuses ballpark operations and those whose grids are missing: Error names the grid file and how to get it.
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
  std::string description() const;  ///< of the operation PROJ chose
  double accuracy() const;          ///< stated by PROJ, m; negative where unknown

 private:
  struct State;
  explicit Transform(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace swath::core
