// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "core/time.h"
#include "simulate/flight.h"
#include "simulate/options.h"
#include "simulate/world/map_patch.h"
#include "simulate/world/world.h"

namespace swath::simulate {

/// Returns as recorded, and the truth row by row.
struct Returns {
  // As recorded (before any calibration is applied).
  std::vector<double> time;     ///< GPS time, s
  std::vector<double> angle;    ///< rad
  std::vector<double> forward;  ///< x component of the unit beam
  std::vector<double> range;    ///< m
  std::vector<double> intensity, number, count, line;
  std::vector<double> positive, edge;  ///< 0 or 1: scan direction, edge of the scan
  // True values.
  std::vector<double> true_time, x, y, z;      ///< GPS time, s; ECEF, m
  std::vector<double> east, north, height;     ///< map, m
  std::vector<double> true_range;              ///< m
  std::vector<double> true_angle;              ///< a', rad
  std::vector<double> beam_x, beam_y, beam_z;  ///< unit vector of the beam in the scanner frame
  std::vector<double> kind;                    ///< ASPRS class

  size_t size() const { return time.size(); }
};

/// The one list of the columns: f(member pointer).
template <class F>
void for_each_column(F&& f) {
  using R = Returns;
  for (auto column : {&R::time,     &R::angle,      &R::forward,    &R::range,  &R::intensity, &R::number, &R::count, &R::line,
                      &R::positive, &R::edge,       &R::true_time,  &R::x,      &R::y,         &R::z,      &R::east,  &R::north,
                      &R::height,   &R::true_range, &R::true_angle, &R::beam_x, &R::beam_y,    &R::beam_z, &R::kind})
    f(column);
}

/// Adds the rows of `from`.
void append(Returns& to, const Returns& from);

/// Pulses of one line: each from its own random numbers, so that any split gives the same returns.
class Shooter {
 public:
  Shooter(const Options& options, const World& world, const MapPatch& map, const Flight& flight, core::GpsTime start);

  /// Pulses fired on the line.
  std::int64_t pulses(const Line& line) const;
  /// Appends the returns of pulses [first, last) of the line.
  void shoot(const Line& line, std::int64_t first, std::int64_t last, Returns& out) const;

 private:
  struct Beam;
  void pulse(const Line& line, std::int64_t number, Echoes& echoes, Returns& out) const;
  /// The pulse's beam; false where it never comes down.
  bool aim(const Line& line, std::int64_t number, Random& random, Beam& out) const;
  /// Outliers: an echo high above or below its place.
  void displace(const Beam& beam, Random& error, Echoes& echoes) const;
  /// What the instrument writes, beside the truth.
  void record(const Line& line, const Beam& beam, const Echoes& echoes, Random& error, Returns& out) const;

  const Options& options_;
  const World& world_;
  const MapPatch& map_;
  const Flight& flight_;
  core::GpsTime start_;
  Eigen::Matrix3d body_R_scanner_;
  Eigen::Vector3d lever_arm_;
};

}  // namespace swath::simulate
