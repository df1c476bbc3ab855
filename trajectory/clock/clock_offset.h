// SPDX-License-Identifier: GPL-3.0-or-later
// How far the clocks of IMU and GNSS lie apart, and how late a receiver's velocities are, from the records alone.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "core/config/result.h"
#include "core/records/gnss_data.h"
#include "core/records/imu_spec.h"
#include "trajectory/ins/imu_walk.h"

namespace swath::trajectory {

/// An offset with its sigma, or the reason why there is none.
struct TimeOffset {
  bool determinable = false;
  std::string reason;            ///< why not; empty where it is
  double value = 0.0;            ///< s
  double sigma = 0.0;            ///< s; 0 where not determinable
  std::int64_t used = 0;         ///< instants compared
  double contrast = 0.0;         ///< the misfit falls by this share from its median over the search to its minimum
  Eigen::Vector3d rms{0, 0, 0};  ///< of what is left, north east down; m/s^2 (clocks), m/s (velocities)

  /// Larger than 4 sigma and `floor` (s).
  bool is_significant(double floor) const;
};

template <class V>
void describe(const TimeOffset& r, V& v) {
  const auto known = [&r](core::Form f) { return f.always().only_if(r.determinable); };
  v.result("determinable", r.determinable, "False: the records do not show it.");
  v.result("reason", r.reason, core::plain().only_if(!r.reason.empty()), "Why not, or what the answer rests on.");
  v.result("value_s", r.value, known(core::seconds(4)), "The offset.");
  v.result("sigma_s", r.sigma, known(core::seconds(4)), "Its sigma.");
  v.result("used", r.used, "Instants that were compared.");
  v.result("contrast", r.contrast, core::share(3).always(), "Share by which the misfit falls from its median to its minimum.");
}

/// What must be added to the fixes' times, or subtracted from those of the IMU, so that both records show the same motion.
///
/// Second differences of the fixes over 1, 2 and 4 s on either side, less gravity, are the specific force averaged by a triangle; the same
/// second differences of the twice integrated increments, lever arm included, are taken at times that lie apart by the offset. The span
/// whose answer has the smallest sigma is taken: short ones where the vehicle shakes, long ones in flight. Coarse: least sum of distances
/// over a grid of offsets, Wahba's problem solved in each window of 20 s. Fine: fit_clock() (trajectory/clock/clock_fit.h) about that,
/// twice: the second time with the sensors' errors of the first taken out of the records. Not determinable: fixes more than 3 s apart, no
/// change of motion (sigma over 20 ms), two offsets that fit alike, an offset at the search's end. `search`: s, either way.
TimeOffset imu_clock_offset(const ImuPath& path, const core::GnssData& gnss, const core::ImuErrorModel& spec,
                            const Eigen::Vector3d& lever_arm, double lever_arm_sigma, double search);

/// Do the fixes fit the IMU's records only when their times are moved by the leap seconds of their date? In words, for a hint; empty where
/// not.
std::string leap_seconds_between(const ImuPath& path, const core::GnssData& gnss, const core::ImuErrorModel& spec,
                                 const Eigen::Vector3d& lever_arm, double lever_arm_sigma);

/// How late the velocities are against the positions of the same fixes (positive: late): means of neighbouring velocities against
/// differences of positions.
TimeOffset velocity_lag(const core::GnssData& gnss);

/// Offsets that the survey states already, where they are the same for all files.
struct StatedClocks {
  std::optional<double> imu_offset, antenna_latency;  ///< s
};

/// What the clocks of the records show.
struct ClockFindings {
  TimeOffset imu;       ///< imu_clock_offset()
  TimeOffset velocity;  ///< velocity_lag()
  StatedClocks stated;

  bool apart() const { return imu.is_significant(0.002); }
  /// The velocities lag so much that they contradict the positions: 2 cm/s at 1 m/s^2.
  bool velocities_lag() const { return velocity.value > 0.0 && velocity.is_significant(0.02); }
  /// The offset and the values to state that take it out, in words.
  std::string advice() const;
};

/// With the values that take it out where they are stated in the survey.
struct ImuClock {
  const ClockFindings& clocks;
};

template <class V>
void describe(const ImuClock& r, V& v) {
  const auto& [imu, velocity, stated] = r.clocks;
  describe(imu, v);
  v.result("imu_time_offset_to_state_s", stated.imu_offset.value_or(0.0) - imu.value,
           core::seconds(4).only_if(imu.determinable && stated.imu_offset), "Offset in the time of [[imu]] that takes it out.");
  v.result("antenna_latency_to_state_s", stated.antenna_latency.value_or(0.0) + imu.value,
           core::seconds(4).only_if(imu.determinable && stated.antenna_latency), "Or: antenna.latency that takes it out.");
}

template <class V>
void describe(const ClockFindings& r, V& v) {
  v.table("imu_ahead_of_gnss", ImuClock{r}, "Offset of the IMU's clock against that of the fixes.");
  v.table("velocities_late", r.velocity, "Delay of the fixes' velocities against their positions.");
}

}  // namespace swath::trajectory
