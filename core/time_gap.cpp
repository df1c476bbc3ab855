// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/time_gap.h"

#include <cmath>

#include "core/config/units.h"
#include "core/time.h"

namespace swath::core {
namespace {

constexpr double day = 86400.0;
constexpr double adjusted = 1e9;             // adjusted standard GPS time counts from here
constexpr double gps_of_unix = 315964800.0;  // Unix time of GPS's beginning
constexpr double longest = 10 * 3600.0;      // s: records as long as a day fit any number of days

bool near(double apart, double mistake, double length) { return std::abs(std::abs(apart) - mistake) <= length; }

}  // namespace

std::string usual_time_gap(double apart, double length) {
  if (!(length < longest)) return {};
  if (near(apart, adjusted, length)) return "they are 1e9 s apart: GPS time and adjusted standard GPS time taken for one another?";
  if (near(apart, gps_of_unix, length)) return "they are as far apart as the beginnings of Unix and GPS time: one taken for the other?";
  const double weeks = std::round(std::abs(apart) / seconds_per_week), days = std::round(std::abs(apart) / day);
  if (weeks > 0 && near(apart, weeks * seconds_per_week, length))
    return "they are " + counted(static_cast<std::uint64_t>(weeks), "week") + " apart: check time.week of both";
  if (days > 0 && days < 7 && near(apart, days * day, length))
    return "they are " + counted(static_cast<std::uint64_t>(days), "day") + " apart: seconds of the day stated as seconds of the week?";
  return {};
}

}  // namespace swath::core
