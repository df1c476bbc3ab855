// SPDX-License-Identifier: GPL-3.0-or-later
// Calibration of a flight by rigorous adjustment on planes.
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "calib/adjust/calibrate.h"
#include "calib/adjust/prepared_flight.h"
#include "calib/adjust/start_sigmas.h"
#include "calib/report/calibration_report.h"
#include "calib/report/delivered.h"
#include "calib/report/flat_target_report.h"
#include "calib/report/flight_views.h"
#include "calib/report/verdict.h"
#include "core/config/option.h"
#include "core/config/result.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/calibration/calibration_flight.h"
#include "stages/once.h"
#include "trajectory/ins/error_model.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;
struct AdjustStageOptions : calib::CalibrateOptions, FlightStageOptions {};

template <class V>
void describe(AdjustStageOptions& o, V& v) {
  describe(static_cast<calib::CalibrateOptions&>(o), v);
  describe(static_cast<FlightStageOptions&>(o), v);
}

struct EstimateResult {
  double value = 0.0, sigma = 0.0, start = 0.0;
  bool delivered = false;
  std::string grade;
};

template <class V>
void describe(const EstimateResult& r, V& v) {
  const core::Form si = core::Form{"SI"}.always();
  v.result("value", r.value, si, "Estimate, in rad, m or as a ratio.");
  v.result("sigma", r.sigma, si, "Its standard deviation.");
  v.result("start", r.start, si, "Value in the survey.");
  v.result("delivered", r.delivered, "True: it is written into calibration.json.");
  v.result("grade", r.grade, "How well the flight determines it.");
}

struct AdjustFindings {
  std::vector<std::pair<std::string, EstimateResult>> estimates{};
  std::uint64_t planes = 0, tie_returns = 0;
  int rounds = 0;
  double sigma0 = 0.0;
  std::vector<std::string> findings{};
};

template <class V>
void describe(const AdjustFindings& r, V& v) {
  v.named_tables("estimates", r.estimates, "Estimates by parameter.");
  v.result("planes", r.planes, core::plain().in_summary(), "Planes that several lines have seen.");
  v.result("tie_returns", r.tie_returns, core::plain().in_summary(), "Returns on these planes.");
  v.result("rounds", r.rounds, "Rounds of the adjustment.");
  v.result("sigma0", r.sigma0, core::plain(3).in_summary().always(), "A posteriori sigma of unit weight.");
  v.result("findings", r.findings, "What the adjustment found, as sentences.");
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

std::vector<std::string> adjust_products(const AdjustStageOptions&) { return with_report({"calibration.json"}); }

AdjustFindings adjust_flight(const Context& context, const trajectory::Trajectory& trajectory, const georef::ShotStream& shots,
                             const AdjustStageOptions& o, const Output& to, const core::OnProgress& progress, core::Tally& tally) {
  const io::Survey& survey = context.survey;
  const calib::PreparedFlight prepared(survey, shots, context.threads, trajectory, o.errors, tally);
  calib::CalibrateOptions how = o;
  how.adjust.apriori = calib::start_sigmas(survey.sigma);
  const calib::Calibrated calibrated = calib::calibrate(prepared.flight, how, tally, progress);
  calib::CalibrationReport report = report_on(context, prepared.lines);
  report.adjustment = calibrated.adjustment;
  report.ties = calibrated.ties;
  report.notes = calibrated.notes;
  if (const fs::path target = context.made("flat_target.json"); !target.empty()) {
    report.flat_target = io::parse_json(io::read_text_file(target), target.string());
    report.readings = calib::readings_in(report.flat_target);
  }
  const calib::DeliveredCalibration result = calib::delivered(calibrated.adjustment, survey.sigma);
  calib::add_views(prepared.flight, {context.crs, context.unit, context.origin}, {result.calibration, trajectory}, o.differences,
                   prepared.cell(), o.sections, report);
  calib::write_calibration_report(report, to.folder);
  return found_in(calibrated);
}

}  // namespace

Entry adjust_stage() {
  return once<adjust_flight>("calib.adjust",
                             "Rigorous adjustment of a calibration flight: boresight, range and scan corrections and the trajectory's line "
                             "corrections from planes "
                             "that several lines have seen; calibration.json and report.html.",
                             {.inputs = files_in<&io::Survey::control>, .products = adjust_products});
}

}  // namespace swath::stages
