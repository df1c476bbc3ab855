// SPDX-License-Identifier: GPL-3.0-or-later
// Least squares of a polynomial of total degree 4 to 6 at Chebyshev nodes of the box, checked at 500 other points.
// Error: the stated `worst()` (near 1e-8 m for 3 km about the origin), refused above 2e-6 m.
#include "simulate/world/map_patch.h"

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "core/config/units.h"
#include "core/error.h"
#include "core/geo/map_axes.h"
#include "core/geo/map_scale.h"
#include "simulate/random.h"

namespace swath::simulate {
namespace {

constexpr double tolerance = 2e-6;  // m

/// Calls f(index, x^i y^j z^k) for i + j + k <= degree.
template <class F>
void for_each_term(int degree, const Eigen::Vector3d& u, F&& f) {
  std::array<double, 7> y{1.0}, z{1.0};
  for (size_t i = 1; i <= static_cast<size_t>(degree); ++i) {
    y[i] = y[i - 1] * u.y();
    z[i] = z[i - 1] * u.z();
  }
  size_t at = 0;
  double x = 1.0;
  for (int i = 0; i <= degree; ++i, x *= u.x())
    for (int j = 0; i + j <= degree; ++j) {
      const double xy = x * y[static_cast<size_t>(j)];
      for (int k = 0; i + j + k <= degree; ++k) f(at++, xy * z[static_cast<size_t>(k)]);
    }
}

int terms_of(int degree) { return (degree + 1) * (degree + 2) * (degree + 3) / 6; }

}  // namespace

MapPatch::MapPatch(const core::Crs& crs, const core::Geodetic& origin, double half, double low, double high) {
  if (!crs.is_projected() || std::abs(crs.metres_per_unit() - 1.0) > 1e-12 || std::abs(crs.vertical_metres_per_unit() - 1.0) > 1e-12)
    throw core::usage_error(
        "a survey is simulated in a projected CRS in metres, which " + crs.name() + " is not", "crs",
        "the UTM zone there: crs = \"" + core::utm_zone({core::to_degrees(origin.longitude), core::to_degrees(origin.latitude)}) + "\"");
  core::require_easting_northing(crs, "crs");
  const core::Transform map_T_ecef(core::wgs84_ecef(), crs);
  origin_ecef_ = core::ecef_of(origin);
  const Eigen::Matrix3d ecef_R_ned = core::ecef_R_ned(origin.latitude, origin.longitude);
  tangent_R_ecef_.row(0) = ecef_R_ned.col(1).transpose();
  tangent_R_ecef_.row(1) = ecef_R_ned.col(0).transpose();
  tangent_R_ecef_.row(2) = -ecef_R_ned.col(2).transpose();
  map_origin_ = map_T_ecef(origin_ecef_);
  map_origin_.z() = 0.0;

  // The patch bends down by half^2 / 2R from the tangent plane.
  const double bend = half * half / core::wgs84::b;
  centre_ = Eigen::Vector3d(0, 0, (low + high) / 2 - origin.height);
  scale_ = Eigen::Vector3d(half, half, (high - low) / 2 + bend + 1.0);

  std::vector<Eigen::Vector3d> nodes, checks;
  constexpr int n = 9, nz = 7;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < nz; ++k)
        nodes.emplace_back(std::cos(core::pi * (i + 0.5) / n), std::cos(core::pi * (j + 0.5) / n), std::cos(core::pi * (k + 0.5) / nz));
  Random random(0, 0, 0);
  for (int i = 0; i < 500; ++i) checks.emplace_back(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  const auto exact = [&](const Eigen::Vector3d& u) -> Eigen::Vector3d {
    return map_T_ecef(ecef_of(centre_ + scale_.cwiseProduct(u))) - map_origin_;
  };

  Eigen::MatrixXd b(nodes.size(), 3);
  for (size_t r = 0; r < nodes.size(); ++r) b.row(static_cast<Eigen::Index>(r)) = exact(nodes[r]).transpose();
  for (degree_ = 4; degree_ <= 6; ++degree_) {
    Eigen::MatrixXd A(nodes.size(), terms_of(degree_));
    for (size_t r = 0; r < nodes.size(); ++r)
      for_each_term(degree_, nodes[r], [&](size_t t, double v) { A(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(t)) = v; });
    const Eigen::MatrixXd c = A.householderQr().solve(b);
    for (int t = 0; t < terms_of(degree_); ++t) coefficients_[static_cast<size_t>(t)] = c.row(t).transpose();
    worst_ = 0.0;
    for (const Eigen::Vector3d& u : checks)
      worst_ = std::max(worst_, (map_of(centre_ + scale_.cwiseProduct(u)) - exact(u)).cwiseAbs().maxCoeff());
    if (worst_ <= tolerance) break;
  }
  if (!(worst_ <= tolerance))
    throw core::usage_error("the map is not smooth enough here to be simulated to 0.002 mm (a grid of heights or datum shifts?)", "crs",
                            "use a CRS with ellipsoidal heights, EPSG:32632 and the like");
  const Eigen::Vector3d north = map_of(Eigen::Vector3d(0, 10, 0)) - map_of(Eigen::Vector3d(0, -10, 0));
  convergence_ = -std::atan2(north.x(), north.y());
}

Eigen::Vector3d MapPatch::map_of(const Eigen::Vector3d& tangent) const {
  const Eigen::Vector3d u = (tangent - centre_).cwiseQuotient(scale_);
  Eigen::Vector3d out = Eigen::Vector3d::Zero();
  for_each_term(degree_, u, [&](size_t t, double v) { out += v * coefficients_[t]; });
  return out;
}

}  // namespace swath::simulate
