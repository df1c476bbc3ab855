// SPDX-License-Identifier: GPL-3.0-or-later
// The strip adjustment of a survey, in any case or only where its lines do not agree.
#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calib/adjust/correction_knots.h"
#include "calib/adjust/line_agreement.h"
#include "calib/adjust/prepared_flight.h"
#include "calib/adjust/strips.h"
#include "calib/report/calibration_report.h"
#include "calib/report/flight_views.h"
#include "core/config/result.h"
#include "core/error.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/calibration/calibration_flight.h"
#include "stages/once.h"

namespace swath::stages {

enum class AdjustWhen { always, needed };

}  // namespace swath::stages

template <>
struct swath::core::Choices<swath::stages::AdjustWhen> {
  static constexpr std::array<std::string_view, 2> names{"always", "needed"};
};

namespace swath::stages {
namespace {

struct StripStageOptions : calib::StripOptions, FlightStageOptions {
  StripStageOptions() {
    errors.horizontal.value = errors.vertical.value = 0.1;
    errors.roll_pitch = core::degrees(0.01);
    errors.heading = core::degrees(0.02);
  }
  AdjustWhen when = AdjustWhen::always;
  core::Metres tolerance{0.08};
};

template <class V>
void describe(StripStageOptions& o, V& v) {
  v.option("when", o.when, "Adjust always, or only where lines differ by more than their sigmas or `tolerance` (needed).");
  v.option("tolerance", o.tolerance, core::above(0), "RMS difference of two lines above which `needed` adjusts whatever the sigmas.");
  describe(static_cast<calib::StripOptions&>(o), v);
  describe(static_cast<FlightStageOptions&>(o), v);
}

struct OnPlanes {
  std::uint64_t pairs = 0;
  calib::BeforeAndAfter rms{};
};

template <class V>
void describe(const OnPlanes& r, V& v) {
  v.result("pairs", r.pairs, "Pairs of lines.");
  describe(r.rms, v);
}

struct StripFindings {
  std::optional<std::string> doubt{};
  std::optional<calib::LineAgreement> agreement{};
  std::optional<bool> adjusted{};
  std::optional<std::string> reason{};
  bool done = false;  ///< what follows is known
  std::uint64_t lines = 0, planes = 0, tie_returns = 0, control = 0;
  int rounds = 0;
  double sigma0 = 0.0;
  std::optional<OnPlanes> on_planes{};
  std::optional<calib::BeforeAndAfter> on_surfaces{};
  std::vector<std::string> findings{};
};

template <class V>
void describe(const StripFindings& r, V& v) {
  const core::Form done = core::plain().only_if(r.done), shown = done.in_summary();
  v.result("doubt", r.doubt, core::plain().in_summary(), "Why the result is not to be trusted: quality.geometry found another cause.");
  v.table("agreement", r.agreement, "How the lines agree before, beside their sigmas; only with `when = needed`.");
  v.result("adjusted", r.adjusted, core::plain().in_summary(), "False: the trajectory is left as it is; only with `when = needed`.");
  v.result("reason", r.reason, core::plain().in_summary(), "Why it is left as it is.");
  v.result("lines", r.lines, done, "Flight lines.");
  v.result("planes", r.planes, shown, "Planes that several lines have seen.");
  v.result("tie_returns", r.tie_returns, shown, "Returns on these planes.");
  v.result("control", r.control, done, "Surveyed points that took part.");
  v.result("rounds", r.rounds, done, "Rounds of seeking planes and adjusting.");
  v.result("sigma0", r.sigma0, core::plain(3).in_summary().always().only_if(r.done), "A posteriori sigma of unit weight.");
  v.table("plane_differences", r.on_planes, "Differences of lines on planes that both have seen.");
  v.table("surface_differences", r.on_surfaces, "Differences of lines on smooth ground.");
  v.result("findings", r.findings, "What the adjustment found, as sentences.");
}

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
void refuse_reversed_scan(const calib::PreparedFlight& prepared) {
  try {
    calib::refuse_reversed_scan(prepared.flight);
  } catch (const core::SystemError&) {
    throw;
  } catch (const core::Error& e) {
    throw core::Error(e.what(), e.where(), e.hint(), core::Exit::bad_usage);
  }
}

calib::LineAgreement agreement(const calib::PreparedFlight& prepared, const calib::TiePlaneOptions& planes) {
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
  const georef::ShotStream& shots;
  const StripStageOptions& options;
  const std::filesystem::path& folder;
  const core::OnProgress& progress;
  core::Tally& tally;
  Corrections out{};

  calib::PreparedFlight prepared(core::Tally& counted) const {
    return {context.survey, shots, context.threads, flown, options.errors, counted};
  }

  void adjust(const calib::PreparedFlight& prepared) {
    calib::AdjustedStrips strips = calib::adjust_strips(prepared.flight, options, tally, progress);
    trajectory::Trajectory corrected = std::move(*strips.trajectory);

    calib::CalibrationReport report = report_on(context, prepared.lines);
    report.adjustment = strips.adjustment;
    report.ties = strips.ties;
    report.notes = strips.notes;
    report.strips = strips.differences;
    const calib::BeforeAndAfter on_surfaces =
        calib::add_views(prepared.flight, {context.crs, context.unit, context.origin}, {context.survey.calibration, corrected},
                         options.differences, prepared.cell(), options.sections, report);
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
      refuse_reversed_scan(prepared(ignored));
    } catch (const core::SystemError&) {
      throw;
    } catch (const core::Error& e) {
      if (e.code() == core::Exit::bad_usage) throw;
    }
    leave("not adjusted: quality.geometry found a cause that an adjustment would hide in the trajectory", doubt);
    write_left({});
  }

  void adjust_where_needed() {
    const calib::PreparedFlight flight = prepared(tally);
    const calib::LineAgreement lines = agreement(flight, options.planes);
    const bool none = lines.pairs.empty(), one = flight.lines.size() < 2;
    const bool apart = lines.exceeded() ||
                       std::ranges::any_of(lines.pairs, [this](const calib::PairAgreement& p) { return p.rms > options.tolerance.value; });
    out.findings.agreement = lines;
    out.findings.adjusted = apart;
    if (apart || (none && !one)) refuse_reversed_scan(flight);
    if (apart) return adjust(flight);
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

std::vector<std::string> strip_products(const StripStageOptions&) { return with_report({"strips.json"}); }

Corrections correct_strips(const Context& context, const trajectory::Trajectory& flown, const georef::ShotStream& shots,
                           const GeometryDoubt* doubt, const StripStageOptions& o, const Output& to, const core::OnProgress& progress,
                           core::Tally& tally) {
  StripStage stage{context, flown, shots, o, to.folder, progress, tally};
  const std::string why = doubt ? doubt->why : std::string();
  if (o.when == AdjustWhen::always) {
    if (!why.empty()) {
      tally.count("adjusted although quality.geometry found a cause that lies elsewhere: not to be trusted", why);
      stage.out.findings.doubt = why;
    }
    stage.adjust(stage.prepared(tally));
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

double strips_memory(const Context& c, const StripStageOptions& o) {
  constexpr double bytes_per_unknown = 0.133e6;  // factor, inverse and observations (docs/performance.md, 20 and 50 lines)
  constexpr double components_of_a_spline = 3.0;
  const calib::CorrectionOptions& corrections = o.adjust.corrections;
  const int splines = (corrections.position == calib::CorrectionForm::spline) + (corrections.attitude == calib::CorrectionForm::spline);
  double time = 0.0;
  for (const Strip& s : c.strips)
    if (s.last_time > s.first_time) time += s.last_time - s.first_time;
  const double unknowns =
      std::min(components_of_a_spline * splines * time / corrections.spacing.value, static_cast<double>(corrections.most));
  // Fewer unknowns take little.
  return o.when == AdjustWhen::always && unknowns > calib::max_together ? bytes_per_unknown * unknowns : 0.0;
}

}  // namespace

Entry strips_stage() {
  return once<correct_strips>(
      "calib.strips",
      "Strip adjustment: corrects the trajectory of a survey along its lines so that they meet on planes that several "
      "of them have seen, the calibration held; strips.json and report.html.",
      {.inputs = files_in<&io::Survey::control>, .products = strip_products, .memory = strips_memory});
}

}  // namespace swath::stages
