// SPDX-License-Identifier: GPL-3.0-or-later
// Times of LAS files: what their numbers count, and whether they can.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/time.h"
#include "io/las_header.h"

namespace swath::io {

/// How times of a file become GPS time.
struct LasTime {
  std::optional<int> week = {};                       ///< GPS week of the first point, for seconds of week; roll-over is followed
  bool keep_unknown = false;                          ///< times of an unknown scale stay as they are, instead of an error
  core::TimeScale scale = core::TimeScale::unstated;  ///< in place of what the file's GPS time bit says; not `device`
  std::string date = {};                              ///< UTC date of the first point, YYYY-MM-DD (scale utc_day)
};

/// The scale that the file's times are on: the one stated, or by the file's GPS time bit. `unstated` where they are seconds of a week that
/// nothing names, and in formats without time.
core::TimeScale las_time_scale(const LasHeader& header, const LasTime& time);

/// Recorded times as GPS time. `first_time`: recorded time of the file's first point; `first`: row of the first of `recorded`.
/// Throws core::Error for a time that its scale cannot have, and where the scale is unknown and not to be kept.
std::vector<double> las_gps_times(const std::vector<double>& recorded, const LasHeader& header, const LasTime& time, double first_time,
                                  const std::string& where, std::uint64_t first);

/// Counts times that contradict what the file's GPS time bit says of them.
class LasTimeCheck {
 public:
  void add(const std::vector<double>& recorded);
  /// What is wrong, with the values and what to state; empty where nothing is. `scale`: the one stated, or unstated.
  std::string fault(const LasHeader& header, core::TimeScale scale) const;

 private:
  double low_ = 0.0, high_ = 0.0;
  std::uint64_t points_ = 0;
};

}  // namespace swath::io
