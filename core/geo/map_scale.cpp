// SPDX-License-Identifier: GPL-3.0-or-later
// Snyder, Map Projections - A Working Manual (USGS Professional Paper 1395, 1987), chapter 4: Tissot's indicatrix, by central differences
// of the inverse projection in geocentric coordinates, whose error is below 1e-9. PROJ's own proj_factors() (9.1) is wrong by the unit of
// the map in feet, and where the base is in grads or counts from another meridian than Greenwich; geocentric differences also hold at
// poles.
#include "core/geo/map_scale.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/config/units.h"
#include "core/geo/proj_handles.h"

namespace swath::core {
namespace {

/// From -180 to less than 180.
double wrapped(double degrees) {
  const double v = std::fmod(degrees + 180.0, 360.0);
  return (v < 0.0 ? v + 360.0 : v) - 180.0;
}

/// A projected CRS and what is needed of the degrees, grads ... that lie under it.
struct Map {
  ProjContext context = new_proj_context();
  Pj crs, to_base;
  double radians_per_unit = degree, meridian = 0.0;  ///< of the base CRS; its prime meridian, rad from Greenwich
  double axis = 0.0, eccentricity2 = 0.0;            ///< of its ellipsoid
};

std::optional<Map> map_of(const Crs& crs) {
  if (crs.empty() || !crs.is_projected()) return std::nullopt;
  Map m;
  PJ_CONTEXT* c = m.context.get();
  m.crs = parse_crs(c, crs.facts().horizontal_wkt);
  while (m.crs && proj_get_type(m.crs.get()) == PJ_TYPE_BOUND_CRS) m.crs = Pj(proj_get_source_crs(c, m.crs.get()));
  if (!m.crs || proj_get_type(m.crs.get()) != PJ_TYPE_PROJECTED_CRS) return std::nullopt;
  const Pj base(proj_crs_get_geodetic_crs(c, m.crs.get()));
  if (!base) return std::nullopt;
  const Pj there(proj_create_crs_to_crs_from_pj(c, m.crs.get(), base.get(), nullptr, nullptr));
  if (there) m.to_base = Pj(proj_normalize_for_visualization(c, there.get()));
  if (!m.to_base) return std::nullopt;
  if (const Pj axes(proj_crs_get_coordinate_system(c, base.get())); axes)
    proj_cs_get_axis_info(c, axes.get(), 0, nullptr, nullptr, nullptr, &m.radians_per_unit, nullptr, nullptr, nullptr);
  double longitude = 0.0, unit = degree;
  if (const Pj prime(proj_get_prime_meridian(c, base.get())); prime)
    if (proj_prime_meridian_get_parameters(c, prime.get(), &longitude, &unit, nullptr)) m.meridian = longitude * unit;
  double minor = 0.0;
  const Pj ellipsoid(proj_get_ellipsoid(c, base.get()));
  if (!ellipsoid || !proj_ellipsoid_get_parameters(c, ellipsoid.get(), &m.axis, &minor, nullptr, nullptr)) return std::nullopt;
  m.eccentricity2 = 1.0 - minor * minor / (m.axis * m.axis);
  return m;
}

/// Longitude and latitude in the base CRS, rad.
std::optional<Eigen::Vector2d> base_place(const Map& m, const Eigen::Vector2d& at) {
  const PJ_COORD p = proj_trans(m.to_base.get(), PJ_FWD, proj_coord(at.x(), at.y(), 0.0, HUGE_VAL));
  const Eigen::Vector2d out(p.xy.x * m.radians_per_unit, p.xy.y * m.radians_per_unit);
  if (!out.allFinite()) return std::nullopt;
  return out;
}

/// On the ellipsoid, m; NaN where there is no such place.
Eigen::Vector3d geocentric(const Map& m, const Eigen::Vector2d& at) {
  const auto base = base_place(m, at);
  if (!base) return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  const double s = std::sin(base->y()), c = std::cos(base->y()), normal = m.axis / std::sqrt(1.0 - m.eccentricity2 * s * s);
  return {normal * c * std::cos(base->x()), normal * c * std::sin(base->x()), normal * (1.0 - m.eccentricity2) * s};
}

}  // namespace

std::optional<Place> place_on_earth(const Crs& map, const Eigen::Vector2d& at) {
  const std::optional<Map> m = map_of(map);
  const auto base = m ? base_place(*m, at) : std::nullopt;
  if (!base) return std::nullopt;
  return Place{wrapped((base->x() + m->meridian) / degree), base->y() / degree};
}

std::optional<MapScale> map_scale(const Crs& map, const Eigen::Vector2d& at) {
  const std::optional<Map> m = map_of(map);
  if (!m) return std::nullopt;
  constexpr double step = 100.0;  // m on the map, either way
  const double unit = map.metres_per_unit(), h = step / unit;
  Eigen::Matrix<double, 3, 2> ground_by_map;
  ground_by_map.col(0) = (geocentric(*m, at + Eigen::Vector2d(h, 0)) - geocentric(*m, at - Eigen::Vector2d(h, 0))) / (2.0 * step);
  ground_by_map.col(1) = (geocentric(*m, at + Eigen::Vector2d(0, h)) - geocentric(*m, at - Eigen::Vector2d(0, h))) / (2.0 * step);
  if (!ground_by_map.allFinite()) return std::nullopt;
  const Eigen::Matrix2d squares = ground_by_map.transpose() * ground_by_map;
  const Eigen::Vector2d found = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(squares).eigenvalues();  // ascending
  if (!(found[0] > 0.0)) return std::nullopt;
  return MapScale{1.0 / std::sqrt(found[1]), 1.0 / std::sqrt(found[0])};
}

double degrees_outside(const Crs& crs, const Place& place) {
  double west = 0, south = 0, east = 0, north = 0;
  if (crs.empty() || !crs.area_of_use(west, south, east, north)) return 0.0;
  const auto turned = [](double degrees) { return wrapped(degrees - 180.0) + 180.0; };  // from 0 to less than 360
  // Around the globe: longitude 180 is longitude -180.
  const double width = east - west >= 360.0 ? 360.0 : turned(east - west), from_west = turned(place.longitude - west);
  const double across = from_west <= width ? 0.0 : std::min(from_west - width, 360.0 - from_west);
  return std::max({across, south - place.latitude, place.latitude - north, 0.0});
}

std::string utm_zone(const Place& place, const Crs& datum) {
  if (!(std::isfinite(place.longitude) && std::abs(place.latitude) <= 84.0)) return "EPSG:326xx";
  const int zone = std::clamp(static_cast<int>(std::floor((wrapped(place.longitude) + 180.0) / 6.0)) + 1, 1, 60);
  const bool is_etrs = !datum.empty() && datum.name().starts_with("ETRS89");
  if (is_etrs && place.latitude > 0.0 && zone >= 28 && zone <= 38) return "EPSG:258" + std::to_string(zone);
  return "EPSG:" + std::to_string((place.latitude < 0.0 ? 32700 : 32600) + zone);
}

}  // namespace swath::core
