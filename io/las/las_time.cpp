// SPDX-License-Identifier: GPL-3.0-or-later
// Source: ASPRS LAS Specification 1.4 R15 (2019), table 4 (GPS time type) and 2.6.9 (GPS time).
// Adjusted standard GPS time between 0 and 604 800 s would be of the week from 2011-09-14: taken for seconds of week when every time is.
#include "io/las/las_time.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/config/value.h"
#include "core/error.h"
#include "io/survey/wild_records.h"

namespace swath::io {
namespace {

using core::TimeScale;

constexpr double seconds_per_day = 86400.0;
constexpr double longest_week = 2.0 * core::seconds_per_week;  // files may count on past the end of the week

/// Numbers of a period (week, day) that begins anew: the periods to add so that they lie within half a one of the first time.
double turns(double t, double first_time, double period) {
  return t < first_time - period / 2 ? period : t > first_time + period / 2 ? -period : 0.0;
}

/// Makes times NaN that are not within 0 to `longest`, which is an error where they are not few in the file.
void keep_times(std::vector<double>& times, double longest, const char* what, LasTimesRead& read, const std::string& where,
                std::uint64_t first) {
  for (std::size_t i = 0; i < times.size(); ++i) {
    double& t = times[i];
    if (t >= 0.0 && t <= longest) {
      if (!read.first) read.first = t;
      continue;
    }
    ++read.impossible;
    if (!read.fault)
      read.fault.emplace("the time " + core::format_number(t) + " s is not " + what, where + ": point " + std::to_string(first + i),
                         "the file's times are on another scale: state it as points.time_scale in the survey");
    t = std::numeric_limits<double>::quiet_NaN();
  }
  if (read.impossible > 0 && !are_few(read.impossible, std::max<std::uint64_t>(read.points, times.size()))) throw core::Error(*read.fault);
}

}  // namespace

TimeScale las_time_scale(const LasHeader& header, const LasTime& time) {
  if (!las_layout(header.point_format)->gps) return TimeScale::unstated;
  const bool by_file = time.scale == TimeScale::unstated;
  if (by_file && header.gps_time_is_adjusted()) return TimeScale::gps_adjusted;
  if (by_file || time.scale == TimeScale::gps_week) return time.week ? TimeScale::gps_week : TimeScale::unstated;
  return time.scale;
}

std::vector<double> las_gps_times(const std::vector<double>& recorded, const LasHeader& header, const LasTime& time, LasTimesRead& read,
                                  const std::string& where, std::uint64_t first) {
  std::vector<double> out = recorded;
  const auto each = [&](auto&& f) {
    for (double& t : out)
      if (std::isfinite(t)) t = f(t);
  };
  switch (las_time_scale(header, time)) {
    case TimeScale::gps:
      break;
    case TimeScale::gps_adjusted:
      each([](double t) { return t + core::adjusted_offset; });
      break;
    case TimeScale::gps_week:
      keep_times(out, longest_week, "a second of a week", read, where, first);
      each([&](double t) { return *time.week * core::seconds_per_week + t + turns(t, *read.first, core::seconds_per_week); });
      break;
    case TimeScale::unix_utc:
      each([](double t) { return core::from_unix(t); });
      break;
    case TimeScale::utc_day: {
      const std::optional<double> midnight = core::unix_of_date(time.date);
      if (!midnight)
        throw core::Error("times are UTC seconds of a day that is not stated", where, "state the date of the first point as points.date");
      keep_times(out, 2.0 * seconds_per_day, "a second of a day", read, where, first);
      each([&](double t) { return core::from_unix(*midnight + t + turns(t, *read.first, seconds_per_day)); });
      break;
    }
    default:
      if (!time.keep_unknown && !out.empty())
        throw core::Error("times are seconds of a GPS week that the file does not name", where, "state the GPS week of the first point");
  }
  return out;
}

void LasTimeCheck::add(const std::vector<double>& recorded) {
  if (recorded.empty()) return;
  const auto [low, high] = std::minmax_element(recorded.begin(), recorded.end());
  low_ = points_ == 0 ? *low : std::min(low_, *low);
  high_ = points_ == 0 ? *high : std::max(high_, *high);
  points_ += recorded.size();
}

std::string LasTimeCheck::fault(const LasHeader& header, TimeScale scale) const {
  if (points_ == 0 || scale != TimeScale::unstated || (low_ == 0.0 && high_ == 0.0)) return {};
  const bool weekly = low_ >= 0.0 && high_ < longest_week;
  if (header.gps_time_is_adjusted() != weekly) return {};
  char span_text[96];
  std::snprintf(span_text, sizeof span_text, "%.3f to %.3f s", low_, high_);
  const std::string span = span_text;
  if (weekly)
    return "the GPS time bit says adjusted standard GPS time, but times of " + span +
           " look like seconds of the week; state points.time_scale";
  return "the GPS time bit says seconds of the week, but times are " + span +
         (low_ > longest_week ? ", as adjusted standard GPS time is" : "") + "; state points.time_scale";
}

}  // namespace swath::io
