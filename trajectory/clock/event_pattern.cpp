// SPDX-License-Identifier: GPL-3.0-or-later
// A camera that exposes by distance keeps its interval to some per cent along a line, one that exposes by time to milliseconds; a fifth
// lets both pass and still parts one interval from two.
#include "trajectory/clock/event_pattern.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <numeric>

#include "core/statistics.h"

namespace swath::trajectory {

namespace {

constexpr double pattern_closeness = 0.2;  // of the usual interval
constexpr double double_share = 0.2;       // shorter intervals are doubles
constexpr size_t longest_lack = 5;         // intervals; a longer break is the way to the next line
constexpr size_t fewest_intervals = 5;
constexpr double most_of = 0.5;

constexpr double all_twice = 0.4;  // of the intervals

bool is_close(double interval, double to) { return std::abs(interval - to) <= pattern_closeness * to; }

/// The median; where every second interval is many times as long, as when both edges of each pulse were recorded, that of the long ones.
double usual_interval(const std::vector<double>& steps) {
  const double middle = core::median(steps);
  std::vector<double> longer;
  std::copy_if(steps.begin(), steps.end(), std::back_inserter(longer), [&](double s) { return double_share * s > middle; });
  if (static_cast<double>(longer.size()) < all_twice * static_cast<double>(steps.size())) return middle;
  return core::median(longer);
}

}  // namespace

EventPattern pattern_of(const core::EventTags& events) {
  EventPattern out;
  std::vector<size_t> order(events.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return events.time[a] < events.time[b]; });
  std::vector<double> steps;
  for (size_t k = 1; k < order.size(); ++k) steps.push_back(events.time[order[k]] - events.time[order[k - 1]]);
  if (steps.size() < fewest_intervals) return out;
  const double usual = usual_interval(steps);
  out.intervals = static_cast<size_t>(
      std::count_if(steps.begin(), steps.end(), [&](double s) { return s < (static_cast<double>(longest_lack) + 0.5) * usual; }));
  out.regular = static_cast<size_t>(std::count_if(steps.begin(), steps.end(), [&](double s) { return is_close(s, usual); }));
  const auto twice = std::count_if(steps.begin(), steps.end(), [&](double s) { return s < double_share * usual; });
  if (static_cast<double>(out.regular) <= most_of * static_cast<double>(out.intervals - static_cast<size_t>(twice))) return out;
  out.interval = usual;
  for (size_t k = 1; k < order.size(); ++k) {
    const double step = steps[k - 1], times = std::round(step / usual);
    if (step < double_share * usual) {
      ++out.doubles;
      out.breaks.push_back({order[k - 1], order[k], step, 0});
    } else if (times >= 2 && times <= static_cast<double>(longest_lack) &&
               std::abs(step - times * usual) <= pattern_closeness * usual * std::sqrt(times)) {
      const auto missing = static_cast<size_t>(times) - 1;
      out.missing += missing;
      out.breaks.push_back({order[k - 1], order[k], step, missing});
    }
  }
  return out;
}

void count_breaks(const core::EventTags& events, const EventPattern& pattern, core::Tally& tally) {
  for (const PatternBreak& b : pattern.breaks) {
    char text[80];
    std::snprintf(text, sizeof text, ": %.3f s apart, %.3f s are usual", b.interval, pattern.interval);
    const std::string where = events.technique + " " + events.id[b.before] + " and " + events.id[b.after] + text;
    if (b.missing > 0)
      tally.count("events missing by the pattern of intervals", where, b.missing);
    else
      tally.count("events recorded twice by the pattern of intervals", where);
  }
}

}  // namespace swath::trajectory
