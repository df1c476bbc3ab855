// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>

#include "core/error.h"
#include "core/printable.h"
#include "core/statistics.h"
#include "core/time.h"
#include "io/raster/png.h"
#include "io/records/clock_log.h"
#include "io/records/event_file.h"
#include "io/text/output_file.h"
#include "report/chart.h"
#include "stages/adapters/adapters.h"
#include "trajectory/clock/clock_model.h"
#include "trajectory/clock/time_compare.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;
using core::EventTags;
using core::Value;
using trajectory::ClockModel;
using trajectory::ClockReading;
using trajectory::TimeComparison;
using trajectory::TimePair;

struct TimeSyncOptions : trajectory::ClockOptions {
  trajectory::EventMatch match = trajectory::EventMatch::id;
  core::Seconds tolerance{0.5};
  std::optional<core::MetresPerSecond> speed;
  std::string technique;
  std::string file = "events_time.csv";
};

template <class V>
void describe(TimeSyncOptions& o, V& v) {
  describe(static_cast<trajectory::ClockOptions&>(o), v);
  v.option("match", o.match, "How events of two techniques are paired: by their names, or the nearest in time.");
  v.option("tolerance", o.tolerance, core::above(0), "Events of two techniques farther apart than this are no pair.");
  v.option("speed", o.speed, core::above(0), "Speed that turns differences of time into metres where no trajectory was read.");
  v.option("technique", o.technique, "Technique whose events are handed on; empty: all.");
  v.option("file", o.file, "Name of the table of events within the output.");
}

/// One technique before and after correction, with the clock's reading at each event (empty where it needs none).
struct Technique {
  EventTags raw, timed;
  std::vector<ClockReading> readings;
  size_t before_settled = 0, outside_log = 0;
};

struct Compared {
  const Technique* one = nullptr;
  const Technique* other = nullptr;
  TimeComparison raw, timed;
};

std::string number(const char* form, double v) {
  char text[48];
  std::snprintf(text, sizeof text, form, v);
  return text;
}

/// One row per event. Seconds of week are written to 0.1 us, which one double of GPS seconds would not hold.
std::string table(const std::vector<Technique>& techniques) {
  std::string out = "id,strip,technique,gps_week,gps_second_of_week,utc,sigma_s,correction_s,flags\n";
  for (const Technique& t : techniques)
    for (size_t i = 0; i < t.timed.size(); ++i) {
      const double since = t.timed.time[i] + t.timed.latency, gps = t.timed.epoch + since;
      int week = core::week_of(gps);
      double second = t.timed.epoch - week * core::seconds_per_week + since;
      if (std::round(second * 1e7) >= core::seconds_per_week * 1e7) {
        ++week;
        second = 0;
      }
      std::string flags, correction;
      if (!t.readings.empty()) {
        if (!t.readings[i].settled) flags = "before_convergence";
        if (!t.readings[i].inside) flags += flags.empty() ? "outside_log" : ";outside_log";
        correction = number("%.9f", t.readings[i].offset);
      }
      out += core::csv_field(t.timed.id[i]) + "," + (t.timed.strip[i] ? std::to_string(t.timed.strip[i]) : "") + "," +
             core::csv_field(t.timed.technique) + "," + std::to_string(week) + "," + number("%.7f", second) + "," + core::utc_text(gps) +
             "," + (t.timed.sigma[i] > 0 ? number("%.9f", t.timed.sigma[i]) : "") + "," + correction + "," + flags + "\n";
    }
  return out;
}

Value value_of(const trajectory::ShiftDrift& s) {
  Value v = Value::object();
  v["shift_s"] = s.shift;
  v["drift"] = s.drift;
  v["rms_after_s"] = s.rms_after;
  return v;
}

/// The pairs of each strip, whose number is not 0.
std::map<std::int32_t, std::vector<TimePair>> by_strip(const std::vector<TimePair>& pairs) {
  std::map<std::int32_t, std::vector<TimePair>> out;
  for (const TimePair& p : pairs)
    if (p.strip != 0) out[p.strip].push_back(p);
  return out;
}

trajectory::Spread spread_of(const std::vector<TimePair>& pairs) {
  std::vector<double> d, s;
  for (const TimePair& p : pairs) {
    d.push_back(p.difference);
    s.push_back(p.sigma);
  }
  return trajectory::spread_of(d, s);
}

class TimeSync : public OptionStage<TimeSyncOptions> {
 public:
  const Info& info() const override {
    static const Info info{"time.sync",
                           "Brings events to GPS time: corrects those of the computer's clock by its logs, flags doubtful ones, compares "
                           "techniques.",
                           {Grain::survey},
                           {},
                           {},
                           {},
                           {Product::of<core::EventData>()}};
    return info;
  }
  std::vector<std::string> products() const override { return {options.file, "time_sync.png", "time_sync.svg"}; }
  std::vector<fs::path> inputs(const io::Survey& survey) const override {
    std::vector<fs::path> out;
    for (const io::EventFile& f : survey.events) out.push_back(io::resolve(survey, f.file));
    for (const io::ClockLog& f : survey.clock) out.push_back(io::resolve(survey, f.file));
    return out;
  }
  void check(const Context& context) const override {
    const io::Survey& s = context.survey;
    if (s.events.empty())
      throw core::usage_error("time.sync: the survey names no [[event]] file", s.name, "without events leave the stage out");
    std::set<std::string> names;
    bool found = options.technique.empty();
    for (const io::EventFile& f : s.events) {
      const std::string name = f.technique.empty() ? f.file.stem().string() : f.technique;
      found = found || name == options.technique;
      if (!names.insert(name).second)
        throw core::usage_error("time.sync: two files of events are named '" + name + "'", s.name, "state event.technique for each");
      if (f.computer_clock && s.clock.empty())
        throw core::usage_error("time.sync: " + f.file.string() + " is by the computer's clock, and the survey names no [[clock]]", s.name,
                                "name its loopstats, peerstats or PPS log, or state computer_clock = false");
    }
    if (!found)
      throw core::usage_error("time.sync: no technique '" + options.technique + "'", s.name, "techniques are named by event.technique");
  }

  void run_survey(Context& context, core::Tally& tally, Value& findings) const override {
    std::optional<ClockModel> clock;
    std::vector<Technique> techniques;
    for (EventTags& tags : io::read_event_files(context.survey, tally)) {
      if (tags.computer_clock && !clock) clock.emplace(io::read_clock_logs(context.survey, tally), options);
      techniques.push_back(corrected(std::move(tags), clock, tally));
    }
    if (!clock && !context.survey.clock.empty()) tally.count("clock logs that no event needs", context.survey.clock.size());
    const std::vector<Compared> compared = compare(techniques);

    if (clock) findings["clock"] = told(*clock);
    for (const Technique& t : techniques) findings["events"][t.timed.technique] = told(t);
    for (const Compared& c : compared) {
      if (!findings.find("comparisons")) findings["comparisons"] = Value::array();
      findings["comparisons"].push(told(c, context));
    }
    io::write_text_file(context.output / options.file, table(techniques));
    if (const report::Chart chart = drawing(clock, compared); !chart.panels.empty()) {
      io::write_png(context.output / "time_sync.png", report::draw(chart));
      io::write_text_file(context.output / "time_sync.svg", report::svg(chart));
    }
    std::vector<EventTags> given;
    for (const Technique& t : techniques)
      if (options.technique.empty() || t.timed.technique == options.technique) given.push_back(t.timed);
    context.records.put(core::EventData(io::events_of(given)));
  }

 private:
  Technique corrected(EventTags tags, const std::optional<ClockModel>& clock, core::Tally& tally) const {
    Technique out;
    out.raw = out.timed = std::move(tags);
    if (!out.raw.computer_clock) return out;
    trajectory::CorrectedEvents c = trajectory::correct(out.raw, *clock, options);
    for (size_t i = 0; i < out.raw.size(); ++i) {
      out.readings.push_back(clock->at(out.raw.epoch - clock->log().epoch + out.raw.time[i]));
      if (!out.readings.back().settled) tally.count("events before the clock had settled", out.raw.technique + " " + out.raw.id[i]);
      if (!out.readings.back().inside) tally.count("events outside the clock's log", out.raw.technique + " " + out.raw.id[i]);
    }
    out.timed = std::move(c.events);
    out.before_settled = c.before_settled;
    out.outside_log = c.outside_log;
    return out;
  }

  /// Each technique against the first that is not by the computer's clock (or the first of all).
  std::vector<Compared> compare(const std::vector<Technique>& techniques) const {
    size_t reference = 0;
    while (reference < techniques.size() && techniques[reference].raw.computer_clock) ++reference;
    if (reference == techniques.size()) reference = 0;
    std::vector<Compared> out;
    for (size_t i = 0; i < techniques.size(); ++i) {
      if (i == reference) continue;
      Compared c{&techniques[i], &techniques[reference], {}, {}};
      c.raw = trajectory::compare(c.one->raw, c.other->raw, options.match, options.tolerance.value);
      c.timed = trajectory::compare(c.one->timed, c.other->timed, options.match, options.tolerance.value);
      out.push_back(std::move(c));
    }
    return out;
  }

  Value told(const ClockModel& clock) const {
    Value v = Value::object();
    v["model"] = core::Choices<trajectory::ClockMethod>::names[static_cast<size_t>(options.model)];
    const core::ClockData& log = clock.log();
    v["records"] = log.size();
    v["first"] = core::utc_text(log.epoch + log.time.front());
    v["last"] = core::utc_text(log.epoch + log.time.back());
    if (!clock.noise().empty()) {
      v["median_noise_s"] = core::median(clock.noise());
      v["outliers"] = clock.outliers();
    }
    Value& list = v["stretches"] = Value::array();
    for (const trajectory::ClockStretch& s : clock.stretches()) {
      Value one = Value::object();
      one["first"] = core::utc_text(log.epoch + log.time[s.first]);
      one["last"] = core::utc_text(log.epoch + log.time[s.last]);
      if (std::isfinite(s.settled))
        one["settled_after_s"] = s.settled - log.time[s.first];
      else
        one["settled_after_s"] = "never";
      if (s.step != 0) one["step_before_s"] = s.step;
      list.push(std::move(one));
    }
    return v;
  }

  static Value told(const Technique& t) {
    Value v = Value::object();
    v["events"] = t.timed.size();
    if (t.readings.empty()) return v;
    v["before_convergence"] = t.before_settled;
    v["outside_log"] = t.outside_log;
    double largest = 0, sigma = 0;
    for (size_t i = 0; i < t.timed.size(); ++i) {
      largest = std::max(largest, std::abs(t.readings[i].offset));
      if (!t.timed.doubtful[i]) sigma = std::max(sigma, t.timed.sigma[i]);
    }
    v["largest_correction_s"] = largest;
    if (sigma > 0) v["largest_sigma_s"] = sigma;
    return v;
  }

  Value told(const Compared& c, const Context& context) const {
    Value v = Value::object();
    v["techniques"] = c.one->timed.technique + " - " + c.other->timed.technique;
    v["only_first"] = c.timed.only_first;
    v["only_second"] = c.timed.only_second;
    v["seconds"] = c.timed.trusted.value();
    if (c.timed.all.n != c.timed.trusted.n) v["seconds_with_doubtful"] = c.timed.all.value();
    if (!c.one->readings.empty()) {
      Value& raw = v["before_correction"];
      raw["seconds"] = c.raw.all.value();
      raw["line"] = value_of(trajectory::shift_and_drift(c.raw.pairs, c.one->raw));
    }
    const auto raw_strips = by_strip(c.raw.pairs);
    for (const auto& [strip, pairs] : by_strip(c.timed.pairs)) {
      Value one = Value::object();
      one["strip"] = strip;
      one["seconds"] = spread_of(pairs).value();
      if (const auto raw = raw_strips.find(strip); raw != raw_strips.end() && !c.one->readings.empty()) {
        one["before_correction"] = spread_of(raw->second).value();
        one["line_before_correction"] = value_of(trajectory::shift_and_drift(raw->second, c.one->raw));
      }
      if (!v.find("strips")) v["strips"] = Value::array();
      v["strips"].push(std::move(one));
    }
    if (context.records.has<trajectory::Trajectory>()) {
      const trajectory::PlaceComparison p =
          trajectory::compare_places(c.timed.pairs, c.other->timed, context.records.get<trajectory::Trajectory>());
      v["metres"]["along"] = p.axes[0].value();
      v["metres"]["across"] = p.axes[1].value();
      v["metres"]["up"] = p.axes[2].value();
      v["metres"]["length"] = p.length.value();
      if (p.outside) v["metres"]["outside_trajectory"] = p.outside;
    } else if (options.speed) {
      std::vector<double> metres;
      for (const TimePair& p : c.timed.pairs)
        if (!p.doubtful) metres.push_back(trajectory::metres_of(p.difference, options.speed->value));
      v["metres"]["along"] = trajectory::spread_of(metres).value();
    }
    return v;
  }

  report::Chart drawing(const std::optional<ClockModel>& clock, const std::vector<Compared>& compared) const {
    report::Chart chart;
    chart.title = "One time scale";
    const double start = clock ? clock->log().epoch + clock->log().time.front() : compared.empty() ? 0.0 : compared[0].other->timed.epoch;
    const std::string x_label = clock ? "time since the log's start (s)" : "time since the first event (s)";
    if (clock) draw_clock(*clock, x_label, chart);
    for (const Compared& c : compared) {
      const auto panel = [&](const std::string& title, const char* unit, double factor, const TimeComparison& t) {
        report::Panel p{title, x_label, unit, {}};
        report::Series trusted{"trusted", {}, {}, {}, report::Mark::dots}, doubtful{"doubtful", {}, {}, {}, report::Mark::dots};
        report::Series sigma{"one sigma", {}, {}, {}, report::Mark::band};
        for (const TimePair& pair : t.pairs) {
          report::Series& s = pair.doubtful ? doubtful : trusted;
          s.x.push_back(c.other->timed.epoch - start + pair.time);
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
      const std::string names = c.one->timed.technique + " - " + c.other->timed.technique;
      if (!c.one->readings.empty()) panel(names + ", before correction", "ms", 1e3, c.raw);
      panel(names, "us", 1e6, c.timed);
    }
    return chart;
  }

  void draw_clock(const ClockModel& clock, const std::string& x_label, report::Chart& chart) const {
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
    if (options.model == trajectory::ClockMethod::literal) return;  // it runs through every record, and knows no sigma
    residual.series = {std::move(noise), std::move(band), std::move(off)};
    chart.panels.push_back(std::move(residual));
  }
};

}  // namespace

std::unique_ptr<Stage> make_time_sync() { return std::make_unique<TimeSync>(); }

}  // namespace swath::stages
