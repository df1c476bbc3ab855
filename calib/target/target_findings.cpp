// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/target/target_findings.h"

#include <algorithm>
#include <cmath>

#include "calib/target/attitude_displacement.h"
#include "calib/words.h"
#include "core/config/units.h"
#include "core/geo/frames.h"

namespace swath::calib {
namespace {

constexpr double significant = 3.0;  // sigmas

struct Findings {
  TargetFindings all{};
  void operator()(std::string finding, const std::string& cure) { all.findings.push_back(std::move(finding) + ": " + cure); }
  void note(std::string fact) { all.notes.push_back(std::move(fact)); }
};

void find_missing(const FlatTarget& t, const AngleReadings& a, const TargetMeasures& m, Findings& say) {
  if (!t.target.surveyed)
    say("the target is not surveyed: it is the mean of the lines; the range offset and the scan's scale by its width are not determined",
        "survey the roof's corners and state them as [[control]]");
  for (const TargetLine& l : t.lines) {
    const std::string line = "line " + std::to_string(l.line);
    if (!l.after.seen) {
      say(line + " takes no part, " + (l.after.why_not.empty() ? "the target is not under it" : l.after.why_not),
          "right for a line flown elsewhere; else check the target's place and the line's trajectory");
      continue;
    }
    size_t used = 0;
    for (const SideView& s : l.after.sides) used += s.used;
    if (used < t.target.sides())
      say(line + words(" sees %zu of the target's %zu edges", used, t.target.sides()),
          "fly so that the swath holds the whole target, with returns on the ground around it");
  }
  if (!a.pitch.determined)
    say("pitch is not determined, no two lines in opposite directions pass over the target at one height",
        "fly the target's line once more in the opposite direction");
  if (!a.roll.determined)
    say("roll is not determined, no two lines in opposite directions see both edges along their flight",
        "fly along the target's long wall to and fro");
  if (!a.heading.determined && a.pitch.determined)
    say("heading is not determined, no two parallel lines see the target at places of the swath far enough apart",
        "fly past it with the target at the swath's edge");
  else if (!a.heading.determined)
    say("heading is not determined, it needs pitch, or two lines of one direction with the target at different places of the swath",
        "fly over the target in opposite directions, and past it with the target at the swath's edge");
  bool edge = false;
  for (const LineMeasure& l : m.lines) edge = edge || l.role == TargetRole::edge;
  if (a.heading.determined && !edge)
    say("heading is weak, no line has the target at the swath's edge", "fly past it with the target at the swath's edge");
}

/// What the small-angle formulas alone would be wrong by.
void find_large_angles(const FlatTarget& t, const TargetMeasures& m, const core::Calibration& present, Findings& say) {
  const core::Attitude moved{present.roll.value - t.measured.roll.value, present.pitch.value - t.measured.pitch.value,
                             present.heading.value - t.measured.heading.value};
  double z = 0.0, y = 0.0;
  for (const LineMeasure& l : m.lines) {
    z = std::max(z, l.target.z());
    y = std::max(y, std::abs(l.target.y()));
  }
  // What the formulas alone would be wrong by matters where it is more than the readings' own sigma.
  double most = 1e-4;
  for (const TargetAngle* one : {&t.roll, &t.pitch, &t.heading})
    if (one->determined) most = std::min(most, one->sigma);
  if (const std::string w = small_angle_warning(moved, z, std::max(y, 1.0), most); !w.empty())
    say.note(w + "; they were iterated with the exact rotation");
}

void find_datum(const JointTarget& j, const TargetMeasures& m, Findings& say) {
  if (j.datum_sigma.head<2>().maxCoeff() < 1.0 && m.surveyed) {
    const double size = j.datum.head<2>().norm(), its = j.datum_sigma.head<2>().maxCoeff();
    constexpr double worth_telling = 0.05;  // m
    if (size > significant * its && size > worth_telling)
      say(words("the target lies %.2f m east and %.2f m north (+-%.2f m) of its survey in all lines alike: datum or base station, not the "
                "mounting; it cancels in opposite lines",
                j.datum.x(), j.datum.y(), its),
          "check the control's CRS and the coordinates of the base station");
  }
}

void find_lever_arms(const FlatTarget& t, Findings& say) {
  const JointTarget& j = t.joint;
  if (j.two_heights) {
    const auto arm = [&](const char* what, const char* angle, const JointTarget::One& one) {
      const double found = -one.value;
      if (std::abs(found) > significant * one.sigma)
        say(words(
                "two heights (%.0f and %.0f m): a part of the %s displacement stays the same at both: lever arm %+.3f m +-%.3f m from the "
                "one in force, not %s; %s is taken from what grows with height",
                j.lowest, j.highest, what, found, one.sigma, angle, angle),
            "measure the lever arm of the scanner again");
      else
        say.note(words(
            "two heights (%.0f and %.0f m): the %s displacement grows with height as %s does; a constant part of %+.3f m +-%.3f m shows "
            "no error of the lever arm",
            j.lowest, j.highest, what, angle, found, one.sigma));
    };
    if (t.pitch.determined) arm("along-track", "pitch", j.lever_forward);
    if (t.roll.determined) arm("across-track", "roll", j.lever_right);
  } else {
    say("all lines are of one flying height, an error of the lever arm along or across the flight (or of the latency) would be taken for "
        "pitch or roll",
        "fly two opposite lines at another height");
  }
}

void find_width(const JointTarget& j, Findings& say) {
  if (j.scan_scale.free && std::abs(j.scan_scale.value) > significant * j.scan_scale.sigma)
    say(words("the target looks too %s across the flight: scan scale off by %.0f +-%.0f ppm", j.scan_scale.value > 0 ? "wide" : "narrow",
              1e6 * std::abs(j.scan_scale.value), 1e6 * j.scan_scale.sigma),
        "check the survey of its corners; where it is right, set calibration.scan_scale to the value in the target's report");
}

void find_length(const FlatTarget& t, Findings& say) {
  if (!t.target.surveyed) return;
  double sum = 0.0, weights = 0.0;
  for (const TargetLine& l : t.lines) {
    if (!l.measured || !l.after.all_sides()) continue;
    const double w = 1.0 / (l.after.strain_along_sigma * l.after.strain_along_sigma);
    sum += w * l.after.strain_along;
    weights += w;
  }
  if (weights > 0.0 && std::abs(sum) > significant * std::sqrt(weights))
    say(words("the target looks too %s along the flight by %.0f +-%.0f ppm: speed of the trajectory or scale of the time tags",
              sum > 0 ? "long" : "short", 1e6 * std::abs(sum / weights), 1e6 / std::sqrt(weights)),
        "check the time scale of the laser's records and the survey of the target's length");
}

}  // namespace

TargetFindings target_findings(const FlatTarget& t, const AngleReadings& readings, const TargetMeasures& measures,
                               const core::Calibration& present, bool steady) {
  Findings say;
  find_missing(t, readings, measures, say);
  if (!steady)
    say("the rounds ended before the angles were steady (" + core::counted(t.rounds, "round") + ")", "raise calib.flat_target.rounds");
  find_large_angles(t, measures, present, say);
  find_datum(t.joint, measures, say);
  find_lever_arms(t, say);
  find_width(t.joint, say);
  find_length(t, say);
  constexpr double poor = 3.0;
  if (t.joint.chi2 > poor)
    say(words("displacements of the lines disagree by more than their sigmas (chi2 per degree of freedom %.1f): trajectory worse than "
              "stated, a wrong survey, or a part of the mounting that is not modelled here",
              t.joint.chi2),
        "compare the lines in the target's report, and look at the trajectory of the one that differs");
  return std::move(say.all);
}

}  // namespace swath::calib
