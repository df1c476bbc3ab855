// SPDX-License-Identifier: GPL-3.0-or-later
// Options of the rigorous adjustment.
#pragma once

#include "core/config/option.h"

namespace swath::calib {

/// Which calibration values are unknowns. The others are held at their start values.
struct EstimateOptions {
  bool roll = true, pitch = true, heading = true;
  bool lever_forward = false, lever_right = false, lever_down = false;
  bool range_offset = true, range_scale = false;
  bool scan_offset = false, scan_scale = true;
  bool latency = false;
};

template <class V>
void describe(EstimateOptions& o, V& v) {
  v.option("roll", o.roll, "Boresight roll.");
  v.option("pitch", o.pitch, "Boresight pitch.");
  v.option("heading", o.heading, "Boresight heading.");
  v.option("lever_forward", o.lever_forward, "Scanner's lever arm, forward.");
  v.option("lever_right", o.lever_right, "Scanner's lever arm, right.");
  v.option("lever_down", o.lever_down, "Scanner's lever arm, down.");
  v.option("range_offset", o.range_offset, "Offset of the ranges.");
  v.option("range_scale", o.range_scale, "Factor of the ranges.");
  v.option("scan_offset", o.scan_offset,
           "Offset of the scan angle; held while boresight roll (conical: heading), the same turn, is estimated.");
  v.option("scan_scale", o.scan_scale, "Factor of the scan angle.");
  v.option("latency", o.latency, "Latency of the records' times.");
}

/// Sigmas of the start values as observations; 0: the start value counts for nothing. Not an option: a survey states them in [sigma]
/// (start_sigmas()); these stand in for those that it leaves out, and are the uncertainty of a mounting that nobody calibrated.
struct AprioriOptions {
  core::Radians roll = core::degrees(1.0), pitch = core::degrees(1.0), heading = core::degrees(1.0);
  core::Metres lever_arm{0.02};
  core::Metres range_offset{1.0};
  double range_scale = 1e-4;
  core::Radians scan_offset = core::degrees(1.0);
  double scan_scale = 2e-3;
  core::Seconds latency{0.01};
};

/// How the trajectory is corrected along each line.
enum class CorrectionForm {
  none,    ///< the trajectory is taken as free of error
  shift,   ///< one constant per line
  drift,   ///< a0 + a1 t
  spline,  ///< linear between knots
};
enum class CorrectionPrior {
  trajectory,  ///< covariances of the trajectory's errors between instants (trajectory::ErrorModel)
  stated,      ///< sigmas and a correlation time of this table
};

struct CorrectionOptions {
  CorrectionForm position = CorrectionForm::spline, attitude = CorrectionForm::spline;
  core::Seconds spacing{1.0};
  int most = 120000;
  CorrectionPrior prior = CorrectionPrior::trajectory;
  core::Metres stated_position{0.1};
  core::Radians stated_roll_pitch = core::degrees(0.01), stated_heading = core::degrees(0.02);
  core::Seconds stated_correlation{60.0};
};

template <class V>
void describe(CorrectionOptions& o, V& v) {
  v.option("position", o.position, "Position correction along each line: none, shift, drift (a0 + a1 t) or spline (knots by time).",
           "Ackermann eq 1");
  v.option("attitude", o.attitude, "Correction of the attitude along each line.");
  v.option("spacing", o.spacing, core::above(0), "Maximum time between two knots of a spline; too wide a spacing makes sigmas too small.");
  v.option("most", o.most, core::within(12, 1000000), "Most unknowns of all lines' corrections: the spacing is widened to keep it.");
  v.option("prior", o.prior, "Covariance of the corrections: the trajectory's, or the stated sigmas below.");
  v.option("stated_position", o.stated_position, core::above(0), "Sigma of each component of the position.");
  v.option("stated_roll_pitch", o.stated_roll_pitch, core::above(0), "Sigma of roll and of pitch.");
  v.option("stated_heading", o.stated_heading, core::above(0), "Sigma of the heading.");
  v.option("stated_correlation", o.stated_correlation, core::above(0), "Time in which the correlation falls to 1/e.");
}

/// Weights of single returns by their distance from the median of their group.
struct RobustOptions {
  double full = 2.5, zero = 6.0;
};

template <class V>
void describe(RobustOptions& o, V& v) {
  v.option("full", o.full, core::above(0), "Returns up to this many sigmas from their group's median have their full weight.");
  v.option("zero", o.zero, core::above(0), "Returns beyond this many sigmas have none.");
  v.check(o.zero > o.full, "zero must be greater than full");
}

struct SnoopingOptions {
  bool use = true;
  double alpha = 0.001;
  double share = 0.1;
};

/// `use`, `share`: what is tested, and of what the share may be left out.
template <class V>
void describe_snooping(SnoopingOptions& o, V& v, const char* use, const char* share) {
  v.option("use", o.use, use, "Baarda1968");
  v.option("alpha", o.alpha, core::within(1e-9, 0.1), "Probability of a false alarm in one test.");
  v.option("share", o.share, core::within(0, 0.5), share);
}

template <class V>
void describe(SnoopingOptions& o, V& v) {
  describe_snooping(o, v, "Test each plane in each line, and each control point, for a gross displacement, and leave it out.",
                    "Maximum share of the groups that may be left out, and of the control points.");
}

/// Which variances are estimated from the residuals.
struct ComponentOptions {
  bool range = true, angle = true, surface = true, position = true, attitude = true, control = true;
  core::Metres surface_sigma{0.003};
  double freedom = 15.0;
};

template <class V>
void describe(ComponentOptions& o, V& v) {
  v.option("range", o.range, "Estimate the sigma of the ranges.");
  v.option("angle", o.angle, "Estimate the sigma of the scan angles and of the pointing.");
  v.option("surface", o.surface, "Estimate the sigma by which a plane seen in one line departs from that of all lines.");
  v.option("position", o.position, "Estimate the factor of the trajectory's position sigmas.");
  v.option("attitude", o.attitude, "Estimate the factor of the trajectory's attitude sigmas.");
  v.option("control", o.control, "Estimate the factor of the control's sigmas.");
  v.option("surface_sigma", o.surface_sigma, core::above(0), "Start value of the surfaces' sigma.");
  v.option("freedom", o.freedom, core::at_least(1), "Degrees of freedom of the stated sigmas of trajectory and control.");
}

struct JackknifeOptions {
  bool lines = true;
  int blocks = 25;
  double significance = 0.01;
};

template <class V>
void describe(JackknifeOptions& o, V& v) {
  v.option("lines", o.lines, "Repeat the adjustment without each line in turn.");
  v.option("blocks", o.blocks, core::within(0, 200), "Repeat it without each of so many regions of planes in turn; 0: not.");
  v.option("significance", o.significance, core::within(1e-6, 0.5),
           "Enlarge a sigma where a jackknife's is larger than chance gives with this probability.");
}

/// A value whose sigma is larger is graded coarse; one that is not determined is not delivered.
struct LimitOptions {
  core::Radians roll_pitch = core::degrees(0.005), heading = core::degrees(0.01);
  core::Metres lever_arm{0.02};
  core::Metres range_offset{0.1};
  double range_scale = 5e-5;
  core::Radians scan_offset = core::degrees(0.005);
  double scan_scale = 2e-4;
  core::Seconds latency{0.001};
  double determined = 0.5;
};

template <class V>
void describe(LimitOptions& o, V& v) {
  v.option("roll_pitch", o.roll_pitch, core::above(0), "Sigma of boresight roll and pitch up to which it is graded good.");
  v.option("heading", o.heading, core::above(0), "Sigma of the boresight heading up to which it is graded good.");
  v.option("lever_arm", o.lever_arm, core::above(0), "Sigma of a component of the lever arm up to which it is graded good.");
  v.option("range_offset", o.range_offset, core::above(0), "Sigma of the range offset up to which it is graded good.");
  v.option("range_scale", o.range_scale, core::above(0), "Sigma of the range scale up to which it is graded good.");
  v.option("scan_offset", o.scan_offset, core::above(0), "Sigma of the scan offset up to which it is graded good.");
  v.option("scan_scale", o.scan_scale, core::above(0), "Sigma of the scan scale up to which it is graded good.");
  v.option("latency", o.latency, core::above(0), "Sigma of the latency up to which it is graded good.");
  v.option("determined", o.determined, core::within(0, 1),
           "Share of the knowledge of a value that the flight must bring for it to be delivered.");
}

struct AdjustOptions {
  EstimateOptions estimate;
  AprioriOptions apriori;
  CorrectionOptions corrections;
  RobustOptions robust;
  SnoopingOptions snooping;
  ComponentOptions components;
  JackknifeOptions jackknife;
  LimitOptions limits;
  int iterations = 15;
};

template <class V>
void describe(AdjustOptions& o, V& v) {
  v.table("estimate", o.estimate, "Which values are unknowns.");
  v.table("corrections", o.corrections, "Corrections to the trajectory along each line.");
  v.table("robust", o.robust, "Weights of single returns.");
  v.table("snooping", o.snooping, "Search for displaced planes and wrong control.");
  v.table("components", o.components, "Variances estimated from the residuals.");
  v.table("jackknife", o.jackknife, "Sigmas by leaving out.");
  v.table("limits", o.limits, "Grades of the values: good within these sigmas, coarse beyond; undetermined ones are not delivered.");
  v.option("iterations", o.iterations, core::within(2, 100), "Most rounds of linearisation.");
}

}  // namespace swath::calib

namespace swath::core {
template <>
struct Choices<calib::CorrectionForm> {
  static constexpr std::array<std::string_view, 4> names{"none", "shift", "drift", "spline"};
};
template <>
struct Choices<calib::CorrectionPrior> {
  static constexpr std::array<std::string_view, 2> names{"trajectory", "stated"};
};
}  // namespace swath::core
