// SPDX-License-Identifier: GPL-3.0-or-later
// How a file writes its times and angles.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "core/option.h"
#include "core/time.h"

namespace swath::io {

/// How instants are written in one file.
struct TimeTags {
  core::TimeScale scale = core::TimeScale::unstated;
  std::optional<int> week;
  std::string date;
};

template <class V>
void describe(TimeTags& t, V& v) {
  v.option("scale", t.scale, "Scale of the file's times; a file whose scale is not stated is refused.");
  v.option("week", t.week, core::within(0, 10000), "GPS week of the first record (scale gps_week).");
  v.option("date", t.date, "UTC date of the first record, YYYY-MM-DD (scale utc_day).");
}

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
