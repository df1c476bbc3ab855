// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/config/option.h"

namespace swath::core {

/// What kind of solution a fix is.
enum class FixQuality : std::uint8_t { unknown, fixed, float_ambiguity, ppp, differential, sbas, single };
template <>
struct Choices<FixQuality> {
  static constexpr std::array<std::string_view, 7> names{"unknown", "fixed", "float", "ppp", "differential", "sbas", "single"};
};

/// Positions of a GNSS antenna's phase centre. Columns of one length; velocity and its covariance may be empty.
struct GnssData {
  std::vector<double> time;                          ///< GPS time, s, rising
  std::vector<Eigen::Vector3d> position;             ///< ecef, m
  std::vector<Eigen::Matrix3d> covariance;           ///< of the position, ecef, m^2
  std::vector<Eigen::Vector3d> velocity;             ///< ecef axes, m/s; NaN where a fix has none
  std::vector<Eigen::Matrix3d> velocity_covariance;  ///< ecef, (m/s)^2
  std::vector<FixQuality> quality;
  std::vector<std::uint8_t> satellites;  ///< 0: not known

  size_t size() const { return time.size(); }
  bool has_velocity() const { return !velocity.empty(); }
};

}  // namespace swath::core
