// SPDX-License-Identifier: GPL-3.0-or-later
// Impossible records of a series: their numbers, and how many of them a file may have.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/few.h"
#include "core/report.h"
#include "core/time.h"
#include "io/survey/time_tags.h"

namespace swath::io {

using core::are_few;

/// A reader that has met more impossible records than this stops at once where they cannot be few.
constexpr std::uint64_t max_looked_at = 300;

/// Numbers of the records that contradict more than half of the 5 before and the 5 after them in the file; none in a series of fewer than
/// five records. `contradict(i, j)`: symmetric.
template <class F>
std::vector<size_t> contradicted(size_t n, F&& contradict) {
  constexpr size_t reach = 5;
  std::vector<size_t> out;
  if (n < reach) return out;
  size_t last_jump = n;  // k: records k - 1 and k contradict one another
  size_t next = 1;
  for (size_t i = 0; i < n; ++i) {
    for (; next < n && next <= i + reach; ++next)
      if (contradict(next - 1, next)) last_jump = next;
    if (last_jump == n || last_jump + reach <= i) continue;  // none around: all of them agree
    const size_t first = i > reach ? i - reach : 0, end = std::min(n, i + reach + 1);
    size_t against = 0;
    for (size_t j = first; j < end; ++j) against += j != i && contradict(i, j);
    if (2 * against > end - first - 1) out.push_back(i);
  }
  return out;
}

/// Records whose time lies more than an hour from those around them. `time`: s, as recorded, finite; `period`: after which the numbers
/// begin anew, s; 0: never.
std::vector<size_t> wild_times(const std::vector<double>& time, double period = 0.0);

/// After which the numbers of a scale begin anew, s; 0: never.
double period_of(core::TimeScale scale);

/// Is it an instant between 1980-01-06 and 2100?
bool is_instant(double gps_time);
/// A hint for a time that is not one, by its size as recorded.
std::string scale_hint(double recorded);

/// GPS times of a file's records, whose weeks may have a column of their own (else empty). A time that is not finite, lies more than an
/// hour from those around it or is not of the stated scale becomes NaN and is counted as `what` with its place and value. Throws Error
/// where these are not few. `place`: of a record by its number, "file:line".
std::vector<double> gps_times(const TimeTags& tags, const std::string& name, const std::vector<double>& recorded,
                              const std::vector<double>& weeks, const std::string& what, core::Tally& tally,
                              const std::function<std::string(size_t)>& place = {});

/// Heights, m, between the deepest sea floor and what flies above the highest mountain with a laser.
constexpr double lowest_height = -12e3, highest_height = 20e3;

inline bool is_a_height(double metres) { return metres >= lowest_height && metres <= highest_height; }

/// A customary value for "no height" in tables and rasters that can state none. Any unit.
inline bool is_no_height(double value) { return value == -9999.0 || value == -32767.0 || value == -32768.0 || value == -99999.0; }

}  // namespace swath::io
