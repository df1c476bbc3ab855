// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey.h"

#include <algorithm>
#include <cctype>

#include "core/option_visitors.h"
#include "io/csd.h"
#include "io/survey_checks.h"
#include "io/value_file.h"

namespace swath::io {
namespace {

using core::Fault;
using core::Value;

std::string ending_of(const std::filesystem::path& file) {
  std::string e = file.extension().string();
  std::transform(e.begin(), e.end(), e.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return e;
}

}  // namespace

std::filesystem::path resolve(const Survey& survey, const std::filesystem::path& file) {
  return file.is_absolute() ? file : survey.folder / file;
}

LaserFormat format_of(const LaserFile& f) {
  if (f.format != LaserFormat::automatic) return f.format;
  const std::string e = ending_of(f.file);
  if (e == ".csv" || e == ".txt" || e == ".asc") return LaserFormat::text;
  if (e == ".npy") return LaserFormat::npy;
  if (e == ".las" || e == ".laz") return LaserFormat::las;
  return e == ".csd" ? LaserFormat::csd : LaserFormat::automatic;
}

TrajectoryFormat format_of(const TrajectoryFile& f) {
  if (f.format != TrajectoryFormat::automatic) return f.format;
  const std::string e = ending_of(f.file);
  if (e == ".out" || e == ".sbet") return TrajectoryFormat::sbet;
  if (e == ".csv" || e == ".txt" || e == ".pos") return TrajectoryFormat::text;
  return e == ".csd" ? TrajectoryFormat::csd : TrajectoryFormat::automatic;
}

RecordFormat format_of(const ImuFile& f) {
  if (f.format != RecordFormat::automatic) return f.format;
  const std::string e = ending_of(f.file);
  if (e == ".csv" || e == ".txt" || e == ".asc") return RecordFormat::text;
  return e == ".npy" ? RecordFormat::npy : RecordFormat::automatic;
}

GnssFormat format_of(const GnssFile& f) {
  if (f.format != GnssFormat::automatic) return f.format;
  const std::string e = ending_of(f.file);
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

std::vector<LineWindow> line_windows(const Survey& survey) {
  std::vector<LineWindow> out;
  if (survey.lines.empty()) return out;
  core::TimeReader clock = reader_of(survey.line_time, "line_time");
  for (const FlightLine& l : survey.lines) {
    LineWindow w{l.id, 0, 0};
    w.start = clock(l.start.value);
    w.end = w.start + (l.end - l.start).value;
    out.push_back(w);
  }
  std::sort(out.begin(), out.end(), [](const LineWindow& a, const LineWindow& b) { return a.start < b.start; });
  return out;
}

void load_calibration(const std::filesystem::path& file, core::Calibration& calibration, core::SensorSigma& sigma) {
  if (ending_of(file) == ".csd") {
    const core::Calibration header = calibration_of(CsdReader(file).header());
    calibration.roll = header.roll;
    calibration.pitch = header.pitch;
    calibration.heading = header.heading;
    return;
  }
  const Value tree = read_value_file(file);
  std::vector<Fault> faults;
  if (!tree.is_object()) throw core::usage_error("is no table of calibration values", file.string());
  const Value* nested = tree.find("calibration");
  core::read_options(core::described(calibration), nested ? *nested : tree, nested ? "calibration" : "", faults,
                     nested ? std::vector<std::string>{} : std::vector<std::string>{"sigma"});
  if (const Value* s = tree.find("sigma")) core::read_options(core::described(sigma), *s, "sigma", faults);
  core::throw_if_any(faults);
}

core::Value calibration_tree(const core::Calibration& calibration, const core::SensorSigma& sigma) {
  core::Calibration c = calibration;
  core::SensorSigma s = sigma;
  Value out = Value::object();
  out["calibration"] = core::effective_values(core::described(c));
  out["sigma"] = core::effective_values(core::described(s));
  return out;
}

Survey read_survey(const core::Value& tree, const std::filesystem::path& folder) {
  if (!tree.is_object()) throw core::usage_error("a survey is a table", tree.where.text());
  Survey survey;
  survey.folder = folder;
  std::vector<Fault> faults;
  core::read_options(core::described(survey), tree, "", faults);
  check_survey(survey, tree, faults);
  std::stable_sort(faults.begin(), faults.end(), [](const Fault& a, const Fault& b) {
    return std::pair(a.where.line, a.where.column) < std::pair(b.where.line, b.where.column);
  });
  core::throw_if_any(faults);
  if (survey.calibration_file) load_calibration(resolve(survey, *survey.calibration_file), survey.calibration, survey.sigma);
  return survey;
}

Survey read_survey(const std::filesystem::path& file) { return read_survey(read_value_file(file), file.parent_path()); }

}  // namespace swath::io
