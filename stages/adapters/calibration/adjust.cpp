// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/calibration/calibrations.h"

#include "calib/adjust/start_sigmas.h"
#include "calib/report/calibration_report.h"
#include "calib/report/delivered.h"
#include "calib/report/verdict.h"
#include "core/config/units.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "stages/adapters/calibration/calibration_flight.h"
#include "stages/calibration_views.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;

/// What calib.flat_target found before in this run: flat_target.json, as it wrote it. Empty where it did not run or found no target.
std::vector<calib::TargetReading> readings_of(const core::Value& tree) {
  constexpr double arc_second = core::degree / 3600;
  std::vector<calib::TargetReading> out;
  for (const auto& [key, parameter] :
       {std::pair{"roll", georef::boresight_roll}, {"pitch", georef::boresight_pitch}, {"heading", georef::boresight_heading}}) {
    const core::Value* angle = tree.find(key);
    const core::Value* mean = angle ? angle->find("mean_deg") : nullptr;
    if (!mean) continue;
    out.push_back({parameter,
                   mean->as_number() * core::degree,
                   angle->find("sigma_arcsec")->as_number() * arc_second,
                   angle->find("readings")->items().size(),
                   {}});
  }
  if (const core::Value* range = tree.find("range_offset"))
    out.push_back({georef::range_offset, range->find("mean_m")->as_number(), range->find("sigma_m")->as_number(), 1, {}});
  if (const core::Value* scale = tree.find("scan_scale"))
    out.push_back({georef::scan_scale, scale->find("value")->as_number(), 1e-6 * scale->find("sigma_ppm")->as_number(), 1, {}});
  return out;
}

AdjustFindings found_in(const calib::Calibrated& c) {
  AdjustFindings out;
  for (const calib::Estimate& e : c.adjustment.estimates)
    if (e.estimated)
      out.estimates.emplace_back(
          std::string(calib::words_of(e.parameter).key),
          EstimateResult{e.value, e.sigma, e.start, calib::is_delivered(c.adjustment, e.parameter), std::string(calib::name_of(e.grade))});
  out.planes = c.ties.planes.size();
  out.tie_returns = c.ties.returns.size();
  out.rounds = c.rounds;
  out.sigma0 = c.adjustment.sigma0;
  out.findings = calib::sentences(c.adjustment.findings);
  return out;
}

}  // namespace

std::vector<std::string> adjust_products(const AdjustStageOptions&) {
  return {"calibration.json", "report.html", "residuals.csv", "corrections.csv", "planes.csv", "sections.csv", "figures", "differences"};
}

AdjustFindings adjust_flight(const Context& context, const trajectory::Trajectory& trajectory, const georef::ShotStream&,
                             const AdjustStageOptions& o, const Output& to, const core::OnProgress& progress, core::Tally& tally) {
  const io::Survey& survey = context.survey;
  const PreparedFlight prepared(context, trajectory, o.errors, tally);
  calib::CalibrateOptions how = o;
  how.adjust.apriori = calib::start_sigmas(survey.sigma);
  const calib::Calibrated calibrated = calib::calibrate(prepared.flight, how, tally, progress);
  calib::CalibrationReport report = report_on(context, prepared.lines);
  report.adjustment = calibrated.adjustment;
  report.ties = calibrated.ties;
  report.notes = calibrated.notes;
  if (const fs::path target = context.made("flat_target.json"); !target.empty()) {
    report.flat_target = io::parse_json(io::read_text_file(target), target.string());
    report.readings = readings_of(report.flat_target);
  }
  const calib::DeliveredCalibration result = calib::delivered(calibrated.adjustment, survey.sigma);
  add_views(report, view_calibration(context, {&survey.calibration, &trajectory}, {&result.calibration, &trajectory}, calibrated.ties,
                                     prepared.flight.targets, o.differences, cell_for(prepared.lines), static_cast<size_t>(o.sections)));
  calib::write_calibration_report(report, to.folder);
  return found_in(calibrated);
}

}  // namespace swath::stages
