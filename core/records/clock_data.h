// SPDX-License-Identifier: GPL-3.0-or-later
// Times by clocks that are not GPS time yet. A double holds GPS seconds of today to 0.24 us only, so these count from a whole second.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace swath::core {

/// How far a computer's clock stood from UTC. Columns of one length; `jitter` may be empty.
/// The clock's own time is given in the count of GPS: what GPS time would be if the clock were right.
struct ClockData {
  double epoch = 0.0;          ///< GPS time, whole seconds
  std::vector<double> time;    ///< by the clock, s since epoch, rising
  std::vector<double> offset;  ///< UTC - clock, s: to be added to what the clock shows
  std::vector<double> jitter;  ///< scatter of the offset as the log shows it, s
  bool steered = false;        ///< by these very records: the clock then answers to their errors (ntpd)

  size_t size() const { return time.size(); }
};

/// Events as one technique timed them. Columns of one length.
struct EventTags {
  std::string technique;
  bool computer_clock = false;               ///< times are the computer's, in the count of GPS as in ClockData, and not yet corrected
  double latency = 0.0;                      ///< to be added to every time, s
  double epoch = 0.0;                        ///< GPS time, whole seconds
  std::vector<double> time;                  ///< s since epoch
  std::vector<double> sigma;                 ///< of the time, s; 0: not known
  std::vector<std::string> id;               ///< name, or number from 1
  std::vector<std::int32_t> strip;           ///< 0: none
  std::vector<std::uint8_t> doubtful;        ///< 1: timed before its clock had settled, or where its log shows nothing
  std::vector<Eigen::Vector3d> place;        ///< that the recorder states for the antenna, ecef, m; NaN: none. Empty, or one per event
  std::vector<Eigen::Vector3d> place_sigma;  ///< north, east, down, m; as `place`

  size_t size() const { return time.size(); }
};

}  // namespace swath::core
