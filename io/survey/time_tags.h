// SPDX-License-Identifier: GPL-3.0-or-later
// How a file writes its times and angles.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "core/config/option.h"
#include "core/time.h"

namespace swath::io {

/// How instants are written in one file.
struct TimeTags {
  core::TimeScale scale = core::TimeScale::unstated;
  std::optional<int> week;
  std::string date;
  core::Seconds unit{1.0};
  std::string origin = {};
  double origin_at = 0.0;
  core::Seconds offset{0.0};
};

template <class V>
void describe(TimeTags& t, V& v) {
  v.option("scale", t.scale, "Scale of the file's times; a file whose scale is not stated is refused.");
  v.option("week", t.week, core::within(0, 10000), "GPS week of the first record (scale gps_week).");
  v.option("date", t.date, "UTC date of the first record, YYYY-MM-DD (scale utc_day).");
  v.option("unit", t.unit, core::above(0), "Length of one recorded unit of time, for files that do not count seconds (\"1 ms\").");
  v.option("origin", t.origin, "Instant of the device's zero or of `origin_at`: \"YYYY-MM-DDThh:mm:ss.sss GPS\" or UTC.");
  v.option("origin_at", t.origin_at, "Number that the device recorded at `origin`.");
  v.option("offset", t.offset, "Added to every time of the file.");
}

/// The reader of the file's times; with `week_column` only its in_week() has a meaning. Throws Error where the tags do not suffice.
core::TimeReader reader_of(const TimeTags& tags, std::string where, bool week_column = false);

enum class AngleUnit { unstated, deg, rad, gon };

/// rad per unit; 0 where unstated.
double radians_per(AngleUnit unit);

}  // namespace swath::io

namespace swath::core {
template <>
struct Choices<io::AngleUnit> {
  static constexpr std::array<std::string_view, 4> names{"unstated", "deg", "rad", "gon"};
};
}  // namespace swath::core
