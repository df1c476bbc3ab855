// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/strips.h"
#include <algorithm>

#include "calib/adjust/line_agreement.h"
#include "calib/report/calibration_report.h"
#include "core/config/units.h"
#include "core/error.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/calibration/calibration_flight.h"
#include "stages/calibration_views.h"

namespace swath::stages {

enum class AdjustWhen { always, needed };

}  // namespace swath::stages

namespace swath::core {
template <>
struct Choices<stages::AdjustWhen> {
  static constexpr std::array<std::string_view, 2> names{"always", "needed"};
};
}  // namespace swath::core

namespace swath::stages {
namespace {

namespace fs = std::filesystem;

struct StripStageOptions : calib::StripOptions {
  StripStageOptions() {
    errors.horizontal.value = errors.vertical.value = 0.1;
    errors.roll_pitch = core::degrees(0.01);
    errors.heading = core::degrees(0.02);
  }
  AdjustWhen when = AdjustWhen::always;
  core::Metres tolerance{0.08};
  trajectory::ErrorModelOptions errors;
  calib::LineHeightOptions differences;
  int sections = 4;
};

template <class V>
void describe(StripStageOptions& o, V& v) {
  v.option("when", o.when, "Adjust always, or only where lines differ by more than their sigmas or `tolerance` (needed).");
  v.option("tolerance", o.tolerance, core::above(0), "RMS difference of two lines above which `needed` adjusts whatever the sigmas.");
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
                           {Product::of<trajectory::Trajectory>(), Product::shots},
                           {Product::of<trajectory::Trajectory>()}};
    return info;
  }
  std::vector<std::string> products() const override {
    return {"strips.json", "report.html", "residuals.csv", "corrections.csv", "planes.csv", "sections.csv", "figures", "differences"};
  }
  std::vector<fs::path> inputs(const io::Survey& survey) const override { return control_files(survey); }

  void run_survey(Context& context, core::Tally& tally, core::Value& findings) const override {
    const std::string doubt = context.records.has<GeometryDoubt>() ? context.records.get<GeometryDoubt>().why : std::string();
    if (options.when == AdjustWhen::always) {
      if (!doubt.empty()) {
        tally.count("adjusted although quality.geometry found a cause that lies elsewhere: not to be trusted", doubt);
        findings["doubt"] = doubt;
      }
      return adjust(context, PreparedFlight(context, options.errors, tally), tally, findings);
    }
    // Whatever stands against it, the survey goes on with its trajectory as it is, and says why.
    const auto left = [&](const std::string& why, const std::string& what) {
      findings["adjusted"] = false;
      findings["reason"] = what;
      if (!why.empty()) tally.count(why, what);
    };
    const auto write = [&](core::Value found) {
      found["adjusted"] = false;
      found["reason"] = *findings.find("reason");
      io::write_text_file(context.output / "strips.json", io::to_json(found));
    };
    if (!doubt.empty()) {
      refuse_if_reversed(context);
      left("not adjusted: quality.geometry found a cause that an adjustment would hide in the trajectory", doubt);
      return write(core::Value::object());
    }
    try {
      const PreparedFlight prepared(context, options.errors, tally);
      const calib::LineAgreement lines = agreement(prepared);
      const core::Value found = lines.pairs.empty() ? core::Value::object() : tree_of(lines);
      findings["agreement"] = found;
      const bool apart = std::any_of(lines.pairs.begin(), lines.pairs.end(),
                                     [this](const calib::PairAgreement& p) { return p.rms > options.tolerance.value; });
      findings["adjusted"] = lines.exceeded() || apart;
      if (lines.exceeded() || apart || (lines.pairs.empty() && prepared.lines.size() > 1)) reversed_scan(prepared);
      if (lines.exceeded() || apart) return adjust(context, prepared, tally, findings);
      if (!lines.pairs.empty())
        left("", "the lines agree within their sigmas and the tolerance");
      else if (prepared.lines.size() < 2)
        left("", "there is one flight line");
      else
        left("flight lines without a common plane: not compared, the trajectory is left as it is",
             "no plane was found that two lines have seen: no overlap, or lines farther apart than planes.mismatch");
      write(found);
    } catch (const core::SystemError&) {
      throw;
    } catch (const core::Error& e) {
      if (e.code() == core::Exit::bad_usage) throw;
      left("flight lines that could not be compared or adjusted: the trajectory is left as it is", e.what());
    }
  }

 private:
  /// A scan angle of the wrong sign is a fault of the survey's description, not of its lines.
  static void reversed_scan(const PreparedFlight& prepared) {
    try {
      calib::refuse_reversed_scan(prepared.flight);
    } catch (const core::SystemError&) {
      throw;
    } catch (const core::Error& e) {
      throw core::Error(e.what(), e.where(), e.hint(), core::Exit::bad_usage);
    }
  }

  /// Of a flight that is not adjusted in any case: whatever else keeps it from being compared does not matter.
  void refuse_if_reversed(const Context& context) const {
    core::Tally ignored;
    try {
      reversed_scan(PreparedFlight(context, options.errors, ignored));
    } catch (const core::SystemError&) {
      throw;
    } catch (const core::Error& e) {
      if (e.code() == core::Exit::bad_usage) throw;
    }
  }

  calib::LineAgreement agreement(const PreparedFlight& prepared) const {
    const calib::CalibrationFlight& f = prepared.flight;
    if (prepared.lines.size() < 2) return {};
    core::Tally ignored;
    const calib::TieSet ties =
        calib::find_tie_planes(f.shots, f.scanner, f.start, *f.trajectory, f.frame, {}, calib::sized(options.planes, f.scale), ignored);
    return calib::line_agreement(ties, f.scanner, f.start, f.sensor, *f.trajectory,
                                 [&](const std::vector<double>& times) { return f.errors->covariance(times); });
  }

  static core::Value tree_of(const calib::LineAgreement& lines) {
    core::Value v = core::Value::object();
    v["planes"] = lines.planes;
    v["rms"] = lines.rms;
    v["predicted"] = lines.predicted;
    core::Value& pairs = v["pairs"] = core::Value::array();
    for (const calib::PairAgreement& p : lines.pairs) {
      core::Value one = core::Value::object();
      one["lines"].push(p.line_a);
      one["lines"].push(p.line_b);
      one["planes"] = p.planes;
      one["mean"] = p.mean;
      one["rms"] = p.rms;
      one["predicted"] = p.predicted;
      one["surplus"] = p.surplus;
      pairs.push(std::move(one));
    }
    return v;
  }

  void adjust(Context& context, const PreparedFlight& prepared, core::Tally& tally, core::Value& findings) const {
    calib::AdjustedStrips strips = calib::adjust_strips(prepared.flight, options, tally, context.progress);
    const auto corrected = std::make_shared<const trajectory::Trajectory>(std::move(*strips.trajectory));

    calib::CalibrationReport report = report_on(context, prepared.lines);
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
    calib::write_calibration_report(report, context.output);
    context.records.share<trajectory::Trajectory>(corrected);

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
