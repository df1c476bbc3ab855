// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/records/gnss_data.h"
#include "core/report.h"
#include "io/survey/navigation.h"

namespace swath::io {

/// One fix as read. What a file does not state stays NaN.
struct Fix {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();
  double time = none;                                                     ///< GPS time without the antenna's latency, s
  Eigen::Vector3d position = Eigen::Vector3d::Constant(none);             ///< ecef, m
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Constant(none);           ///< ecef, m^2
  Eigen::Vector3d velocity = Eigen::Vector3d::Constant(none);             ///< ecef axes, m/s
  Eigen::Matrix3d velocity_covariance = Eigen::Matrix3d::Constant(none);  ///< ecef axes, (m/s)^2
  core::FixQuality quality = core::FixQuality::unknown;
  double satellites = 0;
  std::string fault = {}, hint = {};  ///< why the position cannot be one, where its reader knows
};

/// The kind of solution by RTKLIB's number (1 fixed, 2 float, 3 SBAS, 4 DGPS, 5 single, 6 PPP); unknown for others.
core::FixQuality quality_of_rtklib(double number);

/// A covariance of north, east, up at a place, in ecef.
Eigen::Matrix3d ecef_covariance(const Eigen::Matrix3d& north_east_up, double latitude, double longitude);
/// A vector north, east, up at a place, in ecef axes.
Eigen::Vector3d ecef_vector(const Eigen::Vector3d& north_east_up, double latitude, double longitude);

/// Gathers the fixes of one file and holds them to what fixes must keep.
class FixList {
 public:
  /// `latency`: of the antenna, s, added to every time. `may_go_back`: fixes whose time goes back are left out (a receiver that sets its
  /// clock), up to 3 % of them; otherwise they are an error.
  FixList(const GnssFile& file, std::string name, double latency, bool may_go_back, core::Tally& tally);

  /// `line`: of the file.
  void add(Fix fix, std::uint64_t line) {
    ++added_;
    read_.push_back({std::move(fix), line});
  }
  /// "file:line" of the fix that was added as the k-th, from 0.
  std::string place_of(size_t k) const { return place(read_[k]); }
  /// Times of all fixes, where they were added without; those of which it is NaN are left out.
  void set_times(const std::vector<double>& times);
  /// The fixes. Left out and counted: time or position not finite, a repeated time, a position not within 100 km of the ground, a sigma
  /// over 100 km, a time over an hour or a position over 500 m/s and 100 m from most fixes around it. Where the covariance is missing it
  /// comes from the survey's sigmas and the quality: stated for fixed and unknown, at least 0.1 m (PPP), 0.3 m (float), 1 m (differential,
  /// SBAS), 3 m (single) horizontally and twice that in height. One that is not positive definite is replaced by its diagonal or by those;
  /// counted. Counts fixes by quality, gaps, and steps faster than 500 m/s. Throws Error: no fix, time going back, over 3 % not finite or
  /// not near the ground, over 20 % repeated.
  core::GnssData finish();

 private:
  struct Read {
    Fix fix;
    std::uint64_t line;
  };
  std::string place(const Read& r) const { return name_ + ":" + std::to_string(r.line); }
  void leave_out_not_finite();
  void leave_out_wild();
  void take(const Read& read);
  Eigen::Matrix3d settled(const Eigen::Matrix3d& covariance, const Eigen::Matrix3d& ecef_R_neu, const Eigen::Vector3d& otherwise,
                          const char* of, const Read& read);

  const GnssFile& file_;
  std::string name_;
  double latency_;
  bool may_go_back_;
  core::Tally& tally_;
  core::GnssData out_;
  bool velocities_ = false, own_sigmas_ = false, lent_sigmas_ = false;
  std::vector<Read> read_;
  std::uint64_t added_ = 0, all_ = 0, not_finite_ = 0, without_sigma_ = 0, repeated_ = 0, back_ = 0;
};

}  // namespace swath::io
