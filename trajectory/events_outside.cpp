// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/events_outside.h"

#include <algorithm>
#include <map>

#include "core/time.h"
#include "core/time_gap.h"

namespace swath::trajectory {
namespace {

constexpr double nearly_all = 0.9;

std::string in_utc(const Span& s) { return "from " + core::utc_text(s.first) + " to " + core::utc_text(s.last); }

std::string cause_of(const Span& events, const Span& record) {
  const double apart = 0.5 * (events.first + events.last - record.first - record.last);
  const std::string usual = core::usual_time_gap(apart, events.last - events.first + record.last - record.first);
  if (!usual.empty()) return usual;
  return "compare time scale, week, date and time zone of both (GPS time is " + std::to_string(core::gps_minus_utc_at_gps(record.first)) +
         " s ahead of UTC)";
}

}  // namespace

std::optional<EventsOutside> outside_of(const std::string& technique, const std::vector<double>& times, const Span& record,
                                        const std::string& name) {
  if (times.empty()) return std::nullopt;
  const auto outside = std::count_if(times.begin(), times.end(), [&](double t) { return !(t >= record.first && t <= record.last); });
  if (static_cast<double>(outside) < nearly_all * static_cast<double>(times.size())) return std::nullopt;
  const auto [first, last] = std::minmax_element(times.begin(), times.end());
  EventsOutside out{technique, times.size(), static_cast<std::uint64_t>(outside), {*first, *last}, record, {}, {}};
  const std::string which = out.events == 1             ? "the only event"
                            : out.outside == out.events ? "all " + std::to_string(out.events) + " events"
                                                        : std::to_string(out.outside) + " of " + std::to_string(out.events) + " events";
  out.what = which + (technique.empty() ? "" : " of '" + technique + "'") + (out.outside == 1 ? " lies" : " lie") + " outside " + name +
             ": events " + in_utc(out.span) + ", " + name + " " + in_utc(record);
  out.cause = cause_of(out.span, record);
  return out;
}

std::vector<EventsOutside> outside_of(const core::EventData& events, const Span& record, const std::string& name) {
  std::map<std::string, std::vector<double>> by_technique;
  for (size_t i = 0; i < events.size(); ++i) by_technique[events.technique[i]].push_back(events.time[i]);
  std::vector<EventsOutside> out;
  for (const auto& [technique, times] : by_technique)
    if (auto one = outside_of(technique, times, record, name)) out.push_back(std::move(*one));
  return out;
}

}  // namespace swath::trajectory
