// SPDX-License-Identifier: GPL-3.0-or-later
// Source: Glira, Pfeifer & Mandlburger, "Rigorous strip adjustment of UAV-based laserscanning data including time-dependent correction of
// trajectory errors" (2016). Deviations: planes of many returns instead of pairs of points; knots of linear pieces, held together by the
// covariance of the trajectory's errors instead of fictitious observations (calib/adjust/correction_knots.h).
#include "calib/adjust/strips.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "calib/words.h"
#include "core/error.h"
#include "core/statistics.h"
#include "trajectory/corrected.h"

namespace swath::calib {
namespace {

// Planes are found the same way with returns that have moved by less than their own noise.
constexpr double steady = 0.02, closest = 0.05;  // m
// For the progress: how many rounds there usually are, and what of one the planes take.
constexpr double usual_strip_rounds = 4.0, strip_planes_part = 0.5;

std::vector<trajectory::CorrectionSeries> series_of(const std::vector<LineCorrection>& corrections) {
  std::vector<trajectory::CorrectionSeries> out;
  for (const LineCorrection& c : corrections) {
    trajectory::CorrectionSeries s;
    for (size_t k = 0; k < c.time.size(); ++k)
      s.knots.push_back({c.time[k], c.value[k], c.sigma[k],
                         k < c.response.size() ? std::optional(core::CalibrationResponse::Matrix(c.response[k])) : std::nullopt});
    if (!s.knots.empty()) out.push_back(std::move(s));
  }
  return out;
}

/// The longest step between records that the trajectory is interpolated over.
double longest_step(const trajectory::Trajectory& t) {
  const std::vector<double>& time = t.data().time;
  double out = 0;
  for (size_t k = 1; k < time.size(); ++k)
    if (time[k] - time[k - 1] > out && t.covers(0.5 * (time[k] + time[k - 1]))) out = time[k] - time[k - 1];
  return out;
}

/// What one set of corrections moves the returns by against another one, rms over the groups, m.
double moved(const std::vector<LineCorrection>& from, const std::vector<LineCorrection>& to, const Adjustment& at) {
  const trajectory::CorrectionCurve was(series_of(from)), is(series_of(to));
  double squares = 0;
  for (const GroupResidual& g : at.groups) {
    const auto a = was.at(g.time).value, b = is.at(g.time).value;
    for (size_t i = 0; i < 6; ++i) squares += std::pow((b[i] - a[i]) * (i < 3 ? 1.0 : i < 5 ? g.range : g.range * std::sin(g.angle)), 2);
  }
  return at.groups.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(at.groups.size()));
}

std::string in_metres(double v) { return words("%.3f m", v); }
std::string seconds(double v) { return words("%.2g s", v); }

double scatter_after(const Adjustment& a) {
  std::vector<double> sizes;
  for (const GroupResidual& g : a.groups)
    if (!g.rejected) sizes.push_back(std::abs(g.after));
  return core::mad_to_sigma * core::median(std::move(sizes), 0.0);
}

bool two_lines_share_a_plane(const TieSet& ties) {
  for (size_t g = 1; g < ties.groups.size(); ++g)
    if (ties.groups[g].plane == ties.groups[g - 1].plane && ties.groups[g].line != ties.groups[g - 1].line) return true;
  return false;
}

void refuse_without_overlap(const TieSet& ties, const core::Tally& tally) {
  if (ties.lines.size() == 1)
    throw core::Error("there is but one flight line: strips are adjusted to one another", "strip adjustment",
                      "leave calib.strips out, or add lines that overlap");
  if (!two_lines_share_a_plane(ties))
    refuse_without_planes(tally, "", "strip adjustment", ", and lie no farther apart than planes.mismatch");
}

void refuse_what_the_adjustment_refuses(const Adjustment& a) {
  for (const Finding& f : a.findings)
    if (f.refuses) throw core::Error(f.what, "strip adjustment", f.cure);
}

}  // namespace

PlaneDifferences plane_differences(const TieSet& ties, const Adjustment& a) {
  struct Sums {
    double n = 0, before = 0, before2 = 0, after = 0, after2 = 0;
    void add(double b, double f) { n += 1, before += b, before2 += b * b, after += f, after2 += f * f; }
    PairOnPlanes of(int line_a, int line_b) const {
      if (n == 0) return {line_a, line_b, 0, 0.0, 0.0, 0.0, 0.0};
      return {line_a, line_b, static_cast<std::uint64_t>(n), before / n, std::sqrt(before2 / n), after / n, std::sqrt(after2 / n)};
    }
  };
  std::map<std::pair<int, int>, Sums> pairs;
  Sums all;
  for (size_t first = 0, end = 0; first < a.groups.size(); first = end) {
    for (end = first; end < a.groups.size() && a.groups[end].plane == a.groups[first].plane;) ++end;
    for (size_t i = first; i < end; ++i)
      for (size_t j = i + 1; j < end; ++j) {
        const GroupResidual &p = a.groups[i], &q = a.groups[j];
        if (p.line == q.line || p.rejected || q.rejected || p.returns == 0 || q.returns == 0) continue;
        pairs[{ties.lines[p.line].id, ties.lines[q.line].id}].add(p.before - q.before, p.after - q.after);
        all.add(p.before - q.before, p.after - q.after);
      }
  }
  PlaneDifferences out;
  for (const auto& [ids, sums] : pairs) out.pairs.push_back(sums.of(ids.first, ids.second));
  out.all = all.of(0, 0);
  return out;
}

trajectory::Trajectory with_corrections(const trajectory::Trajectory& t, const std::vector<LineCorrection>& corrections) {
  trajectory::TrajectoryOptions options;
  options.max_gap.value = longest_step(t);
  return trajectory::Trajectory(trajectory::corrected(t.data(), series_of(corrections)), options, "corrected trajectory");
}

AdjustedStrips adjust_strips(const CalibrationFlight& survey, const StripOptions& options, core::Tally& tally,
                             const core::OnProgress& progress) {
  std::vector<SurveyedTarget> targets;
  std::copy_if(survey.targets.begin(), survey.targets.end(), std::back_inserter(targets),
               [](const SurveyedTarget& t) { return t.use == io::ControlUse::control; });
  AdjustedStrips out;
  progress(0.0, "sign of the scan angle");
  refuse_reversed_scan(survey);
  TiePlaneOptions planes = sized(options.planes, survey.scale);
  AdjustOptions how = options.adjust;
  core::Tally of_round;
  double change = 0;
  for (out.rounds = 1; out.rounds <= options.rounds; ++out.rounds) {
    of_round = {};
    const trajectory::Trajectory& now = out.trajectory ? *out.trajectory : *survey.trajectory;
    const std::string round = "round " + std::to_string(out.rounds);
    progress(core::usual_share(out.rounds - 1, usual_strip_rounds), round + ": planes");
    out.ties = find_tie_planes(survey.shots, survey.scanner, survey.start, now, survey.frame, targets, planes, of_round);
    refuse_without_overlap(out.ties, of_round);
    progress(core::usual_share(out.rounds - 1 + strip_planes_part, usual_strip_rounds), round + ": adjustment");
    const std::vector<LineCorrection> before = std::move(out.adjustment.corrections);
    for (;;) {
      out.adjustment =
          adjust(out.ties, survey.scanner, survey.start, survey.sensor, *survey.trajectory, *survey.errors, how, survey.threads);
      // Wider knots than asked for: there are as many as may be.
      const double spacing = out.adjustment.knot_spacing, narrower = std::max(0.5 * spacing, options.least_spacing.value);
      if (!out.adjustment.waves_between || narrower >= spacing || spacing > how.corrections.spacing.value) break;
      how.corrections.spacing.value = narrower;
    }
    refuse_what_the_adjustment_refuses(out.adjustment);
    out.trajectory.emplace(with_corrections(*survey.trajectory, out.adjustment.corrections));
    change = moved(before, out.adjustment.corrections, out.adjustment);
    planes.mismatch.value = std::clamp(3 * scatter_after(out.adjustment), std::min(closest, planes.mismatch.value), planes.mismatch.value);
    if (change < steady) break;
  }
  out.rounds = std::min(out.rounds, options.rounds);
  if (change >= steady)
    out.adjustment.findings.push_back({"the corrections did not settle in " + std::to_string(out.rounds) +
                                           " rounds: the last one still moved the returns by " + in_metres(change),
                                       "allow more rounds, or fly lines that share more planes",
                                       {},
                                       false});
  out.differences = plane_differences(out.ties, out.adjustment);
  out.notes.push_back("Planes were sought " + core::counted(out.rounds, "time") + "; the last round moved the returns by " +
                      in_metres(change) + ".");
  if (how.corrections.spacing.value < options.adjust.corrections.spacing.value)
    out.notes.push_back("The trajectory's errors vary faster than its corrections could follow: their knots were brought closer, to " +
                        seconds(out.adjustment.knot_spacing) + ".");
  for (std::string& note : targets_not_found(of_round)) out.notes.push_back(std::move(note));
  tally.add(of_round);
  return out;
}

}  // namespace swath::calib
