// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/calibration/strips.h"

#include <algorithm>

#include "calib/report/calibration_report.h"
#include "core/error.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "stages/adapters/calibration/calibration_flight.h"
#include "stages/calibration_views.h"

namespace swath::stages {
namespace {

using Corrections = Corrected<trajectory::Trajectory, StripFindings>;

/// strips.json of lines that were not adjusted.
struct NotAdjusted {
  calib::LineAgreement agreement;
  std::string reason;
};

template <class V>
void describe(const NotAdjusted& r, V& v) {
  describe(r.agreement, v);
  v.result("adjusted", false, "The trajectory is left as it is.");
  v.result("reason", r.reason, "Why.");
}

/// A scan angle of the wrong sign is a fault of the survey's description, not of its lines.
void refuse_reversed_scan(const PreparedFlight& prepared) {
  try {
    calib::refuse_reversed_scan(prepared.flight);
  } catch (const core::SystemError&) {
    throw;
  } catch (const core::Error& e) {
    throw core::Error(e.what(), e.where(), e.hint(), core::Exit::bad_usage);
  }
}

calib::LineAgreement agreement(const PreparedFlight& prepared, const calib::TiePlaneOptions& planes) {
  const calib::CalibrationFlight& f = prepared.flight;
  if (prepared.lines.size() < 2) return {};
  core::Tally ignored;
  const calib::TieSet ties =
      calib::find_tie_planes(f.shots, f.scanner, f.start, *f.trajectory, f.frame, {}, calib::sized(planes, f.scale), ignored);
  return calib::line_agreement(ties, f.scanner, f.start, f.sensor, *f.trajectory,
                               [&](const std::vector<double>& times) { return f.errors->covariance(times); });
}

struct StripStage {
  const Context& context;
  const trajectory::Trajectory& flown;
  const StripStageOptions& options;
  const std::filesystem::path& folder;
  const core::OnProgress& progress;
  core::Tally& tally;
  Corrections out{};

  void adjust(const PreparedFlight& prepared) {
    calib::AdjustedStrips strips = calib::adjust_strips(prepared.flight, options, tally, progress);
    trajectory::Trajectory corrected = std::move(*strips.trajectory);

    calib::CalibrationReport report = report_on(context, prepared.lines);
    report.adjustment = strips.adjustment;
    report.ties = strips.ties;
    report.notes = strips.notes;
    report.strips = strips.differences;
    const core::Calibration& held = context.survey.calibration;
    CalibrationViews views =
        view_calibration(context, {&held, prepared.flight.trajectory}, {&held, &corrected}, strips.ties, prepared.flight.targets,
                         options.differences, cell_for(prepared.lines), static_cast<size_t>(options.sections));
    const BeforeAndAfter on_surfaces{calib::overall_rms(views.before), calib::overall_rms(views.after)};
    add_views(report, std::move(views));
    calib::write_calibration_report(report, folder);

    StripFindings& f = out.findings;
    f.done = true;
    f.lines = strips.ties.lines.size();
    f.planes = strips.ties.planes.size();
    f.tie_returns = strips.ties.returns.size();
    f.control = strips.adjustment.control.size();
    f.rounds = strips.rounds;
    f.sigma0 = strips.adjustment.sigma0;
    const calib::PairOnPlanes& all = strips.differences.all;
    f.on_planes = {strips.differences.pairs.size(), {all.rms_before, all.rms_after}};
    f.on_surfaces = on_surfaces;
    f.findings = calib::sentences(strips.adjustment.findings);
    out.record = std::move(corrected);
  }

  // Whatever stands against it, the survey goes on with its trajectory as it is, and the report has the reason.
  void leave(const std::string& counted, const std::string& reason) {
    out.findings.adjusted = false;
    out.findings.reason = reason;
    if (!counted.empty()) tally.count(counted, reason);
  }
  void write_left(const calib::LineAgreement& lines) const {
    io::write_text_file(folder / "strips.json", io::to_json(core::reported(NotAdjusted{lines, *out.findings.reason})));
  }

  /// What else keeps a flight that is not adjusted in any case from being compared does not matter.
  void leave_doubtful(const std::string& doubt) {
    try {
      core::Tally ignored;
      refuse_reversed_scan(PreparedFlight(context, flown, options.errors, ignored));
    } catch (const core::SystemError&) {
      throw;
    } catch (const core::Error& e) {
      if (e.code() == core::Exit::bad_usage) throw;
    }
    leave("not adjusted: quality.geometry found a cause that an adjustment would hide in the trajectory", doubt);
    write_left({});
  }

  void adjust_where_needed() {
    const PreparedFlight prepared(context, flown, options.errors, tally);
    const calib::LineAgreement lines = agreement(prepared, options.planes);
    const bool none = lines.pairs.empty(), one = prepared.lines.size() < 2;
    const bool apart = lines.exceeded() ||
                       std::ranges::any_of(lines.pairs, [this](const calib::PairAgreement& p) { return p.rms > options.tolerance.value; });
    out.findings.agreement = lines;
    out.findings.adjusted = apart;
    if (apart || (none && !one)) refuse_reversed_scan(prepared);
    if (apart) return adjust(prepared);
    if (!none)
      leave("", "the lines agree within their sigmas and the tolerance");
    else if (one)
      leave("", "there is one flight line");
    else
      leave("flight lines without a common plane: not compared, the trajectory is left as it is",
            "no plane was found that two lines have seen: no overlap, or lines farther apart than planes.mismatch");
    write_left(lines);
  }
};

}  // namespace

std::vector<std::string> strip_products(const StripStageOptions&) {
  return {"strips.json", "report.html", "residuals.csv", "corrections.csv", "planes.csv", "sections.csv", "figures", "differences"};
}

Corrections correct_strips(const Context& context, const trajectory::Trajectory& flown, const georef::ShotStream&,
                           const GeometryDoubt* doubt, const StripStageOptions& o, const Output& to, const core::OnProgress& progress,
                           core::Tally& tally) {
  StripStage stage{context, flown, o, to.folder, progress, tally};
  const std::string why = doubt ? doubt->why : std::string();
  if (o.when == AdjustWhen::always) {
    if (!why.empty()) {
      tally.count("adjusted although quality.geometry found a cause that lies elsewhere: not to be trusted", why);
      stage.out.findings.doubt = why;
    }
    stage.adjust(PreparedFlight(context, flown, o.errors, tally));
    return std::move(stage.out);
  }
  try {
    if (why.empty())
      stage.adjust_where_needed();
    else
      stage.leave_doubtful(why);
  } catch (const core::SystemError&) {
    throw;
  } catch (const core::Error& e) {
    if (e.code() == core::Exit::bad_usage || !why.empty()) throw;
    stage.leave("flight lines that could not be compared or adjusted: the trajectory is left as it is", e.what());
  }
  return std::move(stage.out);
}

}  // namespace swath::stages
