// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/calibrate.h"
#include "calib/report/calibration_report.h"
#include "calib/report/delivered.h"
#include "calib/report/verdict.h"
#include "calib/start_sigmas.h"
#include "core/units.h"
#include "io/output_file.h"
#include "io/value_file.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/calibration_flight.h"
#include "stages/calibration_views.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;

struct AdjustStageOptions : calib::CalibrateOptions {
  trajectory::ErrorModelOptions errors;
  calib::LineHeightOptions differences;
  int sections = 4;
};

template <class V>
void describe(AdjustStageOptions& o, V& v) {
  describe(static_cast<calib::CalibrateOptions&>(o), v);
  v.table("errors", o.errors, "Errors of trajectories that state no covariances between instants.");
  v.table("differences", o.differences, "Maps of the differences of overlapping lines.");
  v.option("sections", o.sections, core::within(0, 50), "Cross sections drawn in the report.");
}

/// What calib.flat_target found before in this run: flat_target.json, as it wrote it. Empty where it did not run or found no target.
std::vector<calib::TargetReading> readings_of(const core::Value& tree) {
  constexpr double arc_second = core::degree / 3600;
  std::vector<calib::TargetReading> out;
  for (const auto& [key, parameter] :
       {std::pair{"roll", calib::boresight_roll}, {"pitch", calib::boresight_pitch}, {"heading", calib::boresight_heading}}) {
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
    out.push_back({calib::range_offset, range->find("mean_m")->as_number(), range->find("sigma_m")->as_number(), 1, {}});
  if (const core::Value* scale = tree.find("scan_scale"))
    out.push_back({calib::scan_scale, scale->find("value")->as_number(), 1e-6 * scale->find("sigma_ppm")->as_number(), 1, {}});
  return out;
}

class Adjust : public OptionStage<AdjustStageOptions> {
 public:
  const Info& info() const override {
    static const Info info{"calib.adjust",
                           "Rigorous adjustment of a calibration flight: boresight, range and scan corrections and the trajectory's line "
                           "corrections from planes "
                           "that several lines have seen; calibration.json and report.html.",
                           {Grain::survey},
                           {},
                           {},
                           {Product::trajectory, Product::shots},
                           {}};
    return info;
  }
  std::vector<std::string> products() const override {
    return {"calibration.json", "report.html", "residuals.csv", "corrections.csv", "planes.csv", "sections.csv", "figures", "differences"};
  }
  std::vector<fs::path> inputs(const io::Survey& survey) const override { return control_files(survey); }

  void run_survey(Context& context, core::Tally& tally, core::Value& findings) const override {
    const io::Survey& survey = context.survey;
    const PreparedFlight prepared(context, options.errors, tally);
    calib::CalibrateOptions how = options;
    how.adjust.apriori = calib::start_sigmas(survey.sigma);
    const calib::Calibrated calibrated = calib::calibrate(prepared.flight, how, tally, context.progress);
    calib::CalibrationReport report = report_on(context, prepared.lines);
    report.adjustment = calibrated.adjustment;
    report.ties = calibrated.ties;
    report.notes = calibrated.notes;
    if (const fs::path target = context.made("flat_target.json"); !target.empty()) {
      report.flat_target = io::parse_json(io::read_text_file(target), target.string());
      report.readings = readings_of(report.flat_target);
    }
    const calib::DeliveredCalibration result = calib::delivered(calibrated.adjustment, survey.sigma);
    add_views(report, view_calibration(context, {&survey.calibration, context.trajectory.get()},
                                       {&result.calibration, context.trajectory.get()}, calibrated.ties, prepared.flight.targets,
                                       options.differences, cell_for(prepared.lines), static_cast<size_t>(options.sections)));
    calib::write_calibration_report(report, context.output);
    tell(calibrated, findings);
  }

 private:
  static void tell(const calib::Calibrated& c, core::Value& findings) {
    for (const calib::Estimate& e : c.adjustment.estimates) {
      if (!e.estimated) continue;
      core::Value one = core::Value::object();
      one["value"] = e.value;
      one["sigma"] = e.sigma;
      one["start"] = e.start;
      one["delivered"] = calib::is_delivered(c.adjustment, e.parameter);
      one["grade"] = calib::name_of(e.grade);
      findings["estimates"][std::string(words_of(e.parameter).key)] = std::move(one);
    }
    findings["planes"] = c.ties.planes.size();
    findings["tie_returns"] = c.ties.returns.size();
    findings["rounds"] = c.rounds;
    findings["sigma0"] = c.adjustment.sigma0;
    core::Value& words = findings["findings"] = core::Value::array();
    for (const calib::Finding& f : c.adjustment.findings) words.push(f.what + (f.cure.empty() ? "" : ": " + f.cure));
  }
};

}  // namespace

std::unique_ptr<Stage> make_adjust() { return std::make_unique<Adjust>(); }

}  // namespace swath::stages
