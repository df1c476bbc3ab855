// SPDX-License-Identifier: GPL-3.0-or-later
// Time scales. Inside everything is GPS time: seconds since 1980-01-06T00:00:00 GPS, continuous, in a double
// (resolution 0.12 us until 2014-01-21, 0.24 us until 2048: a shot is placed to 15 um at 60 m/s).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/config/option.h"

namespace swath::core {

/// Seconds since the GPS epoch, 1980-01-06T00:00:00 (UTC and GPS alike). Before it GPS - UTC counts as 0.
using GpsTime = double;

constexpr double seconds_per_week = 604800.0;
constexpr double adjusted_offset = 1.0e9;  ///< adjusted standard GPS time = GPS seconds - 1e9 (LAS 1.4)

/// How the times of a file are written.
enum class TimeScale {
  unstated,      ///< an error wherever a time is read
  gps,           ///< seconds since 1980-01-06, continuous
  gps_adjusted,  ///< GPS seconds - 1e9
  gps_week,      ///< seconds of week; the week of the first record is stated; roll-over is followed
  unix_utc,      ///< seconds since 1970-01-01 UTC, leap seconds not counted (POSIX)
  utc_day,       ///< UTC seconds of day; the date of the first record is stated; midnight is followed
  device,        ///< counted from an instant of the device's own; the instant of one recorded number is stated
};

template <>
struct Choices<TimeScale> {
  static constexpr std::array<std::string_view, 7> names{"unstated", "gps", "gps_adjusted", "gps_week", "unix", "utc_day", "device"};
};

/// GPS - UTC in seconds at an instant of UTC (POSIX seconds). Table up to the announcement valid at `leap_table_date()`.
int gps_minus_utc_at_unix(double unix_seconds);
/// The same at an instant of GPS time.
int gps_minus_utc_at_gps(GpsTime t);
/// Date to which the inner leap-second table is known to be complete, "2026-06-28" form.
std::string_view leap_table_date();

GpsTime from_unix(double unix_seconds);
/// Inverse of from_unix; an inserted second has the numbers of the second after it, as in POSIX.
double to_unix(GpsTime t);
GpsTime from_week(int week, double seconds_of_week);
int week_of(GpsTime t);
double seconds_of_week(GpsTime t);
/// POSIX seconds at 00:00 UTC of a civil date "2009-03-31", or nothing where the text is no date.
std::optional<double> unix_of_date(std::string_view date);
/// A civil instant, "2025-07-08T19:34:18.5 GPS", "2025-07-08 19:34:00.5 UTC" or "2025-07-08T19:34:00.5Z"; nothing where the text is none.
/// Second 60 is an inserted second (UTC).
std::optional<GpsTime> gps_of_civil(std::string_view text);
/// The same of a date "2025-07-08" and the seconds of its day, by a calendar that runs with GPS time.
std::optional<GpsTime> gps_of_gps_date(std::string_view date, double second_of_day);
/// "2024-06-07T11:40:06.002Z" (UTC, rounded to 1 ms); an inserted leap second is "23:59:60".
std::string utc_text(GpsTime t);

/// What the numbers of a file are beside their scale.
struct TimeNumbers {
  double unit = 1.0;             ///< s per recorded unit
  double offset = 0.0;           ///< s, added to every instant
  std::string_view origin = {};  ///< scale `device`: the instant at `origin_at`, as gps_of_civil() reads it
  double origin_at = 0.0;        ///< recorded number at `origin`
};

/// Converts the times of one file, in file order: follows week roll-over and midnight, where the numbers fall by more than half a
/// period, and back again for a late record of before. Files that count on past the end of the week or day are read as they stand.
/// Not seen: a gap of more than half a period that crosses the boundary (it reads as a late record or as none).
/// Throws Error where the scale is unstated or its week/date/origin is missing, and for a time that is not finite or outside its scale
/// (0 to two weeks or days).
class TimeReader {
 public:
  /// `week`: for gps_week; `date`: "YYYY-MM-DD" for utc_day; `where` names the file in errors.
  TimeReader(TimeScale scale, std::optional<int> week, std::string_view date, std::string where, const TimeNumbers& numbers = {});
  GpsTime operator()(double recorded);
  /// An instant whose GPS week has a column of its own. Throws Error for a time outside of two weeks.
  GpsTime in_week(int week, double recorded) const;

 private:
  GpsTime on_scale(double seconds);
  void follow(double recorded);

  TimeScale scale_;
  std::string where_;
  double unit_ = 1.0, offset_ = 0.0, origin_ = 0.0;
  double period_ = 0.0;            // after which recorded numbers begin anew, s; 0 = never
  std::int64_t first_period_ = 0;  // week, or day since 1970, of the first record
  std::int64_t passed_ = 0;        // roll-overs since
  std::optional<double> last_;
};

}  // namespace swath::core
