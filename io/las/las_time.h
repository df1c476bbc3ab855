// SPDX-License-Identifier: GPL-3.0-or-later
// Times of LAS files: what their numbers count, and whether they can.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/time.h"
#include "io/las/las_header.h"

namespace swath::io {

/// How times of a file become GPS time.
struct LasTime {
  std::optional<int> week = {};                       ///< GPS week of the first point, for seconds of week; roll-over is followed
  bool keep_unknown = false;                          ///< times of an unknown scale stay as they are, instead of an error
  core::TimeScale scale = core::TimeScale::unstated;  ///< in place of what the file's GPS time bit says; not `device`
  std::string date = {};                              ///< UTC date of the first point, YYYY-MM-DD (scale utc_day)
};

/// What the points of a file that were read so far say of its times.
struct LasTimesRead {
  std::uint64_t points = 0;               ///< of the whole file; 0: those of one call
  std::optional<double> first = {};       ///< recorded time of the first point whose time the scale can hold
  std::uint64_t impossible = 0;           ///< points whose time the scale cannot hold
  std::optional<core::Error> fault = {};  ///< that of the first of them
};

/// The scale that the file's times are on: the one stated, or by the file's GPS time bit. `unstated` where they are seconds of a week that
/// nothing names, and in formats without time.
core::TimeScale las_time_scale(const LasHeader& header, const LasTime& time);

/// Recorded times as GPS time. `read`: carried from call to call through a file; `first`: row of the first of `recorded`. A time that the
/// scale cannot hold becomes NaN. Throws core::Error where the file has more of these than are few (io/survey/wild_records.h), and where
/// the scale is unknown and not to be kept.
std::vector<double> las_gps_times(const std::vector<double>& recorded, const LasHeader& header, const LasTime& time, LasTimesRead& read,
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
