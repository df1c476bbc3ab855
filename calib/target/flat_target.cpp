// SPDX-License-Identifier: GPL-3.0-or-later
// Source: Brandalize, "Perfilamento a laser", the calibration flight. Deviation: the small-angle formulas are applied, the returns are
// computed anew and the target is measured again until nothing is left, so that their error (1e-4 rad at half a degree) has gone.
#include "calib/target/flat_target.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>

#include "calib/target/attitude_displacement.h"
#include "calib/target/target_finder.h"
#include "calib/target/target_findings.h"
#include "calib/target/target_pulses.h"
#include "calib/words.h"
#include "core/error.h"
#include "core/geo/frames.h"

namespace swath::calib {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double steady_angle = 2e-7;    // rad: 0.04 arcsec
constexpr double steady_range = 5e-4;    // m
constexpr double significant_arm = 3.0;  // sigmas

/// The surveyed target of that name, or the largest that is a level roof; `not_used`: what the others are, in words.
std::optional<RoofTarget> surveyed_target(const std::vector<io::ControlPoint>& control, const std::string& wanted,
                                          std::vector<std::string>& not_used) {
  std::map<std::string, std::vector<const io::ControlPoint*>> targets;
  for (const io::ControlPoint& p : control)
    if (!p.target.empty() && p.use == io::ControlUse::control) targets[p.target].push_back(&p);
  std::optional<RoofTarget> best;
  double largest = 0.0;
  std::string names;
  for (const auto& [name, points] : targets) {
    names += (names.empty() ? "" : ", ") + name;
    if (!wanted.empty() && name != wanted) continue;
    std::vector<Vector3d> corners;
    double sigma_h = 0.0, sigma_v = 0.0;
    for (const io::ControlPoint* p : points) {
      corners.push_back(p->ecef);
      sigma_h = std::max(sigma_h, p->sigma_h);
      sigma_v = std::max(sigma_v, p->sigma_v);
    }
    std::optional<RoofTarget> t;
    try {
      t = roof_target(name, corners, sigma_h, sigma_v);
    } catch (const core::Error& e) {
      if (!wanted.empty()) throw;
      not_used.push_back(std::string(e.what()) + "; it takes no part (" + e.hint() + ")");
      continue;
    }
    const double area = t->area();
    constexpr double level = 0.05;  // rise / run
    if (wanted.empty() && t->plane.tail<2>().norm() > level) continue;
    if (area <= largest) continue;
    largest = area;
    best = t;
  }
  if (!wanted.empty() && !best)
    throw core::usage_error("no surveyed target '" + wanted + "'", "calib.flat_target.target",
                            names.empty() ? "the survey's control names no targets" : "the targets are " + names);
  return best;
}

class Analysis {
 public:
  Analysis(const core::Scanner& scanner, const core::Calibration& calibration, const core::SensorSigma& sigma,
           const trajectory::Trajectory& trajectory, const TrajectoryCovariance& covariance, const FlatTargetOptions& options)
      : scanner_(scanner), present_(calibration), sigma_(sigma), trajectory_(trajectory), covariance_(covariance), options_(options) {
    out_.calibration = out_.measured = calibration;
    out_.range_present = calibration.range_offset.value;
  }

  FlatTarget run(const ShotStream& shots, const std::vector<io::ControlPoint>& control, core::Tally& tally) {
    const ShotGeometry start(scanner_, present_);
    const double search = std::tan(options_.search.value);
    auto target = surveyed_target(control, options_.target, out_.findings);
    if (!target)
      target = find_roof(shots, start, trajectory_, search, {options_.stands_out.value, options_.shortest_side.value, 0.05, 2.0});
    if (!target) {
      say("no target: no surveyed one is a level roof, and no flat level roof of " + words("%.0f m", options_.shortest_side.value) +
          " that stands out of its surroundings was found in any line: survey a level roof's corners as [[control]], or lower "
          "calib.flat_target.stands_out and shortest_side");
      return out_;
    }
    out_.target = *target;
    collected_ = collect_pulses(shots, start, trajectory_, out_.target, search);
    out_.returns = collected_.returns;
    if (collected_.outside) tally.count("returns outside the trajectory left out", collected_.outside);
    for (const LinePulses& l : collected_.lines) {
      TargetLine line;
      line.line = l.line;
      line.kept_one_in = l.kept_one_in;
      out_.lines.push_back(line);
    }
    work();
    collected_ = {};
    return out_;
  }

 private:
  void say(const std::string& what) { out_.findings.push_back(what); }

  EdgeOptions edge_options(bool coarse) const {
    EdgeOptions e;
    e.range_sigma = sigma_.range.value;
    e.pointing_sigma = sigma_.scan_angle.value;
    e.beam_divergence = sigma_.beam_divergence.value;
    e.several_returns = collected_.several_returns;
    e.single_growth = options_.single_growth;
    e.single_growth_sigma = options_.single_growth_sigma;
    e.shear = std::tan(options_.search.value);
    if (coarse && !out_.target.surveyed) {
      // The rectangle is known to a cell of the finder's grid.
      e.strain_along = e.strain_across = 0.05;
      e.turn = 0.03;
      e.shear = std::hypot(e.shear, e.turn);
    }
    return e;
  }

  /// `across`: sigma of the displacement across the flight, m, once roll has been found; 0 before.
  std::vector<TargetView> views(const core::Calibration& calibration, bool coarse, double across) const {
    const ShotGeometry geometry(scanner_, calibration);
    std::vector<TargetView> out;
    for (const LinePulses& l : collected_.lines) {
      EdgeOptions e = edge_options(coarse);
      double range = 0.0;
      for (const double r : l.pulses.first) range = std::max(range, geometry.range(r));
      constexpr double datum = 2.0;  // m
      e.search = std::tan(options_.search.value) * range * std::sqrt(2.0) + datum;
      e.across = across > 0.0 ? across : e.search;
      out.push_back(view_target(l.pulses, geometry, trajectory_, out_.target, e));
    }
    return out;
  }

  TargetMeasures measures(const std::vector<TargetView>& views, const core::Calibration& calibration) const {
    std::vector<std::pair<int, const TargetView*>> seen;
    for (size_t i = 0; i < views.size(); ++i)
      if (views[i].seen) seen.push_back({out_.lines[i].line, &views[i]});
    return target_measures(seen, ShotGeometry(scanner_, calibration), trajectory_, covariance_, out_.target, sigma_, collected_.widest,
                           {options_.nadir_share, options_.edge_share});
  }

  void work() {
    std::vector<TargetView> now;
    core::Calibration& cal = out_.measured;
    AngleReadings angles;
    TargetMeasures m;
    constexpr int coarse_rounds = 2;  // of an unsurveyed target: its rectangle is being found
    bool steady = false;
    for (out_.rounds = 1; out_.rounds <= options_.rounds; ++out_.rounds) {
      const bool coarse = out_.rounds <= coarse_rounds;
      // Profiles cannot determine it: with the roll of the other lines it is small.
      constexpr double left_after_roll = 0.3;  // m
      const double across = angles.roll.determined ? left_after_roll : 0.0;
      now = views(cal, coarse, across);
      if (!out_.target.surveyed) {
        rectangle_of(now);
        now = views(cal, coarse, across);
      }
      m = measures(now, cal);
      if (out_.rounds == 1) remember(now, m);
      if (m.lines.empty()) break;
      angles = read_angles(m);
      steady = (out_.target.surveyed || !coarse) && std::abs(angles.pitch.value) < steady_angle &&
               std::abs(angles.roll.value) < steady_angle && std::abs(angles.heading.value) < steady_angle &&
               std::abs(angles.range.value) < steady_range;
      if (steady || out_.rounds == options_.rounds) break;
      apply(angles, cal);
    }
    out_.rounds = std::min(out_.rounds, options_.rounds);
    if (m.lines.empty()) {
      std::string why;
      for (const TargetLine& l : out_.lines)
        if (!l.before.why_not.empty()) why += (why.empty() ? " (line " : ", line ") + std::to_string(l.line) + " " + l.before.why_not;
      say("no line sees the target" + (why.empty() ? "" : why + ")") +
          ": check its place against the flight lines, and widen calib.flat_target.search");
      return;
    }
    out_.done = true;
    out_.joint = solve_jointly(m, sigma_);
    for (size_t i = 0; i < now.size(); ++i) {
      out_.lines[i].after = now[i];
      for (const LineMeasure& l : m.lines)
        if (l.view == &now[i]) {
          out_.lines[i].measured = true;
          out_.lines[i].role = l.role;
          out_.lines[i].target = l.target;
          out_.lines[i].scan_angle = std::atan2(l.target.y(), l.target.z());
        }
    }
    conclude(angles, cal);
    TargetFindings said = target_findings(out_, angles, m, present_, steady);
    std::move(said.findings.begin(), said.findings.end(), std::back_inserter(out_.findings));
    out_.notes = std::move(said.notes);
  }

  /// An unsurveyed target: the mean of the lines that see it whole.
  void rectangle_of(const std::vector<TargetView>& now) {
    RoofTarget& t = out_.target;
    std::vector<Vector2d> corners(t.sides(), Vector2d(0, 0));
    Vector3d plane = Vector3d::Zero();
    int n = 0;
    for (const TargetView& v : now) {
      if (!v.seen || !v.all_sides()) continue;
      const Vector2d x(std::sin(v.heading), std::cos(v.heading)), y(x.y(), -x.x());
      for (size_t k = 0; k < t.sides(); ++k) {
        const double px = x.dot(t.corners[k] - v.centre), py = y.dot(t.corners[k] - v.centre);
        // Edges that lie along the flight show how the roof is turned; those across it are turned by the heading's error as well.
        corners[k] += t.corners[k] + (v.displacement.x() - v.turn * py + v.strain_along * px) * x +
                      (v.displacement.y() + v.turn * px + v.strain_across * py) * y;
      }
      const Vector2d tilt = v.tilt_along * x + v.tilt_across * y;
      plane += Vector3d(v.height - tilt.dot(v.centre + v.displacement.x() * x + v.displacement.y() * y), tilt.x(), tilt.y());
      ++n;
    }
    if (n == 0) return;
    for (size_t k = 0; k < t.sides(); ++k) t.corners[k] = corners[k] / n;
    t.plane += plane / n;
  }

  void remember(const std::vector<TargetView>& now, const TargetMeasures& m) {
    for (size_t i = 0; i < now.size(); ++i) {
      out_.lines[i].before = now[i];
      for (const LineMeasure& l : m.lines)
        if (l.view == &now[i]) out_.lines[i].sigma = l.sigma;
    }
  }

  static void apply(const AngleReadings& a, core::Calibration& c) {
    const core::Attitude displacement{a.roll.value, a.pitch.value, a.heading.value};
    const Eigen::Matrix3d corrected =
        core::matrix_of(mounting_of(displacement)) * core::matrix_of({c.roll.value, c.pitch.value, c.heading.value});
    const core::Attitude now = core::attitude_of(corrected);
    c.roll.value = now.roll;
    c.pitch.value = now.pitch;
    c.heading.value = core::wrap_pi(now.heading);
    c.range_offset.value -= a.range.value;
  }

  void conclude(const AngleReadings& a, core::Calibration& cal) {
    const auto angle = [&](TargetAngle& t, const ReadingMean& r, const JointTarget::One& joint, const JointTarget::One* arm, Parameter p,
                           double present, core::Radians& measured, core::Radians& delivered) {
      t.parameter = p;
      t.present = present;
      t.determined = r.determined;
      const double current = measured.value;
      for (Reading one : r.readings) {
        one.value = current - one.value;
        t.readings.push_back(one);
      }
      t.mean = current - r.value;
      t.own = r.own;
      t.scatter = r.scatter;
      t.sigma = r.sigma;
      // A displacement that does not grow with the flying height is no angle's.
      if (t.determined && arm && out_.joint.two_heights && std::abs(arm->value) > significant_arm * arm->sigma) {
        t.mean = current - joint.value;
        t.sigma = t.own = joint.sigma;
        t.of_two_heights = true;
      }
      t.tolerance = options_.tolerance ? options_.tolerance->value : options_.tolerance_sigmas * t.sigma;
      t.beyond = t.determined && std::abs(t.mean - t.present) > t.tolerance;
      t.value = t.beyond ? t.mean : t.present;
      measured.value = t.determined ? t.mean : t.present;
      delivered.value = t.value;
    };
    angle(out_.roll, a.roll, out_.joint.roll, &out_.joint.lever_right, boresight_roll, present_.roll.value, cal.roll,
          out_.calibration.roll);
    angle(out_.pitch, a.pitch, out_.joint.pitch, &out_.joint.lever_forward, boresight_pitch, present_.pitch.value, cal.pitch,
          out_.calibration.pitch);
    angle(out_.heading, a.heading, out_.joint.heading, nullptr, boresight_heading, present_.heading.value, cal.heading,
          out_.calibration.heading);
    out_.range_determined = a.range.determined;
    out_.range_mean = cal.range_offset.value - a.range.value;
    out_.range_sigma = a.range.sigma;
    for (Reading one : a.range.readings) {
      one.value = cal.range_offset.value - one.value;
      out_.range_readings.push_back(one);
    }
    cal.range_offset.value = out_.range_mean;
    if (out_.range_determined && std::abs(out_.range_mean - out_.range_present) > options_.tolerance_sigmas * out_.range_sigma)
      out_.calibration.range_offset.value = out_.range_mean;
    if (out_.joint.scan_scale.free) {
      out_.scan_scale = present_.scan_scale - out_.joint.scan_scale.value;
      out_.scan_scale_sigma = out_.joint.scan_scale.sigma;
    }
  }

  const core::Scanner& scanner_;
  const core::Calibration present_;
  const core::SensorSigma& sigma_;
  const trajectory::Trajectory& trajectory_;
  const TrajectoryCovariance& covariance_;
  const FlatTargetOptions& options_;
  CollectedPulses collected_;
  FlatTarget out_;
};

}  // namespace

FlatTarget analyse_flat_target(const ShotStream& shots, const core::Scanner& scanner, const core::Calibration& calibration,
                               const core::SensorSigma& sigma, const trajectory::Trajectory& trajectory,
                               const TrajectoryCovariance& trajectory_covariance, const std::vector<io::ControlPoint>& control,
                               const FlatTargetOptions& options, core::Tally& tally) {
  return Analysis(scanner, calibration, sigma, trajectory, trajectory_covariance, options).run(shots, control, tally);
}

}  // namespace swath::calib
