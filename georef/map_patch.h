// SPDX-License-Identifier: GPL-3.0-or-later
// Earth-centred coordinates to map coordinates at the speed of a polynomial, kept to PROJ's result.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <vector>

#include "core/geo/geodesy.h"

namespace swath::georef {

/// ECEF is cut into cubes of 2048 m on a fixed lattice (corners at multiples of 2048 m from the Earth's centre). In each cube that holds a
/// point a trivariate cubic is fitted to PROJ and verified at 125 points that the fit has not seen, to 0.02 mm. A cube that does not keep
/// it (kinks of a geoid grid, edge of a domain) is cut in eight, down to 32 m; what still fails is left to PROJ point by point. The result
/// for a point depends on nothing but the point: not on other points, batches, order or threads.
class MapPatches {
 public:
  static constexpr double tolerance = 2e-5;      ///< m, kept at the check points
  static constexpr double cube_side = 2048.0;    ///< m
  static constexpr double smallest_side = 32.0;  ///< m

  /// Throws core::Error where PROJ has no operation from WGS 84 (EPSG:4978) to `map`.
  explicit MapPatches(const core::Crs& map);
  ~MapPatches();
  MapPatches(const MapPatches&) = delete;
  MapPatches& operator=(const MapPatches&) = delete;

  /// One cube: u = (p - centre) / half, map = sum of c[i] u_x^a u_y^b u_z^c over the exponents of `powers`.
  struct Patch {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    double half = 0.0;
    bool by_proj = false;  ///< no polynomial keeps the tolerance
    std::array<std::array<double, 20>, 3> c{};

    bool holds(double x, double y, double z) const {
      return x >= centre.x() - half && x < centre.x() + half && y >= centre.y() - half && y < centre.y() + half && z >= centre.z() - half &&
             z < centre.z() + half;
    }
    Eigen::Vector3d operator()(const Eigen::Vector3d& ecef) const;
    /// n points of this patch in place: map coordinates minus `origin`.
    void apply(double* x, double* y, double* z, size_t n, const Eigen::Vector3d& origin) const;
    /// Derivative of map with respect to ecef, CRS units per m.
    Eigen::Matrix3d gradient(const Eigen::Vector3d& ecef) const;
  };
  static const std::array<std::array<int, 3>, 20> powers;

  /// The patch of a point; made at the first call. Stays valid as long as this object. Safe from many threads.
  const Patch& patch(const Eigen::Vector3d& ecef) const;

  /// Map coordinates (CRS units) of n points in place; those without a finite result become NaN and are counted. Safe from many threads.
  size_t apply(double* x, double* y, double* z, size_t n) const;
  /// The same by PROJ for every point.
  size_t apply_proj(double* x, double* y, double* z, size_t n) const;

  Eigen::Vector3d operator()(const Eigen::Vector3d& ecef) const;
  /// Derivative of map with respect to ecef (by differences over 2 m where the patch is PROJ's).
  Eigen::Matrix3d gradient(const Eigen::Vector3d& ecef) const;

  /// Patches made so far: with a polynomial, left to PROJ.
  struct Made {
    size_t polynomial = 0, by_proj = 0;
  };
  Made made() const;

 private:
  using Key = std::array<std::int32_t, 4>;  // level, then the cube's number along x, y, z at that level
  struct Node;
  const Node& node(const Key& key) const;
  core::Transform borrow() const;
  void give_back(core::Transform t) const;
  Patch fit(const Eigen::Vector3d& centre, double half, const core::Transform& t, bool& good) const;

  bool keeps(const Patch& p, const std::vector<double>& lattice, const core::Transform& t) const;

  double horizontal_tolerance_, vertical_tolerance_;  // CRS units
  mutable std::shared_mutex nodes_mutex_;
  mutable std::map<Key, std::unique_ptr<const Node>> nodes_;
  mutable std::mutex pool_mutex_;
  mutable std::vector<core::Transform> pool_;
};

}  // namespace swath::georef
