// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/adjust_findings.h"

#include <algorithm>
#include <cmath>

#include "calib/adjust/parameter_words.h"
#include "calib/words.h"
#include "core/config/units.h"

namespace swath::calib {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double factor_to_tell = 2.0;    // of a stated sigma
constexpr double hardly_apart = 0.9;      // correlation
constexpr double planes_apart = 10.0;     // of the ranges' sigma: lines that disagree so much were not put together rightly
constexpr double outside_to_tell = 0.01;  // share of returns
constexpr double wide_knots = 1.5;        // of the spacing that was asked for

std::string metres(double v) { return words(std::abs(v) < 10.0 ? "%.3f m" : "%.2f m", v); }
std::string number(double v) { return words("%.2g", v); }

}  // namespace

void find_contradicted_starts(const TieProblem& problem, const AdjustRounds& r, Eigen::VectorXd& apriori, std::vector<Finding>& findings) {
  for (size_t i = 0; i < problem.globals.size(); ++i) {
    const double far = r.contradiction[static_cast<Eigen::Index>(i)];
    if (far == 0.0) continue;
    const Parameter p = problem.globals[i];
    findings.push_back({"the start value of " + std::string(words_of(p).name) + " is off by " + number(far) +
                            " times its stated sigma: it counts for nothing",
                        "state [sigma] of the survey as the value is known",
                        {p},
                        false});
    apriori[static_cast<Eigen::Index>(i)] = infinite;
  }
}

void find_correlated(const std::vector<Parameter>& globals, const std::vector<Parameter>& refused, const FlightShape& shape,
                     Adjustment& out) {
  const auto is_refused = [&](Parameter p) { return std::find(refused.begin(), refused.end(), p) != refused.end(); };
  for (size_t i = 0; i < globals.size(); ++i)
    for (size_t j = 0; j < i; ++j) {
      const Parameter a = globals[j], b = globals[i];
      if (is_refused(a) || is_refused(b) ||
          !(std::abs(out.correlation(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j))) > hardly_apart))
        continue;
      out.findings.push_back({std::string(words_of(a).name) + " and " + std::string(words_of(b).name) +
                                  " are strongly correlated: an error of one is compensated by the other",
                              !shape.crossed       ? "fly cross lines"
                              : !shape.two_heights ? "fly some lines at another height, lower or higher by half"
                                                   : "survey a target on the ground",
                              {a, b},
                              false});
    }
}

void find_wide_knots(const CorrectionOptions& o, double spacing, int unknowns, Adjustment& out) {
  if (unknowns == 0 || spacing <= wide_knots * o.spacing.value) return;
  out.findings.push_back({"the corrections' knots are " + words("%.1f", spacing) + " s apart in place of " +
                              words("%.1f", o.spacing.value) + " s: all lines together have " + std::to_string(unknowns) +
                              " unknowns, corrections.most allows " + std::to_string(o.most) +
                              "; errors that change faster stay in the points, and sigmas do not show them",
                          "adjust fewer lines in one run, or raise corrections.most (it costs time and memory)",
                          {},
                          false});
}

void find_contradictions(const TieProblem& p, const AdjustRounds& r, Adjustment& out) {
  const auto tell = [&](std::string what, std::string cure, bool refuses = false) {
    out.findings.push_back({std::move(what), std::move(cure), refuses ? p.globals : std::vector<Parameter>{}, refuses});
  };
  if (r.shift.shifted) {
    const char* names[] = {"east", "north", "up"};
    std::string where;
    for (int k = 0; k < 3; ++k)
      where += std::string(k ? ", " : "") + names[k] + " " + (r.shift.known[k] ? metres(r.shift.mean[k]) : std::string("not determined"));
    tell("control does not fit: mean misfit " + where + ": another datum? It was left out",
         "state the control's CRS and kind of heights (ellipsoidal or with a geoid) as they are");
  }
  if (r.surface() > planes_apart * r.noise().range)
    tell("the planes of different lines do not agree: " + metres(r.surface()) + " apart after the adjustment",
         "check the sign of the scan angle, the line numbers, the time scale and the trajectory", true);
  const SigmaFactors& f = r.factors;
  const auto worse = [&](const SigmaFactor& s, const char* what, const char* cure) {
    if (s.estimated && s.factor > factor_to_tell)
      tell(std::string(what) + " have errors " + number(s.factor) + " times as large as stated; the sigmas allow for that", cure);
  };
  worse(f.range, "ranges", "state the sigma of the ranges as it is");
  worse(f.angle, "scan angles", "state the sigma of the scan angles and the beam's divergence as they are");
  worse(f.position[line_mean], "the trajectory's positions", "look at its GNSS and its report; state stated_position instead");
  worse(f.attitude[line_mean], "the trajectory's attitudes", "look at its IMU's model and its report");
  worse(f.control, "control points", "look at their residuals");
  if (out.waves_between)
    tell("what is left on the planes waves along the lines: the trajectory's errors vary faster than corrections " +
             number(out.knot_spacing) + " s apart can follow; sigmas of the corrections may be too small",
         "narrow corrections.spacing, raise corrections.most");
  if (r.snooping_full)
    tell("more planes or control points are displaced than may be left out", "look at the groups with the largest w; raise snooping.share");
  std::uint64_t outside = 0;
  for (const GroupBlock& b : r.pass.blocks) outside += b.outside;
  if (static_cast<double>(outside) > outside_to_tell * static_cast<double>(p.ties->returns.size()))
    tell(std::to_string(outside) + " of " + std::to_string(p.ties->returns.size()) + " returns lie at times without trajectory",
         "check time scales and gaps");
  if (out.last_step > settled_step)
    tell("the adjustment did not converge: its last step still moves a value by " + number(out.last_step) + " of its sigmas",
         "start from better values, or allow more iterations", true);
  else if (!r.converged)
    tell("the adjustment is not steady after " + core::counted(r.rounds, "round") + " of linearisation", "allow more iterations");
}

}  // namespace swath::calib
