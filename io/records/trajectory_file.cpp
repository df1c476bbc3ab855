// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/trajectory_file.h"

#include <algorithm>
#include <cmath>

#include "core/config/units.h"
#include "core/error.h"
#include "core/geo/crs.h"
#include "core/geo/frames.h"
#include "core/records/trajectory_columns.h"
#include "core/statistics.h"
#include "io/records/csd.h"
#include "io/records/sbet.h"
#include "io/records/trajectory_faults.h"
#include "io/survey/wild_records.h"
#include "io/text/cut_line.h"
#include "io/text/delimited.h"

namespace swath::io {
namespace {

using core::TrajectoryData;

constexpr double gap_steps = 5.0, gap_seconds = 0.05;
constexpr const char* trajectory_records = "trajectory records";

/// Projected or geographic coordinates of a stated CRS to geodetic WGS84, in place (x = easting or longitude).
void to_geodetic(const std::string& crs, const std::string& name, double unit, std::vector<double>& east, std::vector<double>& north,
                 std::vector<double>& height) {
  const core::Crs from(crs);
  if (from.is_geocentric()) throw core::Error("geocentric coordinates are not read as a trajectory", name, "export latitude and longitude");
  if (from.is_geographic())
    for (auto* c : {&east, &north})
      for (double& v : *c) v = core::to_degrees(v * unit);
  const core::Transform transform(from, core::wgs84_geodetic());
  if (const size_t lost = transform.apply(east.data(), north.data(), height.data(), east.size()); lost > 0 && !are_few(lost, east.size()))
    throw core::Error(core::counted(lost, "position lies", "positions lie") + " outside the domain of " + from.name(), name,
                      "check crs and the columns");
  for (auto* c : {&east, &north})
    for (double& v : *c) v *= core::degree;
}

TrajectoryData read_text(const std::filesystem::path& path, const TrajectoryFile& f, core::Tally& tally) {
  const std::string name = path.string();
  const DelimitedLayout layout = inspect_delimited(path, f.delimiter);
  count_cut_line(layout.cut_line, path, trajectory_records, tally);
  const double unit = radians_per(f.angle_unit);
  if (unit == 0) throw core::usage_error("the unit of angles is not stated", name, "angle_unit = \"deg\", \"rad\" or \"gon\"");
  const TrajectoryColumns& c = f.columns;
  TrajectoryData out;
  std::vector<double> week;
  std::vector<size_t> at;
  std::vector<std::pair<std::vector<double>*, double>> doubles;  // column and factor to SI
  std::vector<std::pair<std::vector<float>*, double>> floats;
  for (const auto& [column, to, factor] : {std::tuple{&c.time, &out.time, 1.0},
                                           {&c.latitude, &out.latitude, 1.0},
                                           {&c.longitude, &out.longitude, 1.0},
                                           {&c.height, &out.height, 1.0},
                                           {&c.roll, &out.roll, unit},
                                           {&c.pitch, &out.pitch, unit},
                                           {&c.heading, &out.heading, unit},
                                           {&c.v_north, &out.v_north, 1.0},
                                           {&c.v_east, &out.v_east, 1.0},
                                           {&c.v_down, &out.v_down, 1.0},
                                           {&c.week, &week, 1.0}}) {
    if (column->empty()) continue;
    at.push_back(column_of(layout, *column, path));
    doubles.emplace_back(to, factor);
  }
  for (const auto& [column, to, factor] : {std::tuple{&c.sigma_north, &out.sigma_north, 1.0},
                                           {&c.sigma_east, &out.sigma_east, 1.0},
                                           {&c.sigma_down, &out.sigma_down, 1.0},
                                           {&c.sigma_roll, &out.sigma_roll, unit},
                                           {&c.sigma_pitch, &out.sigma_pitch, unit},
                                           {&c.sigma_heading, &out.sigma_heading, unit}}) {
    if (column->empty()) continue;
    at.push_back(column_of(layout, *column, path));
    floats.emplace_back(to, factor);
  }
  DelimitedReader reader(path, layout, at);
  std::vector<double> row(at.size());
  while (reader.next(row.data())) {
    for (size_t i = 0; i < doubles.size(); ++i) doubles[i].first->push_back(row[i] * doubles[i].second);
    for (size_t i = 0; i < floats.size(); ++i) floats[i].first->push_back(static_cast<float>(row[doubles.size() + i] * floats[i].second));
  }
  tally.read(trajectory_records, out.time.size());
  out.time = gps_times(f.time, name, out.time, week, impossible_times, tally);
  if (f.crs.empty()) {
    for (auto* angles : {&out.latitude, &out.longitude})
      for (double& v : *angles) v *= unit;
  } else {
    to_geodetic(f.crs, name, unit, out.longitude, out.latitude, out.height);
  }
  return out;
}

TrajectoryData read_csd(const std::filesystem::path& path, const TrajectoryFile& f, core::Tally& tally) {
  if (f.time.week) hold_csd_week(path, *f.time.week);
  CsdReader file(path);
  TimeTags tags = f.time;
  if (tags.scale == core::TimeScale::unstated) {
    tags.scale = core::TimeScale::gps_week;
    tags.week = tags.week ? tags.week : file.header().gps_week;
  }
  TrajectoryData out = read_csd_trajectory(file, f.spacing, tally);
  core::TimeReader clock = reader_of(tags, path.string());
  for (double& t : out.time) t = clock(t);
  return out;
}

/// Sigmas that the file does not have, from the survey; counted, because the points' uncertainties rest on them.
void fill_sigmas(TrajectoryData& t, const TrajectoryFile& f, core::Tally& tally) {
  if (t.sigma_north.empty() || t.sigma_heading.empty())
    tally.count("trajectory files without sigmas of their own: those of the survey taken", f.file.filename().string());
  for (const auto& [column, value] : {std::pair{&t.sigma_north, f.sigma_horizontal.value},
                                      {&t.sigma_east, f.sigma_horizontal.value},
                                      {&t.sigma_down, f.sigma_vertical.value},
                                      {&t.sigma_roll, f.sigma_roll_pitch.value},
                                      {&t.sigma_pitch, f.sigma_roll_pitch.value},
                                      {&t.sigma_heading, f.sigma_heading.value}})
    if (column->empty()) column->assign(t.size(), static_cast<float>(value));
}

}  // namespace

void check_trajectory(TrajectoryData& t, const std::string& name, core::Tally& tally) {
  const auto where = [&](size_t i) { return name + ": record " + std::to_string(i); };
  if (t.size() == 0) throw core::Error("the trajectory has no records", name);
  leave_out_faults(t, name, tally);
  std::vector<std::uint8_t> repeated(t.size(), 0);
  std::vector<double> steps;
  for (size_t i = 0; i < t.size(); ++i) {
    t.longitude[i] = core::wrap_pi(t.longitude[i]);
    t.roll[i] = core::wrap_pi(t.roll[i]);
    t.heading[i] = core::wrap_two_pi(t.heading[i]);
    if (i == 0) continue;
    const double step = t.time[i] - t.time[i - 1];
    if (step < 0)
      throw core::Error("time goes back by " + core::format_number(-step, 4) + " s", where(i), "export the trajectory sorted by time");
    repeated[i] = step == 0;
    if (step > 0) steps.push_back(step);
  }
  if (!steps.empty()) {
    const double gap = std::max(gap_steps * core::median(std::move(steps)), gap_seconds);
    for (size_t i = 1; i < t.size(); ++i)
      if (const double step = t.time[i] - t.time[i - 1]; step > gap)
        tally.count("trajectory gaps", where(i) + ": " + core::format_number(std::round(step * 1e3) / 1e3) + " s before it");
  }
  for (size_t i = 0; i < t.size(); ++i)
    if (repeated[i]) tally.count("trajectory records at a repeated time, left out", where(i));
  leave_out(t, repeated);
}

namespace {

TrajectoryData read_file(const Survey& survey, const TrajectoryFile& f, core::Tally& tally) {
  const std::filesystem::path path = resolve(survey, f.file);
  TrajectoryData out;
  switch (format_of(f)) {
    case TrajectoryFormat::sbet: {
      std::optional<std::filesystem::path> accuracy;
      if (f.accuracy) accuracy = resolve(survey, *f.accuracy);
      out = read_sbet(path, f.time, f.wander, f.velocity_axes, accuracy, tally);
      break;
    }
    case TrajectoryFormat::text:
      out = read_text(path, f, tally);
      break;
    case TrajectoryFormat::csd:
      out = read_csd(path, f, tally);
      break;
    case TrajectoryFormat::automatic:
      throw core::usage_error("the name does not tell the format of the trajectory", path.string(),
                              "state format = \"sbet\", \"text\" or \"csd\"");
  }
  fill_sigmas(out, f, tally);
  check_trajectory(out, path.string(), tally);
  return out;
}

}  // namespace

TrajectoryData read_trajectory(const Survey& survey, const TrajectoryFile& f, core::Tally& tally) {
  TrajectoryData out = read_file(survey, f, tally);
  tally.keep(trajectory_records, out.size());
  return out;
}

TrajectoryData read_trajectory(const Survey& survey, core::Tally& tally) {
  const std::vector<TrajectoryFile> files = trajectory_files(survey);
  if (files.empty()) throw core::usage_error("the survey has no trajectory");
  std::vector<std::pair<TrajectoryData, std::string>> parts;
  for (const TrajectoryFile& f : files) parts.emplace_back(read_file(survey, f, tally), f.file.string());
  std::stable_sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.first.time.front() < b.first.time.front(); });
  const bool velocities = std::all_of(parts.begin(), parts.end(), [](const auto& p) { return p.first.has_velocity(); });
  TrajectoryData out;
  for (size_t k = 0; k < parts.size(); ++k) {
    TrajectoryData& part = parts[k].first;
    if (!velocities && part.has_velocity()) {
      tally.count("trajectory files whose velocities are not used, as another has none", parts[k].second);
      for (auto* c : {&part.v_north, &part.v_east, &part.v_down}) c->clear();
    }
    if (k > 0 && part.time.front() < out.time.back())
      throw core::Error(parts[k - 1].second + " and " + parts[k].second + " overlap by " +
                            core::format_number(out.time.back() - part.time.front(), 4) + " s",
                        parts[k].second, "trim one of them: two solutions for one instant have no order");
    core::for_each_trajectory_column(
        [&](auto member, const char*) { (out.*member).insert((out.*member).end(), (part.*member).begin(), (part.*member).end()); });
  }
  if (parts.size() > 1) check_trajectory(out, "joined trajectory", tally);
  tally.keep(trajectory_records, out.size());
  return out;
}

}  // namespace swath::io
