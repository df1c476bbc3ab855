// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/time_tags.h"

namespace swath::io {

core::TimeReader reader_of(const TimeTags& t, std::string where, bool week_column) {
  const core::TimeNumbers numbers{t.unit.value, t.offset.value, t.origin, t.origin_at};
  if (week_column) return {core::TimeScale::gps_week, 0, "", std::move(where), numbers};
  return {t.scale, t.week, t.date, std::move(where), numbers};
}

double radians_per(AngleUnit unit) {
  switch (unit) {
    case AngleUnit::unstated:
      return 0.0;
    case AngleUnit::deg:
      return core::degree;
    case AngleUnit::rad:
      return 1.0;
    case AngleUnit::gon:
      return core::pi / 200.0;
  }
  return 0.0;
}

}  // namespace swath::io
