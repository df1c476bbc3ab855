// SPDX-License-Identifier: GPL-3.0-or-later
// Planes that several flight lines have seen, with the raw returns on them: what ties the lines to one another.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "trajectory/fix_window.h"

namespace swath::calib {

enum class TieKind : std::uint8_t {
  ground,  ///< level within 5 deg, or not standing out of its surroundings
  roof,    ///< sloping facet
  wall,    ///< steeper than 60 deg
  target,  ///< surveyed
};
std::string_view name_of(TieKind kind);

/// A point that is known to lie on a plane: the plane passes it within sigma along the plane's normal.
struct PlaneControl {
  Eigen::Vector3d point;  ///< local frame, m
  double sigma;           ///< m, along the normal
  std::string name;       ///< of the surveyed point, for messages
};

/// A plane as first found. While it is adjusted: normal . (p - centre) = d0 + d1 (u . (p - centre)) + d2 (v . (p - centre)), with the axes
/// u, v of plane_axes(normal) and the unknowns d0 (m), d1, d2.
struct TiePlane {
  Eigen::Vector3d centre;         ///< local frame (east, north, up), m: mean of its returns
  Eigen::Vector3d normal;         ///< unit, towards the scanner
  Eigen::Vector2d half = {0, 0};  ///< half extent along u and v, m
  double roughness = 0.0;         ///< rms of the returns of single lines about a plane of their own, m
  TieKind kind = TieKind::ground;
  std::string name;                   ///< of a surveyed target; empty for those found
  std::vector<PlaneControl> control;  ///< empty where nothing was surveyed
};
/// Unit vectors u, v in the plane; u, v, normal are right-handed. u is horizontal; for a level plane u is east.
std::array<Eigen::Vector3d, 2> plane_axes(const Eigen::Vector3d& normal);

/// A flight line as its returns show it.
struct TieLine {
  int id = 0;
  double first = 0.0, last = 0.0;  ///< GPS time of its returns (latency not added), s
};

/// Returns [begin, end) of one line on one plane, in the order of time. A line that passes a plane twice (conical scans: ahead and behind)
/// makes two groups.
struct TieGroup {
  std::uint32_t plane = 0;
  std::uint32_t line = 0;  ///< index into TieSet::lines
  std::uint32_t begin = 0, end = 0;
};

/// Columns of raw returns, as recorded (calib::Return with its time).
struct TieReturns {
  std::vector<double> time;     ///< GPS time of the record, s, before latency
  std::vector<double> angle;    ///< rad
  std::vector<double> forward;  ///< x of the unit beam
  std::vector<double> range;    ///< m

  size_t size() const { return time.size(); }
};

struct TieSet {
  trajectory::LocalFrame frame;  ///< of all planes; its origin lies in the block
  std::vector<TieLine> lines;    ///< by id
  std::vector<TiePlane> planes;
  std::vector<TieGroup> groups;  ///< by plane, then line
  TieReturns returns;            ///< group after group
};

}  // namespace swath::calib
