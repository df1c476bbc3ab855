// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/clock/techniques.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "core/printable.h"
#include "core/statistics.h"
#include "core/time.h"

namespace swath::trajectory {
namespace {

std::string number(const char* form, double v) {
  char text[48];
  std::snprintf(text, sizeof text, form, v);
  return text;
}

/// The pairs of each strip, whose number is not 0.
std::map<std::int32_t, std::vector<TimePair>> by_strip(const std::vector<TimePair>& pairs) {
  std::map<std::int32_t, std::vector<TimePair>> out;
  for (const TimePair& p : pairs)
    if (p.strip != 0) out[p.strip].push_back(p);
  return out;
}

Spread spread_of(const std::vector<TimePair>& pairs) {
  std::vector<double> d, s;
  for (const TimePair& p : pairs) {
    d.push_back(p.difference);
    s.push_back(p.sigma);
  }
  return trajectory::spread_of(d, s);
}

}  // namespace

CorrectedEvents on_gps_time(core::EventTags events, const std::optional<ClockModel>& clock, const ClockOptions& o, core::Tally& tally) {
  CorrectedEvents out;
  if (!events.computer_clock) {
    out.raw = out.events = std::move(events);
    return out;
  }
  out = correct(std::move(events), *clock, o);
  for (size_t i = 0; i < out.raw.size(); ++i) {
    const std::string event = out.raw.technique + " " + out.raw.id[i];
    if (!out.readings[i].settled) tally.count("events before the clock had settled", event);
    if (!out.readings[i].inside) tally.count("events outside the clock's log", event);
  }
  return out;
}

std::vector<TechniquePair> pairs_of(const std::vector<CorrectedEvents>& techniques, const TechniqueOptions& o) {
  size_t reference = 0;
  while (reference < techniques.size() && techniques[reference].raw.computer_clock) ++reference;
  if (reference == techniques.size()) reference = 0;
  std::vector<TechniquePair> out;
  for (size_t i = 0; i < techniques.size(); ++i) {
    if (i == reference) continue;
    const CorrectedEvents &one = techniques[i], &other = techniques[reference];
    out.push_back({&one, &other, compare(one.raw, other.raw, o.match, o.tolerance.value),
                   compare(one.events, other.events, o.match, o.tolerance.value)});
  }
  return out;
}

std::string table_of(const std::vector<CorrectedEvents>& techniques) {
  std::string out = "id,strip,technique,gps_week,gps_second_of_week,utc,sigma_s,correction_s,flags\n";
  for (const auto& [raw, timed, readings, before_settled, outside_log] : techniques)
    for (size_t i = 0; i < timed.size(); ++i) {
      const double since = timed.time[i] + timed.latency, gps = timed.epoch + since;
      int week = core::week_of(gps);
      double second = timed.epoch - week * core::seconds_per_week + since;
      if (std::round(second * 1e7) >= core::seconds_per_week * 1e7) {
        ++week;
        second = 0;
      }
      std::string flags, correction;
      if (!readings.empty()) {
        if (!readings[i].settled) flags = "before_convergence";
        if (!readings[i].inside) flags += flags.empty() ? "outside_log" : ";outside_log";
        correction = number("%.9f", readings[i].offset);
      }
      out += core::csv_field(timed.id[i]) + "," + (timed.strip[i] ? std::to_string(timed.strip[i]) : "") + "," +
             core::csv_field(timed.technique) + "," + std::to_string(week) + "," + number("%.7f", second) + "," + core::utc_text(gps) +
             "," + (timed.sigma[i] > 0 ? number("%.9f", timed.sigma[i]) : "") + "," + correction + "," + flags + "\n";
    }
  return out;
}

ClockFigures figures_of(const ClockModel& clock, ClockMethod model) {
  const core::ClockData& log = clock.log();
  const auto utc = [&log](size_t record) { return core::utc_text(log.epoch + log.time[record]); };
  ClockFigures out{std::string(core::Choices<ClockMethod>::names[static_cast<size_t>(model)]), log.size(), utc(0), utc(log.size() - 1)};
  if (!clock.noise().empty()) {
    out.noise = core::median(clock.noise());
    out.outliers = clock.outliers();
  }
  for (const ClockStretch& s : clock.stretches())
    out.stretches.push_back({utc(s.first), utc(s.last), s.settled - log.time[s.first], s.step});
  return out;
}

TechniqueFigures figures_of(const CorrectedEvents& t) {
  TechniqueFigures out{t.events.technique, t.events.size(), !t.readings.empty(), t.before_settled, t.outside_log};
  out.pattern = pattern_of(t.events);
  for (size_t i = 0; i < t.readings.size(); ++i) {
    out.largest_correction = std::max(out.largest_correction, std::abs(t.readings[i].offset));
    if (!t.events.doubtful[i]) out.largest_sigma = std::max(out.largest_sigma, t.events.sigma[i]);
  }
  return out;
}

TechniqueDifferences differences_of(const TechniquePair& c, const Trajectory* flown, const TechniqueOptions& o) {
  TechniqueDifferences out{c.names(), c.timed.only_first, c.timed.only_second, c.timed.trusted};
  const bool is_corrected = !c.one->readings.empty();
  if (c.timed.all.n != c.timed.trusted.n) out.with_doubtful = c.timed.all;
  if (is_corrected) out.before = {c.raw.all, shift_and_drift(c.raw.pairs, c.one->raw)};
  const auto raw_strips = by_strip(c.raw.pairs);
  for (const auto& [strip, pairs] : by_strip(c.timed.pairs)) {
    StripDifferences& one = out.strips.emplace_back(StripDifferences{strip, spread_of(pairs)});
    if (const auto raw = raw_strips.find(strip); raw != raw_strips.end() && is_corrected) {
      one.before = spread_of(raw->second);
      one.line_before = shift_and_drift(raw->second, c.one->raw);
    }
  }
  if (flown)
    out.metres = compare_places(c.timed.pairs, c.other->events, *flown);
  else if (o.speed)
    out.metres = compare_places(c.timed.pairs, o.speed->value);
  return out;
}

}  // namespace swath::trajectory
