// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/flight/kinematic.h"

#include <cmath>
#include <cstdio>
#include <limits>

#include "core/error.h"
#include "core/printable.h"
#include "io/raster/png.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "report/chart.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;
using trajectory::EventPosition;
using trajectory::EventPositions;
using trajectory::Interpolator;
using trajectory::Reach;

constexpr size_t least_fixes = 3;

/// The fixes that are of use; the others are counted.
core::GnssData usable_fixes(const core::GnssData& gnss, core::Tally& tally) {
  core::GnssData out;
  for (size_t i = 0; i < gnss.size(); ++i) {
    if (!trajectory::usable(gnss, i)) {
      tally.count("GNSS fixes without a position or a covariance, left out", "fix " + std::to_string(i + 1));
      continue;
    }
    out.time.push_back(gnss.time[i]);
    out.position.push_back(gnss.position[i]);
    out.covariance.push_back(gnss.covariance[i]);
  }
  return out;
}

std::string number(double v, int decimals) {
  if (!std::isfinite(v)) return {};
  char text[40];
  std::snprintf(text, sizeof text, "%.*f", decimals, v);
  return text;
}
std::string numbers(const Eigen::Vector3d& v, int decimals) {
  return number(v[0], decimals) + "," + number(v[1], decimals) + "," + number(v[2], decimals);
}

std::string flags_of(const EventPosition& e, bool doubtful) {
  std::string out;
  const auto add = [&](const char* flag) { out += (out.empty() ? "" : ";") + std::string(flag); };
  if (e.reach == Reach::outside) add("outside_gnss");
  if (e.reach == Reach::gap) add("gnss_gap");
  if (e.reach == Reach::too_few) add("too_few_fixes");
  if (e.reach == Reach::partial) add("short_window");
  if (doubtful) add("doubtful_time");
  return out;
}

constexpr const char* header =
    "id,strip,technique,gps_time,easting,northing,height,x,y,z,v_east,v_north,v_up,sigma_east,sigma_north,sigma_up,"
    "empirical_east,empirical_north,empirical_up,sigma_v_east,sigma_v_north,sigma_v_up,sigma_time,fixes,flags\n";

/// One row per event, metres and m/s (easting, northing and height: units of the CRS); fields without a value are empty.
std::string table(const Context& context, const core::EventData& events, const EventPositions& solved) {
  const core::Transform to_map(core::wgs84_ecef(), context.crs);
  const double height_unit = context.crs.has_height_unit() ? 1.0 : context.vertical_unit;
  const int decimals = context.crs.is_geographic() ? 10 : 4;
  std::string out = header;
  for (size_t i = 0; i < events.size(); ++i) {
    const EventPosition& e = solved.events[i];
    Eigen::Vector3d map = e.position;
    if (reached(e.reach)) {
      map = to_map(e.position);
      map.z() /= height_unit;
    }
    // What the time's own error moves the antenna along its path.
    const double along = events.sigma[i] > 0.0 ? events.sigma[i] * e.velocity.norm() : std::nan("");
    const Eigen::Vector3d empirical = reached(e.reach) ? solved.empirical : e.position;
    out += core::csv_field(events.id[i]) + "," + (events.strip[i] ? std::to_string(events.strip[i]) : "") + "," +
           core::csv_field(events.technique[i]) + "," + number(events.time[i], 7) + "," + number(map.x(), decimals) + "," +
           number(map.y(), decimals) + "," + number(map.z(), 4) + "," + numbers(e.position, 4) + "," + numbers(e.velocity, 4) + "," +
           numbers(e.sigma, 4) + "," + numbers(empirical, 4) + "," + numbers(e.velocity_sigma, 4) + "," + number(along, 4) + "," +
           std::to_string(e.fixes) + "," + flags_of(e, events.doubtful[i]) + "\n";
  }
  return out;
}

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
        s.y.push_back(100.0 * test.difference[static_cast<size_t>(method)][k][axis]);
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

void count(const Context& context, const core::EventData& events, const core::GnssData& gnss, const EventPositions& solved,
           core::Tally& tally) {
  size_t outside = 0;
  for (size_t i = 0; i < events.size(); ++i) {
    const std::string event = "event " + events.id[i];
    switch (solved.events[i].reach) {
      case Reach::full:
        break;
      case Reach::partial:
        tally.count("events near a gap or an end of the GNSS record: short window", event);
        break;
      case Reach::too_few:
        tally.count("events too close to a gap or an end of the GNSS record, without position", event);
        break;
      case Reach::gap:
        tally.count("events in a gap of the GNSS record, without position", event);
        break;
      case Reach::outside:
        tally.count("events outside the GNSS record, without position", event);
        ++outside;
        break;
    }
    if (events.doubtful[i]) tally.count("events whose time is doubtful", event);
  }
  if (events.size() > 0 && outside == events.size())
    throw core::Error("trajectory.kinematic: all " + std::to_string(outside) + " events lie outside the GNSS record (events " +
                          number(events.time.front(), 1) + " to " + number(events.time.back(), 1) + " s, fixes " +
                          number(gnss.time.front(), 1) + " to " + number(gnss.time.back(), 1) + " s of GPS time)",
                      context.survey.name, "is the time scale of the events, or of the fixes, stated as it is?");
}

KinematicFindings found_in(const core::EventData& events, const core::GnssData& gnss, const EventPositions& solved, Interpolator method) {
  KinematicFindings r;
  r.method = core::Choices<Interpolator>::names[static_cast<size_t>(method)];
  r.fixes = gnss.size();
  r.gaps = solved.gaps;
  r.longest_step = solved.longest_step;
  r.events = events.size();
  std::vector<Eigen::Vector3d> formal;
  for (const EventPosition& e : solved.events)
    if (reached(e.reach)) formal.push_back(e.sigma);
  r.with_position = formal.size();
  if (!formal.empty()) r.formal = trajectory::statistics_of(formal, formal).median_formal;
  if (solved.empirical.allFinite()) r.empirical = solved.empirical;
  r.leave_one_out = solved.test;
  return r;
}

}  // namespace

std::vector<std::string> kinematic_products(const KinematicStageOptions& o) {
  std::vector<std::string> out{o.file, "kinematic.json"};
  if (o.leave_one_out) out.insert(out.end(), {"leave_one_out.txt", "leave_one_out.png", "leave_one_out.svg"});
  return out;
}

void expect_crs(const Context& context, const KinematicStageOptions&) {
  if (context.survey.crs.empty())
    throw core::usage_error("trajectory.kinematic: the survey states no CRS for the table of events", context.survey.name,
                            "state it, for example crs = \"EPSG:32632\"");
}

KinematicFindings position_events(const core::GnssData& all, const core::EventData& events, const Context& context,
                                  const KinematicStageOptions& o, const Output& to, core::Tally& tally) {
  const core::GnssData gnss = usable_fixes(all, tally);
  if (gnss.size() < least_fixes)
    throw core::Error("trajectory.kinematic: " + std::to_string(gnss.size()) + " GNSS fixes are of use, " + std::to_string(least_fixes) +
                          " are the least",
                      context.survey.name, "see the counts of the stage that reads them");
  const EventPositions solved = trajectory::positions_at(gnss, events.time, o.method, o);
  count(context, events, gnss, solved, tally);
  KinematicFindings findings = found_in(events, gnss, solved, o.method);

  io::write_text_file(to.folder / o.file, table(context, events, solved));
  io::write_text_file(to.folder / "kinematic.json", io::to_json(core::reported(findings)));
  if (!o.leave_one_out) return findings;
  const report::Chart chart = drawing(solved.test, gnss.time.front());
  io::write_text_file(to.folder / "leave_one_out.txt", solved.test.table());
  io::write_png(to.folder / "leave_one_out.png", report::draw(chart));
  io::write_text_file(to.folder / "leave_one_out.svg", report::svg(chart));
  return findings;
}

}  // namespace swath::stages
