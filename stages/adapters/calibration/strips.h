// SPDX-License-Identifier: GPL-3.0-or-later
// The strip adjustment of a survey, in any case or only where its lines do not agree.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calib/adjust/line_agreement.h"
#include "calib/adjust/strips.h"
#include "core/config/result.h"
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

/// How the lines differ, before and after, m.
struct BeforeAndAfter {
  double before = 0.0, after = 0.0;
};

template <class V>
void describe(const BeforeAndAfter& r, V& v) {
  v.result("rms_before", r.before, core::metres().in_summary().always(), "RMS with the trajectory as it was given.");
  v.result("rms_after", r.after, core::metres().in_summary().always(), "RMS with the corrected trajectory.");
}

struct OnPlanes {
  std::uint64_t pairs = 0;
  BeforeAndAfter rms{};
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
  std::optional<BeforeAndAfter> on_surfaces{};
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
  v.result("findings", r.findings, shown, "What the adjustment found, as sentences.");
}

Corrected<trajectory::Trajectory, StripFindings> correct_strips(const Context& context, const trajectory::Trajectory& trajectory,
                                                                const georef::ShotStream& shots, const GeometryDoubt* doubt,
                                                                const StripStageOptions& o, const Output& to,
                                                                const core::OnProgress& progress, core::Tally& tally);
std::vector<std::string> strip_products(const StripStageOptions&);

}  // namespace swath::stages
