// SPDX-License-Identifier: GPL-3.0-or-later
// The events of a flight on GPS time.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/config/option.h"
#include "core/config/result.h"
#include "core/error.h"
#include "io/records/clock_log.h"
#include "io/records/event_file.h"
#include "io/text/output_file.h"
#include "report/chart.h"
#include "stages/adapters/adapters.h"
#include "stages/drawing_file.h"
#include "stages/once.h"
#include "trajectory/clock/techniques.h"
#include "trajectory/events_outside.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;

struct TimeSyncOptions : trajectory::TechniqueOptions {
  std::string technique;
  std::string file = "events_time.csv";
};

template <class V>
void describe(TimeSyncOptions& o, V& v) {
  describe(static_cast<trajectory::TechniqueOptions&>(o), v);
  v.option("technique", o.technique, "Technique whose events are handed on; empty: all.");
  v.option("file", o.file, "Name of the table of events within the output.");
}

struct TimeSyncFindings {
  std::optional<trajectory::ClockFigures> clock{};
  std::vector<trajectory::TechniqueFigures> events{};
  std::vector<trajectory::TechniqueDifferences> comparisons{};
  std::vector<trajectory::EventsOutside> outside{};
};

template <class V>
void describe(const TimeSyncFindings& r, V& v) {
  v.table("clock", r.clock, "The log of the computer's clock.");
  v.tables("events", r.events, "Events by technique.");
  v.tables_if(!r.comparisons.empty(), "comparisons", r.comparisons, "Techniques against one another.");
  v.tables_if(!r.outside.empty(), "outside", r.outside,
              "Techniques nearly all of whose events lie outside the trajectory, or, without one, those of the other technique.");
}

using trajectory::ClockModel;
using trajectory::ClockReading;
using trajectory::CorrectedEvents;
using trajectory::TechniquePair;
using trajectory::TimeComparison;
using trajectory::TimePair;

void draw_clock(const ClockModel& clock, bool is_literal, const std::string& x_label, report::Chart& chart) {
  const core::ClockData& log = clock.log();
  report::Panel offset{"Offset of the computer's clock, UTC - clock", x_label, "ms", {}};
  report::Panel residual{"Log minus model", x_label, "us", {}};
  report::Series dots{"log", {}, {}, {}, report::Mark::dots}, line{"model", {}, {}, {}, report::Mark::line};
  report::Series off{"log", {}, {}, {}, report::Mark::dots}, band{"one sigma of the model", {}, {}, {}, report::Mark::band};
  report::Series noise{"one sigma of a record", {}, {}, {}, report::Mark::band};
  for (const trajectory::ClockStretch& s : clock.stretches()) {
    for (size_t i = s.first; i <= s.last; ++i) {
      const double x = log.time[i] - log.time.front();
      const ClockReading r = clock.at(log.time[i]);
      for (report::Series* one : {&dots, &line, &off, &band, &noise}) one->x.push_back(x);
      dots.y.push_back(log.offset[i] * 1e3);
      line.y.push_back(r.offset * 1e3);
      off.y.push_back((log.offset[i] - r.offset) * 1e6);
      band.y.push_back(r.sigma * 1e6);
      noise.y.push_back(clock.noise().empty() ? 0.0 : clock.noise()[i] * 1e6);
    }
    for (report::Series* one : {&dots, &line, &off, &band, &noise}) {  // a step breaks the lines
      one->x.push_back(one->x.back());
      one->y.push_back(std::nan(""));
    }
  }
  offset.series = {std::move(dots), std::move(line)};
  chart.panels.push_back(std::move(offset));
  if (is_literal) return;  // it runs through every record, and knows no sigma
  residual.series = {std::move(noise), std::move(band), std::move(off)};
  chart.panels.push_back(std::move(residual));
}

report::Chart drawing(const std::optional<ClockModel>& clock, bool is_literal, const std::vector<TechniquePair>& compared) {
  report::Chart chart;
  chart.title = "One time scale";
  const double start = clock ? clock->log().epoch + clock->log().time.front() : compared.empty() ? 0.0 : compared[0].other->events.epoch;
  const std::string x_label = clock ? "time since the log's start (s)" : "time since the first event (s)";
  if (clock) draw_clock(*clock, is_literal, x_label, chart);
  for (const TechniquePair& c : compared) {
    const auto panel = [&](const std::string& title, const char* unit, double factor, const TimeComparison& t) {
      report::Panel p{title, x_label, unit, {}};
      report::Series trusted{"trusted", {}, {}, {}, report::Mark::dots}, doubtful{"doubtful", {}, {}, {}, report::Mark::dots};
      report::Series sigma{"one sigma", {}, {}, {}, report::Mark::band};
      for (const TimePair& pair : t.pairs) {
        report::Series& s = pair.doubtful ? doubtful : trusted;
        s.x.push_back(c.other->events.epoch - start + pair.time);
        s.y.push_back(pair.difference * factor);
        if (pair.sigma > 0) {
          sigma.x.push_back(s.x.back());
          sigma.y.push_back(pair.sigma * factor);
        }
      }
      for (report::Series* s : {&sigma, &doubtful, &trusted})
        if (!s->x.empty()) p.series.push_back(std::move(*s));
      if (!p.series.empty()) chart.panels.push_back(std::move(p));
    };
    if (!c.one->readings.empty()) panel(c.names() + ", before correction", "ms", 1e3, c.raw);
    panel(c.names(), "us", 1e6, c.timed);
  }
  return chart;
}

std::vector<double> gps_times(const core::EventTags& events) {
  std::vector<double> out;
  for (const double t : events.time) out.push_back(events.epoch + (t + events.latency));
  return out;
}

/// Techniques whose times do not fit the trajectory; without one, those that have no event in common with the technique they are compared
/// with.
std::vector<trajectory::EventsOutside> times_that_do_not_fit(const std::vector<CorrectedEvents>& techniques,
                                                             const std::vector<TechniquePair>& compared,
                                                             const trajectory::Trajectory* flown) {
  std::vector<trajectory::EventsOutside> out;
  const auto judge = [&out](const core::EventTags& events, const trajectory::Span& record, const std::string& name) {
    if (auto found = trajectory::outside_of(events.technique, gps_times(events), record, name)) out.push_back(std::move(*found));
  };
  if (flown) {
    for (const CorrectedEvents& t : techniques)
      judge(t.events, {flown->spans().front().first, flown->spans().back().last}, "the trajectory");
    return out;
  }
  for (const TechniquePair& c : compared) {
    const std::vector<double> other = gps_times(c.other->events);
    const auto [first, last] = std::minmax_element(other.begin(), other.end());
    if (c.timed.pairs.empty()) judge(c.one->events, {*first, *last}, "the events of '" + c.other->events.technique + "'");
  }
  return out;
}

std::vector<std::string> time_sync_products(const TimeSyncOptions& o) { return {o.file, "time_sync.png", "time_sync.svg"}; }

std::vector<fs::path> event_files(const io::Survey& survey) {
  std::vector<fs::path> out = files_in<&io::Survey::events>(survey);
  for (const io::ClockLog& f : survey.clock) out.push_back(io::resolve(survey, f.file));
  return out;
}

void expect_events(const Context& context, const TimeSyncOptions& o) {
  const io::Survey& s = context.survey;
  if (s.events.empty())
    throw core::usage_error("time.sync: the survey names no [[event]] file", s.name, "without events leave the stage out");
  std::set<std::string> names;
  bool found = o.technique.empty();
  for (const io::EventFile& f : s.events) {
    const std::string name = io::technique_of(f);
    found = found || name == o.technique;
    if (!names.insert(name).second)
      throw core::usage_error("time.sync: two files of events are named '" + name + "'", s.name, "state event.technique for each");
    if (f.computer_clock && s.clock.empty())
      throw core::usage_error("time.sync: " + f.file.string() + " is by the computer's clock, and the survey names no [[clock]]", s.name,
                              "name its loopstats, peerstats or PPS log, or state computer_clock = false");
  }
  if (!found) throw core::usage_error("time.sync: no technique '" + o.technique + "'", s.name, "techniques are named by event.technique");
}

Given<core::EventData, TimeSyncFindings> sync_times(const io::Survey& survey, const trajectory::Trajectory* flown, const TimeSyncOptions& o,
                                                    const Output& to, core::Tally& tally) {
  std::optional<ClockModel> clock;
  std::vector<CorrectedEvents> techniques;
  for (core::EventTags& tags : io::read_event_files(survey, tally)) {
    if (tags.computer_clock && !clock) clock.emplace(io::read_clock_logs(survey, tally), o);
    techniques.push_back(trajectory::on_gps_time(std::move(tags), clock, o, tally));
  }
  if (!clock && !survey.clock.empty()) tally.count("clock logs that no event needs", survey.clock.size());
  const std::vector<TechniquePair> compared = trajectory::pairs_of(techniques, o);

  TimeSyncFindings found;
  if (clock) found.clock = trajectory::figures_of(*clock, o.model);
  for (const CorrectedEvents& t : techniques) {
    found.events.push_back(trajectory::figures_of(t));
    trajectory::count_breaks(t.events, found.events.back().pattern, tally);
  }
  for (const TechniquePair& c : compared) found.comparisons.push_back(trajectory::differences_of(c, flown, o));
  found.outside = times_that_do_not_fit(techniques, compared, flown);
  io::write_text_file(to.folder / o.file, trajectory::table_of(techniques));
  if (const report::Chart chart = drawing(clock, o.model == trajectory::ClockMethod::literal, compared); !chart.panels.empty())
    for (const char* name : {"time_sync.png", "time_sync.svg"}) write_drawing(to.folder / name, report::drawing(chart));
  std::vector<core::EventTags> given;
  for (const CorrectedEvents& t : techniques)
    if (o.technique.empty() || t.events.technique == o.technique) given.push_back(t.events);
  return {io::events_of(given), std::move(found)};
}

}  // namespace

Entry time_sync_stage() {
  return once<sync_times>("time.sync",
                          "Brings events to GPS time: corrects those of the computer's clock by its logs, flags doubtful ones, compares "
                          "techniques.",
                          {.check = expect_events, .inputs = event_files, .products = time_sync_products});
}

}  // namespace swath::stages
