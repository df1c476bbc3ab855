// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: leap seconds from IERS Bulletin C (TAI-UTC from 19 s in 1980-01-06 to 37 s since 2017-01-01; GPS = TAI - 19 s); the GPS epoch
// and week from IS-GPS-200. POSIX counts every UTC day as 86 400 s, so an inserted second has the number of the second after it.
#include "core/time.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>

#include "core/config/units.h"
#include "core/error.h"

namespace swath::core {

namespace {

constexpr double seconds_per_day = 86400.0;
constexpr double gps_epoch_unix = 315964800.0;  // 1980-01-06T00:00:00 UTC

// Between them civil dates have four digits.
constexpr double year_0 = -62167219200.0, year_10000 = 253402300800.0;

struct LeapSecond {
  double unix_start;  // POSIX time from which the offset holds
  int offset;         // GPS - UTC, s
};

constexpr double midnight(int year, unsigned month, unsigned day) {
  const std::chrono::sys_days d{std::chrono::year{year} / std::chrono::month{month} / std::chrono::day{day}};
  return static_cast<double>(d.time_since_epoch().count()) * seconds_per_day;
}

constexpr LeapSecond leap_seconds[] = {{midnight(1981, 7, 1), 1},  {midnight(1982, 7, 1), 2},  {midnight(1983, 7, 1), 3},
                                       {midnight(1985, 7, 1), 4},  {midnight(1988, 1, 1), 5},  {midnight(1990, 1, 1), 6},
                                       {midnight(1991, 1, 1), 7},  {midnight(1992, 7, 1), 8},  {midnight(1993, 7, 1), 9},
                                       {midnight(1994, 7, 1), 10}, {midnight(1996, 1, 1), 11}, {midnight(1997, 7, 1), 12},
                                       {midnight(1999, 1, 1), 13}, {midnight(2006, 1, 1), 14}, {midnight(2009, 1, 1), 15},
                                       {midnight(2012, 7, 1), 16}, {midnight(2015, 7, 1), 17}, {midnight(2017, 1, 1), 18}};

// GPS time at which the offset of an entry begins: after the inserted second.
constexpr double gps_start(const LeapSecond& l) { return l.unix_start - gps_epoch_unix + l.offset; }

bool in_leap_second(GpsTime t) {
  return std::any_of(std::begin(leap_seconds), std::end(leap_seconds),
                     [t](const LeapSecond& l) { return t >= gps_start(l) - 1.0 && t < gps_start(l); });
}

}  // namespace

int gps_minus_utc_at_unix(double unix_seconds) {
  int offset = 0;
  for (const LeapSecond& l : leap_seconds)
    if (unix_seconds >= l.unix_start) offset = l.offset;
  return offset;
}

int gps_minus_utc_at_gps(GpsTime t) {
  int offset = 0;
  for (const LeapSecond& l : leap_seconds)
    if (t >= gps_start(l)) offset = l.offset;
  return offset;
}

std::string_view leap_table_date() { return "2026-06-28"; }

GpsTime from_unix(double unix_seconds) { return unix_seconds - gps_epoch_unix + gps_minus_utc_at_unix(unix_seconds); }
double to_unix(GpsTime t) { return t + gps_epoch_unix - gps_minus_utc_at_gps(t); }

GpsTime from_week(int week, double seconds) { return week * seconds_per_week + seconds; }
int week_of(GpsTime t) {
  constexpr double most = std::numeric_limits<int>::max();
  const double week = std::floor(t / seconds_per_week);
  return std::isnan(week) ? 0 : static_cast<int>(std::clamp(week, -most, most));
}
double seconds_of_week(GpsTime t) { return t - week_of(t) * seconds_per_week; }

std::optional<double> unix_of_date(std::string_view date) {
  if (date.size() != 10 || date[4] != '-' || date[7] != '-') return {};
  const auto number = [&](size_t at, size_t length) {
    int n = -1;
    const auto [end, bad] = std::from_chars(date.data() + at, date.data() + at + length, n);
    return bad == std::errc{} && end == date.data() + at + length ? n : -1;
  };
  const int y = number(0, 4), m = number(5, 2), d = number(8, 2);
  if (y < 0 || m < 0 || d < 0) return {};
  const std::chrono::year_month_day day{std::chrono::year{y}, std::chrono::month{static_cast<unsigned>(m)},
                                        std::chrono::day{static_cast<unsigned>(d)}};
  if (!day.ok()) return {};
  return midnight(y, static_cast<unsigned>(m), static_cast<unsigned>(d));
}

std::string utc_text(GpsTime t) {
  if (!std::isfinite(t)) return "no time";
  if (to_unix(t) < year_0 || to_unix(t) >= year_10000) return format_number(t) + " s GPS";
  const double rounded = std::round(t * 1000.0) / 1000.0;
  const bool leap = in_leap_second(rounded);  // reported as second 60 of the day that ends
  const double unix_seconds = to_unix(rounded) - (leap ? 1.0 : 0.0);
  const long long thousandths = std::llround(unix_seconds * 1000.0);
  const long long per_day = 86400000;
  const long long day = thousandths >= 0 ? thousandths / per_day : -((per_day - 1 - thousandths) / per_day);
  const int of_day = static_cast<int>(thousandths - day * per_day);
  const std::chrono::year_month_day date{std::chrono::sys_days{std::chrono::days{day}}};
  const int second = of_day / 1000 % 60 + (leap ? 1 : 0);
  char out[64];
  std::snprintf(out, sizeof out, "%04d-%02u-%02uT%02d:%02d:%02d.%03dZ", static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                static_cast<unsigned>(date.day()), of_day / 3600000, of_day / 60000 % 60, second, of_day % 1000);
  return out;
}

std::optional<GpsTime> gps_of_gps_date(std::string_view date, double second_of_day) {
  const std::optional<double> start = unix_of_date(date);
  if (!start) return {};
  return *start - gps_epoch_unix + second_of_day;
}

std::optional<GpsTime> gps_of_civil(std::string_view text) {
  constexpr size_t shortest = 19;  // 2025-07-08T19:34:18
  if (text.size() <= shortest || (text[10] != 'T' && text[10] != ' ') || text[13] != ':' || text[16] != ':') return {};
  const auto number = [](std::string_view digits, double& to) {
    if (digits.empty() || digits[0] == '-' || digits[0] == '+') return false;
    const auto [end, bad] = std::from_chars(digits.data(), digits.data() + digits.size(), to, std::chars_format::fixed);
    return bad == std::errc{} && end == digits.data() + digits.size();
  };
  const size_t stop = std::min(text.find_first_not_of("0123456789.", 17), text.size());
  std::string_view scale = text.substr(stop);
  while (!scale.empty() && scale.front() == ' ') scale.remove_prefix(1);
  const bool gps = scale == "GPS", utc = scale == "UTC" || scale == "Z";
  double hour = 0, minute = 0, second = 0;
  if (!(gps || utc) || !number(text.substr(11, 2), hour) || !number(text.substr(14, 2), minute) ||
      !number(text.substr(17, stop - 17), second))
    return {};
  if (hour >= 24 || minute >= 60 || second >= (utc ? 61 : 60)) return {};
  const double of_day = hour * 3600 + minute * 60 + second;
  if (gps) return gps_of_gps_date(text.substr(0, 10), of_day);
  const std::optional<double> start = unix_of_date(text.substr(0, 10));
  if (!start) return {};
  return from_unix(*start) + of_day;
}

TimeReader::TimeReader(TimeScale scale, std::optional<int> week, std::string_view date, std::string where, const TimeNumbers& numbers)
    : scale_(scale), where_(std::move(where)), unit_(numbers.unit), offset_(numbers.offset) {
  switch (scale) {
    case TimeScale::unstated:
      throw usage_error("the time scale is not stated", where_,
                        "state scale = \"gps\", \"gps_adjusted\", \"gps_week\", \"unix\", \"utc_day\" or \"device\"");
    case TimeScale::gps_week:
      if (!week) throw usage_error("seconds of week without their week", where_, "state week = the GPS week of the first record");
      if (*week < 0) throw usage_error("GPS week " + std::to_string(*week) + " is before 1980", where_, "state the week since 1980-01-06");
      first_period_ = *week;
      period_ = seconds_per_week;
      break;
    case TimeScale::utc_day: {
      if (date.empty())
        throw usage_error("UTC seconds of day without their date", where_, "state date = \"YYYY-MM-DD\" of the first record");
      const std::optional<double> start = unix_of_date(date);
      if (!start) throw usage_error("\"" + std::string(date) + "\" is no date", where_, "write it as YYYY-MM-DD");
      first_period_ = static_cast<std::int64_t>(*start / seconds_per_day);
      period_ = seconds_per_day;
      break;
    }
    case TimeScale::device: {
      const std::optional<GpsTime> zero = gps_of_civil(numbers.origin);
      if (!zero)
        throw usage_error(numbers.origin.empty() ? "the instant of the device's zero is not stated"
                                                 : "\"" + std::string(numbers.origin) + "\" is no instant",
                          where_, "state origin = \"YYYY-MM-DDThh:mm:ss.sss GPS\" (or UTC)");
      origin_ = *zero - numbers.origin_at * unit_;
      break;
    }
    case TimeScale::gps:
    case TimeScale::gps_adjusted:
    case TimeScale::unix_utc:
      break;
  }
}

GpsTime TimeReader::operator()(double recorded) {
  if (!std::isfinite(recorded)) throw Error("a time is not a number", where_, "check the time column");
  return on_scale(recorded * unit_) + offset_;
}

GpsTime TimeReader::in_week(int week, double recorded) const {
  const double seconds = recorded * unit_;
  if (!(seconds >= 0.0 && seconds < 2.0 * seconds_per_week))
    throw Error(std::to_string(seconds) + " is no second of a week", where_,
                "milliseconds need time.unit = \"1 ms\"; otherwise check the columns of time and week");
  return from_week(week, seconds) + offset_;
}

GpsTime TimeReader::on_scale(double recorded) {
  if (period_ > 0.0) follow(recorded);
  switch (scale_) {
    case TimeScale::gps_adjusted:
      return recorded + adjusted_offset;
    case TimeScale::gps_week:
      return static_cast<double>(first_period_ + passed_) * seconds_per_week + recorded;
    case TimeScale::unix_utc:
      return from_unix(recorded);
    case TimeScale::utc_day:
      // Counted on from midnight: an inserted second is 86400.x of its day.
      return from_unix(static_cast<double>(first_period_ + passed_) * seconds_per_day) + recorded;
    case TimeScale::device:
      return origin_ + recorded;
    case TimeScale::gps:
    case TimeScale::unstated:
      break;
  }
  return recorded;
}

void TimeReader::follow(double recorded) {
  if (recorded < 0.0 || recorded >= 2.0 * period_)
    throw Error(std::to_string(recorded) + (scale_ == TimeScale::gps_week ? " is no second of a week" : " is no second of a day"), where_,
                "the time scale stated for this file is not the one it is written in");
  if (last_ && recorded < *last_ - 0.5 * period_) ++passed_;
  if (last_ && passed_ > 0 && recorded > *last_ + 0.5 * period_) --passed_;
  last_ = recorded;
}

}  // namespace swath::core
