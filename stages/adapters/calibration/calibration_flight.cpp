// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/calibration/calibration_flight.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/time.h"
#include "stages/shot_source.h"

namespace swath::stages {
namespace {

double metres_down(const std::vector<calib::FlownLine>& lines) {
  double sum = 0, n = 0;
  for (const calib::FlownLine& l : lines)
    if (std::isfinite(l.height)) sum += l.height, n += 1;
  return n > 0 ? sum / n : 0.0;
}

/// The lines of the flight; what is wrong with them is counted, or refused.
std::vector<calib::FlownLine> fly(const calib::CalibrationFlight& flight, core::Tally& tally) {
  const georef::ShotGeometry geometry(flight.scanner, flight.start);
  calib::FlownLines flown(geometry, *flight.trajectory);
  flight.shots([&](int line, const core::Shots& shots) { flown.add(line, shots); });
  std::vector<calib::FlownLine> lines = flown.lines();
  for (const calib::Finding& f : calib::check_lines(lines)) {
    if (f.refuses) throw core::Error(f.what, "laser records", f.cure);
    tally.count(f.what + " (" + f.cure + ")");
  }
  return lines;
}

/// The same cells of another lattice of the same cell size; void where the grid does not reach.
core::Grid on_lattice(const core::Grid& from, const core::Lattice& lattice) {
  core::Grid out(lattice);
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      const auto si = lattice.i0 + i - from.lattice.i0, sj = lattice.j0 + j - from.lattice.j0;
      if (si < 0 || sj < 0 || si >= from.lattice.nx || sj >= from.lattice.ny) continue;
      const size_t at = from.lattice.at(static_cast<int>(si), static_cast<int>(sj));
      out.height[lattice.at(i, j)] = from.height[at];
      out.reason[lattice.at(i, j)] = from.reason[at];
    }
  return out;
}

calib::ReportOrigin origin_of(const Context& context, const std::vector<calib::FlownLine>& lines) {
  const io::Survey& survey = context.survey;
  calib::ReportOrigin out;
  out.program = "swath " SWATH_VERSION;
  if (!lines.empty() && !context.weekless) {
    double first = lines.front().first, last = lines.front().last;
    for (const calib::FlownLine& l : lines) first = std::min(first, l.first), last = std::max(last, l.last);
    out.flown_from = core::utc_text(first);
    out.flown_to = core::utc_text(last);
  }
  const auto add = [&](const char* what, const auto& files) {
    for (const auto& f : files) out.inputs.push_back(std::string(what) + ": " + f.file.string());
  };
  add("laser", survey.laser);
  add("trajectory", survey.trajectory);
  add("imu", survey.imu);
  add("gnss", survey.gnss);
  add("control", survey.control);
  if (survey.calibration_file) out.inputs.push_back("calibration: " + survey.calibration_file->string());
  return out;
}

}  // namespace

std::vector<std::filesystem::path> control_files(const io::Survey& survey) {
  std::vector<std::filesystem::path> out;
  for (const io::ControlFile& f : survey.control) out.push_back(io::resolve(survey, f.file));
  return out;
}

PreparedFlight::PreparedFlight(const Context& context, const trajectory::Trajectory& flown, const trajectory::ErrorModelOptions& options,
                               core::Tally& tally)
    : errors(flown.data(), options) {
  const io::Survey& survey = context.survey;
  flight.shots = stream_shots(context);
  flight.scanner = survey.scanner;
  flight.start = survey.calibration;
  flight.sensor = survey.sigma;
  flight.trajectory = &flown;
  flight.errors = &errors;
  flight.threads = context.threads;
  lines = fly(flight, tally);
  std::vector<std::pair<double, double>> times;
  for (const calib::FlownLine& l : lines) times.emplace_back(l.first, l.last);
  const double height = metres_down(lines), side = calib::side_for(lines, 1.0);
  flight.frame = calib::frame_of(times, height, flown);
  flight.scale = calib::scale_of(height, side > 0.0 ? 1.0 / (side * side) : 0.0, survey.sigma);
  flight.targets = calib::surveyed_targets(io::read_control(survey, tally), flight.frame, tally);
}

double cell_for(const std::vector<calib::FlownLine>& lines) {
  constexpr double returns = 12, step = 0.5;
  return std::max(step, step * std::ceil(calib::side_for(lines, returns) / step));
}

calib::CalibrationReport report_on(const Context& context, const std::vector<calib::FlownLine>& lines) {
  calib::CalibrationReport report;
  report.survey = context.survey.name;
  report.crs = context.product_crs;
  report.unit = context.unit;
  report.vertical_unit = context.vertical_unit;
  report.sensor = context.survey.sigma;
  report.origin = origin_of(context, lines);
  for (const calib::FlownLine& l : lines) {
    const auto named =
        std::find_if(context.survey.lines.begin(), context.survey.lines.end(), [&](const io::FlightLine& f) { return f.id == l.id; });
    report.lines.push_back({l.id, named == context.survey.lines.end() ? std::string() : named->name, l.heading, l.height, l.speed, l.length,
                            l.first, l.last, l.returns});
  }
  return report;
}

void add_views(calib::CalibrationReport& report, CalibrationViews views) {
  for (size_t k = 0; k < views.sections.size(); ++k) {
    calib::CrossSection section{views.sections[k].name, views.sections[k].width, views.sections[k].ends, {}, {}};
    for (const auto& [line, r] : views.sections_before[k]) section.before.push_back({line, r.along, r.height});
    for (const auto& [line, r] : views.sections_after[k]) section.after.push_back({line, r.along, r.height});
    report.sections.push_back(std::move(section));
  }
  for (calib::LineDifferenceMap& after : views.after) {
    const auto before = std::find_if(views.before.begin(), views.before.end(), [&](const calib::LineDifferenceMap& m) {
      return m.statistics.line_a == after.statistics.line_a && m.statistics.line_b == after.statistics.line_b;
    });
    calib::LineDifference both{after.statistics.line_a, after.statistics.line_b, core::Grid(), std::move(after.grid)};
    both.before = before == views.before.end() ? core::Grid(both.after.lattice) : on_lattice(before->grid, both.after.lattice);
    report.differences.push_back(std::move(both));
  }
  std::string bare;
  for (const calib::CheckResidual& c : views.checks) {
    if (std::isfinite(c.difference))
      report.checks.push_back({c.name, 0, c.difference, c.sigma, 1.0, c.difference / c.sigma, false});
    else
      bare += (bare.empty() ? "" : ", ") + c.name;
  }
  if (!bare.empty()) report.notes.push_back("Check points that too few returns lie around to be compared: " + bare + ".");
}

}  // namespace swath::stages
