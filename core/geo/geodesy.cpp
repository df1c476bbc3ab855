// SPDX-License-Identifier: GPL-3.0-or-later
// The ellipsoid: NIMA TR8350.2 (3rd ed., 2000) and Bowring, "Transformation from spatial to geographical coordinates", Survey Review 23
// (1976), with the height of Bowring, "The accuracy of geodetic latitude and height equations", Survey Review 28 (1985). Deviation: the
// step is done twice; what is left is below 1e-11 m at any height of the header's range (one step leaves up to 1e-5 m in latitude at
// 10 000 km). Gravity: TR8350.2 eqs. 4-1 and 4-3; the cut of the height series is below 1e-6 m/s^2 to 20 km.
#include "core/geo/geodesy.h"

#include <cmath>

#include "core/geo/ellipsoid_normal.h"

namespace swath::core {

namespace {
constexpr double gravity_equator = 9.7803253359;   // TR8350.2 table 3.4, m/s^2
constexpr double somigliana_k = 0.00193185265241;  // TR8350.2 table 3.4
constexpr double gravity_m = wgs84::omega * wgs84::omega * wgs84::a * wgs84::a * wgs84::b / wgs84::gm;
constexpr double second_e2 = wgs84::e2 / (1.0 - wgs84::e2);

/// The direction of a place's normal in its meridian: c : s as cosine and sine of the latitude.
struct Meridian {
  double p, c, s;
};

Meridian meridian_of(const Eigen::Vector3d& ecef) {
  const double p = std::hypot(ecef.x(), ecef.y());
  const double z = ecef.z();
  const double r = std::sqrt(p * p + z * z);
  // Reduced latitude beta as (u, v) ~ (cos, sin); Bowring 1985 start, then tan(phi) = (z + e'^2 b sin^3 beta) / (p - e^2 a cos^3 beta).
  double u = p;
  double v = (1.0 - wgs84::f) * z * (1.0 + second_e2 * wgs84::b / r);
  double c = 1.0, s = 0.0;
  for (int step = 0; step < 2; ++step) {
    const double w = std::sqrt(u * u + v * v);
    const double cb = u / w, sb = v / w;
    c = p - wgs84::e2 * wgs84::a * cb * cb * cb;
    s = z + second_e2 * wgs84::b * sb * sb * sb;
    u = c;
    v = (1.0 - wgs84::f) * s;
  }
  return {p, c, s};
}

Eigen::Matrix3d ned_axes(double sl, double cl, double so, double co) {
  Eigen::Matrix3d R;
  R << -sl * co, -so, -cl * co,  //
      -sl * so, co, -cl * so,    //
      cl, 0.0, -sl;
  return R;
}

double gravity_by_sine(double s2, double height) {
  const double on_ellipsoid = gravity_equator * (1.0 + somigliana_k * s2) / std::sqrt(1.0 - wgs84::e2 * s2);  // 4-1
  const double h = height / wgs84::a;
  return on_ellipsoid * (1.0 - 2.0 * (1.0 + wgs84::f + gravity_m - 2.0 * wgs84::f * s2) * h + 3.0 * h * h);  // 4-3
}
}  // namespace

double prime_vertical_radius(double latitude) {
  const double s = std::sin(latitude);
  return wgs84::a / std::sqrt(1.0 - wgs84::e2 * s * s);
}

double meridian_radius(double latitude) {
  const double s = std::sin(latitude);
  const double w2 = 1.0 - wgs84::e2 * s * s;
  return wgs84::a * (1.0 - wgs84::e2) / (w2 * std::sqrt(w2));
}

Eigen::Vector3d ecef_of(const Geodetic& g) {
  const double s = std::sin(g.latitude), c = std::cos(g.latitude);
  const double n = wgs84::a / std::sqrt(1.0 - wgs84::e2 * s * s);
  return {(n + g.height) * c * std::cos(g.longitude), (n + g.height) * c * std::sin(g.longitude), (n * (1.0 - wgs84::e2) + g.height) * s};
}

Geodetic geodetic_of(const Eigen::Vector3d& ecef) {
  const auto [p, c, s] = meridian_of(ecef);
  Geodetic g;
  g.latitude = std::atan2(s, c);
  g.longitude = std::atan2(ecef.y(), ecef.x());
  const double w = std::sqrt(c * c + s * s);
  const double cp = c / w, sp = s / w;
  g.height = p * cp + ecef.z() * sp - wgs84::a * std::sqrt(1.0 - wgs84::e2 * sp * sp);
  return g;
}

EllipsoidNormal ellipsoid_normal(const Eigen::Vector3d& ecef) {
  const auto [p, c, s] = meridian_of(ecef);
  const double w = std::sqrt(c * c + s * s), cp = c / w, sp = s / w;
  const bool on_axis = p == 0.0;
  return {sp, cp, on_axis ? 0.0 : ecef.y() / p, on_axis ? 1.0 : ecef.x() / p,
          p * cp + ecef.z() * sp - wgs84::a * std::sqrt(1.0 - wgs84::e2 * sp * sp)};
}

Eigen::Matrix3d EllipsoidNormal::ecef_R_ned() const { return ned_axes(sin_latitude, cos_latitude, sin_longitude, cos_longitude); }

double EllipsoidNormal::gravity() const { return gravity_by_sine(sin_latitude * sin_latitude, height); }

Eigen::Matrix3d ecef_R_ned(double latitude, double longitude) {
  return ned_axes(std::sin(latitude), std::cos(latitude), std::sin(longitude), std::cos(longitude));
}

double normal_gravity(double latitude, double height) {
  const double s = std::sin(latitude);
  return gravity_by_sine(s * s, height);
}

}  // namespace swath::core
