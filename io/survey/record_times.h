// SPDX-License-Identifier: GPL-3.0-or-later
// The times of records that come at a rate: their step, their gaps, their jitter.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/report.h"

namespace swath::io {

/// How a series of times advances.
struct Cadence {
  double step = 0.0;             ///< mean of the differences, those of gaps excepted, s
  double jitter = 0.0;           ///< rms of the times about an even advance, s
  double largest_jitter = 0.0;   ///< the largest distance from it, s
  bool smoothed = false;         ///< the times were replaced
  std::vector<size_t> restarts;  ///< k > 0: records are missing between k-1 and k
};

/// What settle_times() does.
struct CadenceRule {
  std::optional<double> step;  ///< s, where it is stated
  bool smooth = true;          ///< times that jitter by more than 1 % of the step are smoothed
  bool strict = false;         ///< a gap may be shorter than half a step (see settle_times)
};

/// Finds step, gaps and jitter of rising times, and takes the jitter out. A gap is a difference of more than 1.5 steps, unless the next
/// records are early again (one that was stamped late). With `strict` it is a difference longer than the step by more than twice what 99 %
/// of them deviate by, at least by 2 % and at most by half of a step: of increments it is known what they cover. Jitter is that of stamps
/// rounded or given on reception: each time is replaced by the straight line through it and up to 50 neighbours on either side within
/// its stretch, which leaves a drifting clock alone and keeps the sum of the steps; times that jitter less are left as they are.
/// Throws Error where a stated step is not that of the times within a tenth.
Cadence settle_times(std::vector<double>& time, const CadenceRule& rule, const std::string& name);

/// Counts gaps under `what` with the longest as examples: `from` and `to` bound the missing stretches, GPS time.
void count_gaps(const std::vector<double>& from, const std::vector<double>& to, const std::string& what, core::Tally& tally);

/// Counts a file whose first record lies before 2000, as a receiver's does whose week number rolled over at 1024.
void note_date(double first, const std::string& name, core::Tally& tally);

}  // namespace swath::io
