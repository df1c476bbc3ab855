// SPDX-License-Identifier: GPL-3.0-or-later
// Events that are missing or recorded twice, by the pattern of their intervals.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/config/result.h"
#include "core/records/clock_data.h"
#include "core/report.h"

namespace swath::trajectory {

/// Where an interval breaks the pattern.
struct PatternBreak {
  size_t before = 0, after = 0;  ///< indices of the events around it
  double interval = 0.0;         ///< s
  size_t missing = 0;            ///< events that would fill it; 0: the two are one event recorded twice
};

struct EventPattern {
  double interval = 0.0;  ///< the usual one, s; 0: there is none
  size_t intervals = 0;   ///< between neighbours in time, breaks between lines left out
  size_t regular = 0;     ///< of those within a fifth of the usual one
  size_t missing = 0, doubles = 0;
  std::vector<PatternBreak> breaks{};
};

template <class V>
void describe(const EventPattern& r, V& v) {
  const auto known = core::plain().only_if(r.interval > 0);
  v.result("interval_s", r.interval, core::seconds().only_if(r.interval > 0),
           "Usual time between two events; left out where none is usual.");
  v.result("regular", r.regular, known, "Intervals within a fifth of it.");
  v.result("intervals", r.intervals, known, "Intervals, those between flight lines left out.");
  v.result("missing", r.missing, known, "Events that are missing by the pattern.");
  v.result("doubles", r.doubles, known, "Events recorded twice by the pattern.");
}

/// A pattern is there where most intervals, doubles aside, are within a fifth of their median. An interval near two to five times the usual
/// one lacks events; longer ones part flight lines. One below a fifth of it is an event recorded twice, also where every event is.
EventPattern pattern_of(const core::EventTags& events);

/// Counts missing and double events with their figures as examples.
void count_breaks(const core::EventTags& events, const EventPattern& pattern, core::Tally& tally);

}  // namespace swath::trajectory
