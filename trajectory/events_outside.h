// SPDX-License-Identifier: GPL-3.0-or-later
// Events whose times do not fit the record that should cover them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/config/result.h"
#include "core/records/event_data.h"
#include "trajectory/trajectory.h"

namespace swath::trajectory {

/// A technique nearly all of whose events lie outside the record.
struct EventsOutside {
  std::string technique;
  std::uint64_t events = 0, outside = 0;
  Span span{}, record{};  ///< of the events and of the record, GPS time, s
  std::string what;       ///< with both spans in UTC
  std::string cause;      ///< what to look at: the usual mistake that explains it, or all of them
};

template <class V>
void describe(const EventsOutside& r, V& v) {
  v.result("technique", r.technique, "Name of the technique.");
  v.result("events", r.events, "Its events.");
  v.result("outside", r.outside, "Of those: events outside the record.");
  v.result("first_gps_s", r.span.first, core::seconds(), "GPS time of its first event.");
  v.result("last_gps_s", r.span.last, core::seconds(), "GPS time of its last event.");
  v.result("record_first_gps_s", r.record.first, core::seconds(), "GPS time at which the record begins.");
  v.result("record_last_gps_s", r.record.last, core::seconds(), "GPS time at which it ends.");
  v.result("sentence", r.what + ": " + r.cause, "Both spans in UTC, and the usual cause.");
}

/// Nothing where more than 10 % of the times (GPS time, s) lie within the record. `name`: of the record, "the trajectory".
std::optional<EventsOutside> outside_of(const std::string& technique, const std::vector<double>& times, const Span& record,
                                        const std::string& name);
/// The same of each technique.
std::vector<EventsOutside> outside_of(const core::EventData& events, const Span& record, const std::string& name);

}  // namespace swath::trajectory
