// SPDX-License-Identifier: GPL-3.0-or-later
// Latency of a device from two time-tagged records of one motion.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "core/config/option.h"
#include "core/config/result.h"
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

template <class V>
void describe(const LatencyResult& r, V& v) {
  const auto solved = core::plain().only_if(r.used > 0), known = core::plain().only_if(r.determinable);
  v.result("determinable", r.determinable, core::plain().in_summary(), "Whether the motion determines the latency.");
  v.result("reason", r.reason, core::plain().only_if(!r.reason.empty()).in_summary(), "Why not, or what the answer rests on.");
  v.result("latency_s", r.latency, core::seconds(6).only_if(r.determinable).in_summary(), "To be added to the device's times.");
  v.result("sigma_s", r.sigma, core::seconds(6).only_if(r.determinable).in_summary(), "Its sigma.");
  v.result("correlation", r.correlation, core::plain(3), "Peak of the cross-correlation of speed; 0 where the speed hardly changes.");
  v.result("used", r.used, "Instants of the device within the reference.");
  v.result("outliers", r.outliers, solved, "Of those: instants that have less than half of their weight.");
  v.result("shift", r.shift, known, "Constant shift estimated beside it: axes, or along, across, up.");
  v.result("rms", r.rms, solved, "RMS residual: north, east, down.");
  v.result("inflation_by_axes", r.axes_inflation, solved, "Growth of the latency's variance by a shift along the axes.");
  v.result("inflation_by_track", r.track_inflation, solved, "Growth of it by a shift along the track.");
}

/// Coarse by the cross-correlation of speed, then robust least squares on the places (Huber, one scale per axis), the reference
/// interpolated by cubics. The sigma is that of the sum of each instant's pull on the answer, with their autocorrelation as far as it is
/// positive (Geyer 1992): it holds for errors that are white or correlated over times much shorter than the record (a twentieth, say), in
/// either record; a constant error is `shift`. Not determinable: see `reason`.
LatencyResult latency_of_places(const Motion& reference, const Motion& device, const LatencyOptions& options = {});

/// The same from turn rates, for example of the yaw rate of GNSS against that of an IMU. `shift` track counts as axes.
LatencyResult latency_of_rates(const Motion& reference, const Motion& device, const LatencyOptions& options = {});

/// Places in north, east, down axes about `origin` (all ecef, m), times from `epoch` (GPS time, s). Places that are not finite are left
/// out.
Motion places_of(const std::vector<double>& time, const std::vector<Eigen::Vector3d>& place, const Eigen::Vector3d& origin, double epoch);

}  // namespace swath::trajectory

namespace swath::core {
template <>
struct Choices<trajectory::LatencyShift> {
  static constexpr std::array<std::string_view, 3> names{"none", "axes", "track"};
};
}  // namespace swath::core
