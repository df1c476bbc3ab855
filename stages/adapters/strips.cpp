// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/strips.h"
#include "core/units.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/calibration_flight.h"
#include "stages/calibration_report.h"
#include "stages/calibration_views.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;

struct StripStageOptions : calib::StripOptions {
  StripStageOptions() {
    errors.horizontal.value = errors.vertical.value = 0.1;
    errors.roll_pitch = core::degrees(0.01);
    errors.heading = core::degrees(0.02);
  }
  trajectory::ErrorModelOptions errors;
  calib::LineHeightOptions differences;
  int sections = 4;
};

template <class V>
void describe(StripStageOptions& o, V& v) {
  describe(static_cast<calib::StripOptions&>(o), v);
  v.table("errors", o.errors, "Errors of trajectories that state no covariances between instants.");
  v.table("differences", o.differences, "Maps of the differences of overlapping lines.");
  v.option("sections", o.sections, core::within(0, 50), "Cross sections drawn in the report.");
}

class Strips : public OptionStage<StripStageOptions> {
 public:
  const Info& info() const override {
    static const Info info{"calib.strips",
                           "Strip adjustment: corrects the trajectory of a survey along its lines so that they meet on planes that several "
                           "of them have seen, the calibration held; strips.json and report.html.",
                           {Grain::survey},
                           {},
                           {},
                           {Product::trajectory, Product::shots},
                           {Product::trajectory}};
    return info;
  }
  std::vector<std::string> products() const override {
    return {"strips.json", "report.html", "residuals.csv", "corrections.csv", "planes.csv", "sections.csv", "figures", "differences"};
  }
  std::vector<fs::path> inputs(const io::Survey& survey) const override { return control_files(survey); }

  void run_survey(Context& context, core::Tally& tally, core::Value& findings) const override {
    const PreparedFlight prepared(context, options.errors, tally);
    calib::AdjustedStrips strips = calib::adjust_strips(prepared.flight, options, tally);
    const auto corrected = std::make_shared<const trajectory::Trajectory>(std::move(*strips.trajectory));

    CalibrationReport report = report_on(context, prepared.lines);
    report.adjustment = strips.adjustment;
    report.ties = strips.ties;
    report.notes = strips.notes;
    report.strips = strips.differences;
    const core::Calibration& held = context.survey.calibration;
    CalibrationViews views =
        view_calibration(context, {&held, prepared.trajectory.get()}, {&held, corrected.get()}, strips.ties, prepared.flight.targets,
                         options.differences, cell_for(prepared.lines), static_cast<size_t>(options.sections));
    const double map_before = calib::overall_rms(views.before), map_after = calib::overall_rms(views.after);
    add_views(report, std::move(views));
    write_calibration_report(report, context.output);
    context.trajectory = corrected;

    const calib::PairOnPlanes& all = strips.differences.all;
    findings["lines"] = strips.ties.lines.size();
    findings["planes"] = strips.ties.planes.size();
    findings["tie_returns"] = strips.ties.returns.size();
    findings["control"] = strips.adjustment.control.size();
    findings["rounds"] = strips.rounds;
    findings["sigma0"] = strips.adjustment.sigma0;
    findings["plane_differences"]["pairs"] = strips.differences.pairs.size();
    findings["plane_differences"]["rms_before"] = all.rms_before;
    findings["plane_differences"]["rms_after"] = all.rms_after;
    findings["surface_differences"]["rms_before"] = map_before;
    findings["surface_differences"]["rms_after"] = map_after;
    core::Value& words = findings["findings"] = core::Value::array();
    for (const calib::Finding& f : strips.adjustment.findings) words.push(f.what + (f.cure.empty() ? "" : ": " + f.cure));
  }
};

}  // namespace

std::unique_ptr<Stage> make_strips() { return std::make_unique<Strips>(); }

}  // namespace swath::stages
