// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/survey.h"

#include <algorithm>

#include "core/geo/crs.h"
#include "core/printable.h"
#include "io/las/las_ending.h"
#include "io/store/address.h"
#include "io/survey/wild_records.h"

namespace swath::io {

std::filesystem::path resolve(const Survey& survey, const std::filesystem::path& file) {
  return file.is_absolute() || is_address(file) ? file : survey.folder / file;
}

double metres_per_height(const Survey& survey, const core::Crs& crs) {
  if (crs.has_height_unit()) return crs.vertical_metres_per_unit();
  if (survey.height_unit) return survey.height_unit->value;
  return survey.points.empty() || crs.is_geographic() ? 1.0 : crs.metres_per_unit();
}

LaserFormat format_of(const LaserFile& f) {
  if (f.format != LaserFormat::automatic) return f.format;
  const std::string e = core::lower_case(f.file.extension().string());
  if (e == ".csv" || e == ".txt" || e == ".asc") return LaserFormat::text;
  if (e == ".npy") return LaserFormat::npy;
  if (has_las_ending(f.file)) return LaserFormat::las;
  return e == ".csd" ? LaserFormat::csd : LaserFormat::automatic;
}

TrajectoryFormat format_of(const TrajectoryFile& f) {
  if (f.format != TrajectoryFormat::automatic) return f.format;
  const std::string e = core::lower_case(f.file.extension().string());
  if (e == ".out" || e == ".sbet") return TrajectoryFormat::sbet;
  if (e == ".csv" || e == ".txt" || e == ".pos") return TrajectoryFormat::text;
  return e == ".csd" ? TrajectoryFormat::csd : TrajectoryFormat::automatic;
}

RecordFormat format_of(const ImuFile& f) {
  if (f.format != RecordFormat::automatic) return f.format;
  const std::string e = core::lower_case(f.file.extension().string());
  if (e == ".csv" || e == ".txt" || e == ".asc") return RecordFormat::text;
  return e == ".npy" ? RecordFormat::npy : RecordFormat::automatic;
}

GnssFormat format_of(const GnssFile& f) {
  if (f.format != GnssFormat::automatic) return f.format;
  const std::string e = core::lower_case(f.file.extension().string());
  if (e == ".csv" || e == ".txt" || e == ".asc") return GnssFormat::text;
  if (e == ".pos") return GnssFormat::pos;
  return e == ".nmea" || e == ".log" ? GnssFormat::nmea : GnssFormat::automatic;
}

std::vector<TrajectoryFile> trajectory_files(const Survey& survey) {
  if (!survey.trajectory.empty()) return survey.trajectory;
  std::vector<TrajectoryFile> out;
  for (const LaserFile& f : survey.laser) {
    if (format_of(f) != LaserFormat::csd) continue;
    TrajectoryFile t;
    t.file = f.file;
    t.format = TrajectoryFormat::csd;
    t.time = f.time;
    out.push_back(t);
  }
  return out;
}

double seconds_of(const Survey& survey, const FlightLine& line) {
  const double seconds = (line.end - line.start).value, next = seconds + period_of(survey.line_time.scale);
  return seconds <= 0.0 && next <= longest_crossing ? next : seconds;
}

std::vector<LineWindow> line_windows(const Survey& survey) {
  std::vector<LineWindow> out;
  if (survey.lines.empty()) return out;
  core::TimeReader clock = reader_of(survey.line_time, "line_time");
  for (const FlightLine& l : survey.lines) {
    LineWindow w{l.id, 0, 0};
    w.start = clock(l.start.value);
    w.end = w.start + seconds_of(survey, l);
    out.push_back(w);
  }
  std::sort(out.begin(), out.end(), [](const LineWindow& a, const LineWindow& b) { return a.start < b.start; });
  return out;
}

}  // namespace swath::io
