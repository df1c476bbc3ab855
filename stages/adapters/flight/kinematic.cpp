// SPDX-License-Identifier: GPL-3.0-or-later
// Positions of the GNSS antenna at events.
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "core/config/option.h"
#include "core/error.h"
#include "core/statistics.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "report/chart.h"
#include "stages/adapters/adapters.h"
#include "stages/drawing_file.h"
#include "stages/once.h"
#include "trajectory/event_table.h"

namespace swath::stages {
namespace {

struct KinematicStageOptions : trajectory::KinematicOptions {
  trajectory::Interpolator method = trajectory::Interpolator::kalman;
  std::string file = "events.csv";
  bool leave_one_out = false;
  std::vector<double> rates;
};

template <class V>
void describe(KinematicStageOptions& o, V& v) {
  v.option("method", o.method, "Kalman filter of the window; or, to compare, line, 2nd-degree polynomial or RTS smoother.", "Jubanski2005");
  v.option("file", o.file, "Name of the table of events within the output.");
  v.option("leave_one_out", o.leave_one_out, "Write the leave-one-out test of all four methods (leave_one_out.txt, .png, .svg).");
  v.option("rates", o.rates, core::within(0.01, 1000), "Rates in Hz to which the fixes are thinned and tested (rates.txt).",
           "Jubanski2005");
  describe(static_cast<trajectory::KinematicOptions&>(o), v);
}

using trajectory::Interpolator;

constexpr size_t least_fixes = 3;
constexpr double rate_tolerance = 0.05;  // of a rate: receivers' steps are not exact

report::Chart drawing(const trajectory::LeaveOneOut& test, double start) {
  static constexpr const char* axes[] = {"East", "North", "Height"};
  report::Chart chart;
  chart.title = "Leave-one-out: fix minus interpolated";
  chart.panel_height = 200;
  // A NaN between fixes that are no neighbours breaks the line.
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const auto broken = [&](size_t k) { return k > 0 && test.fix[k] != test.fix[k - 1] + 1; };
  const auto panel = [&](const std::string& title, int axis, std::initializer_list<Interpolator> methods) {
    report::Panel p;
    p.title = title;
    p.x_label = "time since the first fix (s)";
    p.y_label = "cm";
    for (const Interpolator method : methods) {
      report::Series s;
      s.name = title_of(method);
      s.colour = static_cast<int>(method);
      for (size_t k = 0; k < test.fix.size(); ++k) {
        if (broken(k)) s.x.push_back(test.time[k] - start), s.y.push_back(nan);
        s.x.push_back(test.time[k] - start);
        s.y.push_back(100.0 * test.difference[static_cast<size_t>(method)][k].value[axis]);
      }
      p.series.push_back(std::move(s));
    }
    chart.panels.push_back(std::move(p));
  };
  for (int axis = 0; axis < 3; ++axis)
    panel(std::string(axes[axis]) + ", all four", axis,
          {Interpolator::line, Interpolator::parabola, Interpolator::kalman, Interpolator::rts});
  for (int axis = 0; axis < 3; ++axis) panel(std::string(axes[axis]) + ", Kalman and RTS", axis, {Interpolator::kalman, Interpolator::rts});
  return chart;
}

std::vector<std::string> kinematic_products(const KinematicStageOptions& o) {
  std::vector<std::string> out{"kinematic.json"};
  if (!o.file.empty()) out.push_back(o.file);
  if (o.leave_one_out) out.insert(out.end(), {"leave_one_out.txt", "leave_one_out.png", "leave_one_out.svg"});
  if (!o.rates.empty()) out.push_back("rates.txt");
  return out;
}

void expect_work(const Context& context, const KinematicStageOptions& o) {
  if (!context.survey.events.empty() && context.survey.crs.empty())
    throw core::usage_error("trajectory.kinematic: the survey states no CRS for the table of events", context.survey.name,
                            "state it, for example crs = \"EPSG:32632\"");
  if (context.survey.events.empty() && !o.leave_one_out && o.rates.empty())
    throw core::usage_error("trajectory.kinematic: the survey names no [[event]] file and no test is asked for", context.survey.name,
                            "name the events, or state leave_one_out = true or rates = [1]");
}

/// The record at each rate below its own; the others are counted.
std::vector<trajectory::RateTest> test_rates(const trajectory::PointFixes& fixes, const std::vector<trajectory::LineSpan>& lines,
                                             const KinematicStageOptions& o, core::Tally& tally) {
  std::vector<trajectory::RateTest> out;
  const double own = 1.0 / core::median_step(fixes.time), length = fixes.time.back() - fixes.time.front();
  for (const double rate : o.rates) {
    char name[40];
    std::snprintf(name, sizeof name, "%g Hz", rate);
    if (rate > own * (1.0 + rate_tolerance))
      tally.count("rates above that of the record, not tested", name);
    else if (length * rate < least_fixes)
      tally.count("rates that leave too few fixes, not tested", name);
    else
      out.push_back(trajectory::test_rate(fixes, rate, lines, o));
  }
  return out;
}

trajectory::EventFigures position_events(const core::GnssData& all, const core::EventData* given, const Context& context,
                                         const KinematicStageOptions& o, const Output& to, core::Tally& tally) {
  const core::GnssData gnss = trajectory::usable_fixes(all, tally);
  if (gnss.size() < least_fixes)
    throw core::Error("trajectory.kinematic: " + std::to_string(gnss.size()) + " GNSS fixes are of use, " + std::to_string(least_fixes) +
                          " are the least",
                      context.survey.name, "see the counts of the stage that reads them");
  std::vector<trajectory::LineSpan> lines;
  for (const io::LineWindow& w : io::line_windows(context.survey)) lines.push_back({w.id, w.start, w.end});
  const trajectory::PointTrack track = trajectory::track_of(gnss, lines, o);
  const core::EventData events = given ? *given : core::EventData{};
  const std::vector<trajectory::EventPosition> solved = trajectory::positions_at(track, gnss.position.front(), events.time, o.method, o);
  trajectory::count_events(events, gnss, solved, context.survey.name, tally);
  trajectory::EventFigures findings = trajectory::figures_of(events, track, solved, o.method);
  findings.leave_one_out = trajectory::leave_one_out(track, o);
  findings.rates = test_rates(track.fixes, lines, o, tally);

  if (given) io::write_text_file(to.folder / o.file, trajectory::table_of(events, solved, context.crs, context.vertical_unit));
  io::write_text_file(to.folder / "kinematic.json", io::to_json(core::reported(findings)));
  if (!o.rates.empty()) io::write_text_file(to.folder / "rates.txt", trajectory::table_of(findings.rates));
  if (!o.leave_one_out) return findings;
  const report::Chart chart = drawing(findings.leave_one_out, gnss.time.front());
  io::write_text_file(to.folder / "leave_one_out.txt", findings.leave_one_out.table());
  for (const char* name : {"leave_one_out.png", "leave_one_out.svg"}) write_drawing(to.folder / name, report::drawing(chart));
  return findings;
}

}  // namespace

Entry kinematic_stage() {
  return once<position_events>("trajectory.kinematic",
                               "Positions of the GNSS antenna at events, by a Kalman filter from both sides; leave-one-out test.",
                               {.check = expect_work, .products = kinematic_products});
}

}  // namespace swath::stages
