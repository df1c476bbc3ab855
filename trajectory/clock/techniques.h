// SPDX-License-Identifier: GPL-3.0-or-later
// Techniques that timed the events of one flight, brought to one time scale, and what the report says of them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/config/result.h"
#include "core/report.h"
#include "trajectory/clock/clock_model.h"
#include "trajectory/clock/event_pattern.h"
#include "trajectory/clock/time_compare.h"

namespace swath::trajectory {

struct TechniqueOptions : ClockOptions {
  EventMatch match = EventMatch::id;
  core::Seconds tolerance{0.5};
  std::optional<core::MetresPerSecond> speed;
};

template <class V>
void describe(TechniqueOptions& o, V& v) {
  describe(static_cast<ClockOptions&>(o), v);
  v.option("match", o.match, "How events of two techniques are paired: by their names, or the nearest in time.");
  v.option("tolerance", o.tolerance, core::above(0), "Events of two techniques farther apart than this are no pair.");
  v.option("speed", o.speed, core::above(0), "Speed that turns differences of time into metres where no trajectory was read.");
}

/// Events of the computer's clock corrected by it; those of others as they are.
CorrectedEvents on_gps_time(core::EventTags events, const std::optional<ClockModel>& clock, const ClockOptions& o, core::Tally& tally);

/// Two techniques, before and after correction.
struct TechniquePair {
  const CorrectedEvents *one, *other;
  TimeComparison raw, timed;
  std::string names() const { return one->events.technique + " - " + other->events.technique; }
};

/// Each technique against the first that is not by the computer's clock (or the first of all).
std::vector<TechniquePair> pairs_of(const std::vector<CorrectedEvents>& techniques, const TechniqueOptions& o);

/// CSV, one row per event. Seconds of week are written to 0.1 us, which one double of GPS seconds would not hold.
std::string table_of(const std::vector<CorrectedEvents>& techniques);

struct StretchFigures {
  std::string first, last;
  double settled_after = 0.0, step = 0.0;  ///< s; infinite: never
};

template <class V>
void describe(const StretchFigures& r, V& v) {
  v.result("first", r.first, "UTC of its first record.");
  v.result("last", r.last, "UTC of its last record.");
  v.result("settled_after_s", r.settled_after, core::seconds(0).always(), "Time until the clock had settled; null: never.");
  v.result("step_before_s", r.step, core::seconds(6).only_if(r.step != 0), "Step of the clock before it.");
}

struct ClockFigures {
  std::string model;
  std::uint64_t records = 0;
  std::string first, last;
  std::optional<double> noise{};
  std::optional<std::uint64_t> outliers{};
  std::vector<StretchFigures> stretches{};
};

template <class V>
void describe(const ClockFigures& r, V& v) {
  v.result("model", r.model, "literal or robust.");
  v.result("records", r.records, "Records of the log.");
  v.result("first", r.first, "UTC of the first.");
  v.result("last", r.last, "UTC of the last.");
  v.result("median_noise_s", r.noise, core::Form{"s"}, "Median sigma of a record.");
  v.result("outliers", r.outliers, "Records beyond six sigma.");
  v.tables("stretches", r.stretches, "Stretches of the log between steps of the clock.");
}

/// Of the log of a clock, which is not empty.
ClockFigures figures_of(const ClockModel& clock, ClockMethod model);

struct TechniqueFigures {
  std::string name;
  std::uint64_t events = 0;
  bool is_corrected = false;
  std::uint64_t before_settled = 0, outside_log = 0;
  double largest_correction = 0.0, largest_sigma = 0.0;  ///< s; sigma of the events that are not doubtful, 0: not known
  EventPattern pattern{};
};

template <class V>
void describe(const TechniqueFigures& r, V& v) {
  const auto corrected = core::plain().only_if(r.is_corrected);
  v.result("name", r.name, "Name of the technique.");
  v.result("events", r.events, "Its events.");
  v.result("before_convergence", r.before_settled, corrected, "Of those: before the clock had settled.");
  v.result("outside_log", r.outside_log, corrected, "Of those: outside the log, or in a gap of it.");
  v.result("largest_correction_s", r.largest_correction, core::Form{"s"}.only_if(r.is_corrected), "Largest correction.");
  v.result("largest_sigma_s", r.largest_sigma, core::Form{"s"}.only_if(r.largest_sigma > 0),
           "Largest sigma of an event that is not doubtful.");
  v.table("pattern", r.pattern, "Intervals between events.");
}

TechniqueFigures figures_of(const CorrectedEvents& events);

struct DifferencesBefore {
  Spread seconds{};
  ShiftDrift line{};
};

template <class V>
void describe(const DifferencesBefore& r, V& v) {
  v.table("seconds", r.seconds, "Differences of time, s.");
  v.table("line", r.line, "Straight line through them.");
}

struct StripDifferences {
  std::int32_t strip = 0;
  Spread seconds{};
  std::optional<Spread> before{};
  std::optional<ShiftDrift> line_before{};
};

template <class V>
void describe(const StripDifferences& r, V& v) {
  v.result("strip", r.strip, "Number of the strip.");
  v.table("seconds", r.seconds, "Differences of time, s.");
  v.table("before_correction", r.before, "The same before correction.");
  v.table("line_before_correction", r.line_before, "Straight line through those.");
}

struct TechniqueDifferences {
  std::string techniques;
  std::uint64_t only_first = 0, only_second = 0;
  Spread seconds{};
  std::optional<Spread> with_doubtful{};
  std::optional<DifferencesBefore> before{};
  std::vector<StripDifferences> strips{};
  std::optional<PlaceComparison> metres{};
};

template <class V>
void describe(const TechniqueDifferences& r, V& v) {
  v.result("techniques", r.techniques, "Names of the two.");
  v.result("only_first", r.only_first, "Events of the first without a partner.");
  v.result("only_second", r.only_second, "Events of the second without a partner.");
  v.table("seconds", r.seconds, "Differences of time of events that neither doubts, s.");
  v.table("seconds_with_doubtful", r.with_doubtful, "The same of all events.");
  v.table("before_correction", r.before, "The same of all events before correction.");
  v.tables_if(!r.strips.empty(), "strips", r.strips, "Strip by strip, doubtful events among them.");
  v.table("metres", r.metres, "The differences in metres of flight.");
}

/// `flown` may be null.
TechniqueDifferences differences_of(const TechniquePair& pair, const Trajectory* flown, const TechniqueOptions& o);

}  // namespace swath::trajectory
