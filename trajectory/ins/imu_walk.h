// SPDX-License-Identifier: GPL-3.0-or-later
// Walks an IMU's record from instant to instant, forward or backward, cutting increments where an instant lies within one.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/records/imu_data.h"
#include "trajectory/ins/strapdown.h"

namespace swath::trajectory {

/// A gap in the record that is bridged.
struct BridgedGap {
  double start = 0.0, length = 0.0;            ///< GPS time, s
  double rate_sigma = 0.0, force_sigma = 0.0;  ///< by which the mean rate (rad/s) and specific force (m/s^2) may be off, whole gap
};

/// What bridges within an interval add to what is not known.
struct Bridging {
  double seconds = 0.0;
  double turn = 0.0, push = 0.0;  ///< variances of each component of attitude (rad^2) and velocity (m^2/s^2)
};

/// A record without holes: where it had some, increments by the mean of the neighbours' rates stand, marked as bridged.
struct ImuPath {
  core::ImuData imu;
  std::vector<std::uint8_t> bridged;  ///< per increment; empty where none is
  std::vector<BridgedGap> gaps;

  double begin() const { return imu.time.front() - imu.step.front(); }
  double end() const { return imu.time.back(); }
  double edge(size_t k) const { return k == 0 ? begin() : imu.time[k - 1]; }  ///< where increment k begins
  bool is_bridged(size_t k) const { return !bridged.empty() && bridged[k]; }
  /// Of the bridges, or parts of them, between two instants. The whole of one: (sigma length)^2; a part has its share by time.
  Bridging bridged_within(double t0, double t1) const;
};

/// Throws core::Error where a gap is longer than `max_gap`: its time, length and record. Steps become the differences of times.
ImuPath make_path(core::ImuData imu, double max_gap);

/// Where a walk stands. One per pass; needs the path to stay.
class ImuWalk {
 public:
  ImuWalk(const ImuPath& path, double time);
  double time() const { return time_; }
  /// The next piece on the way to `until` (on either side); false when there. Pieces shorter than 1e-6 s are passed over.
  bool next(double until, Increment& piece);
  size_t record() const { return k_; }

 private:
  const ImuPath* path_;
  size_t k_ = 0;
  double time_ = 0.0;
};

}  // namespace swath::trajectory
