// SPDX-License-Identifier: GPL-3.0-or-later
// The returns of a flight as moments of small cubes: enough to decide whether what a line saw in a cube is plane.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "calib/ties/local_points.h"
#include "calib/ties/tie_set.h"

namespace swath::calib {

/// A line that comes back after this time sees a place anew (conical scans: ahead and behind), s.
constexpr double new_look = 1.0;

/// Number, sum and sum of products of points about some origin.
template <class T>
struct Moments {
  std::uint32_t n = 0;
  Eigen::Matrix<T, 3, 1> sum = Eigen::Matrix<T, 3, 1>::Zero();
  T xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;

  void add(T x, T y, T z) {
    ++n;
    sum.x() += x, sum.y() += y, sum.z() += z;
    xx += x * x, xy += x * y, xz += x * z, yy += y * y, yz += y * z, zz += z * z;
  }
  Eigen::Vector3d mean() const { return sum.template cast<double>() / n; }
  /// Sum of products about the mean.
  Eigen::Matrix3d scatter() const {
    Eigen::Matrix3d s;
    s << static_cast<double>(xx), static_cast<double>(xy), static_cast<double>(xz), static_cast<double>(xy), static_cast<double>(yy),
        static_cast<double>(yz), static_cast<double>(xz), static_cast<double>(yz), static_cast<double>(zz);
    const Eigen::Vector3d m = mean();
    return s - n * m * m.transpose();
  }
};

/// The plane of a scatter matrix.
struct PlaneShape {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit, up (or north, or east where level)
  double rms = 0.0;                                   ///< across the plane, m
  double narrow = 0.0, wide = 0.0;                    ///< standard deviations in the plane, m
};
/// `freedom`: points less their means; the rms takes two more off for the plane's tilt.
PlaneShape shape_of(const Eigen::Matrix3d& scatter, double freedom);

struct CellIndex3 {
  std::int32_t i = 0, j = 0, k = 0;
  auto operator<=>(const CellIndex3&) const = default;
};
inline CellIndex3 cell_of(double x, double y, double z, double side) {
  return {static_cast<std::int32_t>(std::floor(x / side)), static_cast<std::int32_t>(std::floor(y / side)),
          static_cast<std::int32_t>(std::floor(z / side))};
}
inline Eigen::Vector3d centre_of(const CellIndex3& c, double side) { return Eigen::Vector3d(c.i + 0.5, c.j + 0.5, c.k + 0.5) * side; }
/// 21 bits of each.
inline std::uint64_t key_of(const CellIndex3& c) {
  constexpr std::uint64_t mask = (1u << 21) - 1;
  return (static_cast<std::uint64_t>(c.i) & mask) << 42 | (static_cast<std::uint64_t>(c.j) & mask) << 21 |
         (static_cast<std::uint64_t>(c.k) & mask);
}
inline std::uint64_t mixed(std::uint64_t v) {  // splitmix64's last step
  v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9ull;
  v = (v ^ (v >> 27)) * 0x94d049bb133111ebull;
  return v ^ (v >> 31);
}

/// What one line saw in a cell in one look.
struct CellLook {
  CellIndex3 cell;
  std::uint32_t line = 0;          ///< index into PlaneCells::lines
  double first = 0.0, last = 0.0;  ///< time as recorded, s
  Moments<float> moments;          ///< about the cell's centre, m
};

struct PlaneCells {
  double side = 0.0;            ///< m
  double density = 0.0;         ///< last returns of one line per m^2
  std::vector<TieLine> lines;   ///< by id
  std::vector<CellLook> looks;  ///< by cell, then line, then time
  std::uint64_t returns = 0;    ///< last returns with a place
};

constexpr std::uint32_t usual_fewest = 3;
/// Reads the stream once; looks of less than `fewest` returns in a cell are dropped. Without `side` the cell is so wide that a line leaves
/// ten returns on a level one, 1.5 to 5 m.
PlaneCells plane_cells(const ShotStream& stream, LocalPoints& points, std::optional<double> side, std::uint32_t fewest = usual_fewest);

}  // namespace swath::calib
