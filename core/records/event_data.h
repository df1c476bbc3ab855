// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace swath::core {

/// Instants that devices marked: camera exposures, pulses. Columns of one length.
struct EventData {
  std::vector<double> time;                         ///< GPS time, s
  std::vector<double> sigma;                        ///< of the time, s; 0: not known
  std::vector<std::string> id;                      ///< name, or number from 1
  std::vector<std::int32_t> strip;                  ///< 0: none
  std::vector<std::string> technique;               ///< which clock or device timed it
  std::vector<std::uint8_t> doubtful;               ///< 1: timed before its clock had settled, or outside the clock's log
  std::vector<Eigen::Vector3d> place, place_sigma;  ///< as in EventTags, one per event; NaN: none

  size_t size() const { return time.size(); }
};

}  // namespace swath::core
