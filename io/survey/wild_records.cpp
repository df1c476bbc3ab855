// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/wild_records.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/config/value.h"
#include "core/error.h"

namespace swath::io {
namespace {

constexpr double max_apart = 3600.0;  // s
constexpr double latest_week = 10000.0;
constexpr const char* check_scale = "check the time column, its unit and scale";
constexpr double year_2100 = 3786912000.0;  // GPS time

}  // namespace

std::vector<size_t> wild_times(const std::vector<double>& time, double period) {
  return contradicted(time.size(), [&](size_t i, size_t j) {
    const double apart = std::abs(time[i] - time[j]);
    return std::min(apart, std::abs(apart - period)) > max_apart;
  });
}

double period_of(core::TimeScale scale) {
  return scale == core::TimeScale::gps_week ? core::seconds_per_week : scale == core::TimeScale::utc_day ? 86400.0 : 0.0;
}

std::string scale_hint(double recorded) {
  return recorded >= 0 && recorded < core::seconds_per_week
             ? std::string(check_scale) + ": it looks like seconds of the GPS week, scale = \"gps_week\" with the week"
             : check_scale;
}

bool is_instant(double t) { return t >= 0.0 && t < year_2100; }

std::vector<double> gps_times(const TimeTags& tags, const std::string& name, const std::vector<double>& recorded,
                              const std::vector<double>& weeks, const std::string& what, core::Tally& tally,
                              const std::function<std::string(size_t)>& place) {
  const auto at = [&](size_t i) { return place ? place(i) : name + ": record " + std::to_string(i); };
  const size_t n = recorded.size();
  core::TimeReader clock = reader_of(tags, name, !weeks.empty());
  std::vector<size_t> rows;
  std::vector<double> seconds;
  for (size_t i = 0; i < n; ++i) {
    const double week = weeks.empty() ? 0.0 : weeks[i];
    if (!std::isfinite(recorded[i]) || !(week >= 0.0 && week <= latest_week)) continue;
    rows.push_back(i);
    seconds.push_back(recorded[i] * tags.unit.value + week * core::seconds_per_week);
  }
  std::vector<size_t> wild = wild_times(seconds, weeks.empty() ? period_of(tags.scale) : 0.0);
  if (!are_few(wild.size(), n)) wild.clear();
  std::vector<double> out(n, std::nan(""));
  std::optional<core::Error> first;
  std::uint64_t thrown = 0;
  for (size_t k = 0, next = 0; k < rows.size(); ++k) {
    if (next < wild.size() && wild[next] == k) {
      ++next;
      continue;
    }
    const size_t i = rows[k];
    try {
      const double t = weeks.empty() ? clock(recorded[i]) : clock.in_week(static_cast<int>(weeks[i]), recorded[i]);
      if (!is_instant(t))
        throw core::Error("the time " + core::format_number(recorded[i]) + " is not between 1980 and 2100", name, scale_hint(recorded[i]));
      out[i] = t;
    } catch (const core::Error& e) {
      if (!first) first.emplace(e.what(), at(i), e.hint(), e.code());
      if (++thrown > max_looked_at && !are_few(thrown, n)) throw *first;
    }
  }
  std::uint64_t left_out = 0;
  for (size_t i = 0; i < n; ++i) {
    if (!std::isnan(out[i])) continue;
    ++left_out;
    const std::string time = std::isfinite(recorded[i]) ? "time " + core::format_number(recorded[i]) : "the time is missing or not finite";
    if (!first) first.emplace(time + (std::isfinite(recorded[i]) ? " is not that of a record here" : ""), at(i), check_scale);
    tally.count(what, at(i) + ": " + time);
  }
  if (left_out > 0 && !are_few(left_out, n)) throw *first;
  return out;
}

}  // namespace swath::io
