// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/calibration/calibration_flight.h"

#include <algorithm>

#include "core/time.h"

namespace swath::stages {
namespace {

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

std::vector<std::string> with_report(std::vector<std::string> own) {
  for (const char* name : {"report.html", "residuals.csv", "corrections.csv", "planes.csv", "sections.csv", "figures", "differences"})
    own.emplace_back(name);
  return own;
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

}  // namespace swath::stages
