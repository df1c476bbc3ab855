// SPDX-License-Identifier: GPL-3.0-or-later
// Latency of a device from two time-tagged records of one motion.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "core/config/option.h"
#include "core/records/trajectory_data.h"
#include "trajectory/clock/motion.h"

namespace swath::trajectory {

/// A constant difference between the records that is estimated beside the latency.
enum class LatencyShift {
  none,
  axes,   ///< along the axes of the values: another datum, or a gyro's bias
  track,  ///< places: along the track, across it, up: another point of the carrier
};

struct LatencyOptions {
  core::Seconds search{2.0};
  LatencyShift shift = LatencyShift::none;
  core::Seconds smoothing{0.0};
};

template <class V>
void describe(LatencyOptions& o, V& v) {
  v.option("search", o.search, core::above(0), "Greatest latency, either way.");
  v.option("shift", o.shift, "Constant difference estimated as well: none, axes (of the values), track (along, across, up).");
  v.option("smoothing", o.smoothing, core::at_least(0),
           "Average both records over this time first; for turn rates, whose noise weakens derivatives.");
}

struct LatencyResult {
  bool determinable = false;
  std::string reason;               ///< why not, or what the answer rests on; may be empty
  double latency = 0.0;             ///< to be added to the device's times, s: value(device at t) = value(reference at t + latency)
  double sigma = 0.0;               ///< s; 0 where not determinable
  double coarse = 0.0;              ///< peak of the cross-correlation, s
  double correlation = 0.0;         ///< there, -1 to 1; 0 where the speed hardly changes and it says nothing
  size_t used = 0;                  ///< instants of the device within the reference
  size_t outliers = 0;              ///< of them down-weighted by more than half
  std::array<double, 3> shift{};    ///< device minus reference, unit of the values; by options.shift
  Eigen::Vector3d rms = {0, 0, 0};  ///< of the residuals per axis
  /// How many times the variance of the latency would grow if a shift along the axes, or along the track, were estimated too. Large:
  /// such a shift, where there is one, reads as latency (straight flight at one speed).
  double axes_inflation = 1.0, track_inflation = 1.0;
};

/// Coarse by the cross-correlation of speed, then robust least squares on the places (Huber, one scale per axis), the reference
/// interpolated by cubics. The sigma is that of the sum of each instant's pull on the answer, with their autocorrelation as far as it is
/// positive (Geyer 1992): it holds for errors that are white or correlated over times much shorter than the record (a twentieth, say), in
/// either record; a constant error is `shift`. Not determinable: see `reason`.
LatencyResult latency_of_places(const Motion& reference, const Motion& device, const LatencyOptions& options = {});

/// The same from turn rates, for example of the yaw rate of GNSS against that of an IMU. `shift` track counts as axes.
LatencyResult latency_of_rates(const Motion& reference, const Motion& device, const LatencyOptions& options = {});

/// A trajectory's places in north, east, down axes about `origin` (ecef), times from `epoch` (GPS time, s).
Motion places_of(const core::TrajectoryData& trajectory, const Eigen::Vector3d& origin, double epoch);

/// A trajectory's rate of heading, from its differences, times half-way; in x, rad/s.
Motion heading_rate_of(const core::TrajectoryData& trajectory, double epoch);

}  // namespace swath::trajectory

namespace swath::core {
template <>
struct Choices<trajectory::LatencyShift> {
  static constexpr std::array<std::string_view, 3> names{"none", "axes", "track"};
};
}  // namespace swath::core
