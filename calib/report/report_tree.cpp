// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/report_tree.h"

#include "calib/report/agreement.h"
#include "calib/report/delivered.h"
#include "calib/report/flight_design.h"
#include "calib/report/residual_bins.h"
#include "calib/report/tables.h"
#include "calib/report/verdict.h"
#include "core/config/result_visitors.h"
#include "core/config/units.h"
#include "io/survey/calibration_file.h"

namespace swath::calib {
namespace {

constexpr core::Form si = core::Form{"SI"}.always(), ratio = core::plain().always(), m = core::metres().always();

struct EstimateRow {
  Estimate of;
  bool delivered = false;
};

template <class V>
void describe(const EstimateRow& r, V& v) {
  const Estimate& e = r.of;
  const core::Form estimated = si.only_if(e.estimated), share = ratio.only_if(e.estimated), delivered = si.only_if(r.delivered);
  const bool keeps_grade = r.delivered || e.grade == Grade::unsettled;
  v.result("parameter", words_of(e.parameter).key, "Key of the parameter.");
  v.result("name", words_of(e.parameter).name, "Its name.");
  v.result("unit", words_of(e.parameter).unit, "Unit of all its values.");
  v.result("estimated", e.estimated, "False: held at the nominal value.");
  v.result("delivered", r.delivered, "True: what was found is the calibration's value.");
  v.result("nominal", e.start, si, "Value at the start.");
  v.result("grade", name_of(keeps_grade ? e.grade : Grade::undetermined), core::plain().only_if(e.estimated), "How well it is determined.");
  v.result("found", e.found, estimated, "What the adjustment found, delivered or not.");
  v.result("found_sigma", e.found_sigma, estimated, "Standard deviation of what was found.");
  v.result("value", e.value, delivered, "Delivered value.");
  v.result("sigma", e.sigma, delivered, "Its standard deviation.");
  v.result("formal", e.formal, estimated, "Sigma by the covariance, the trajectory's errors correlated in time.");
  v.result("jackknife_lines", e.jackknife_lines, estimated, "Sigma by leaving out one line at a time.");
  v.result("jackknife_planes", e.jackknife_planes, estimated, "Sigma by leaving out one region of planes at a time.");
  v.result("white", e.white, estimated, "Sigma if all returns were independent and the trajectory free of error.");
  v.result("held", e.held, estimated, "Sigma by the stated sigmas of values that were held.");
  v.result("apriori", e.apriori, estimated, "Sigma of the nominal value; null: free.");
  v.result("determined", e.determined, share, "Share of the knowledge that comes from the data.");
}

std::vector<EstimateRow> estimates_of(const Adjustment& a) {
  std::vector<EstimateRow> out;
  for (int k = 0; k < estimated_count; ++k) out.push_back({a.estimates[static_cast<size_t>(k)], is_delivered(a, parameter_at(k))});
  return out;
}

/// A bin of residuals by one quantity.
struct BinRow {
  ResidualBin bin;
  BinBy by = BinBy::line;
};

template <class V>
void describe(const BinRow& r, V& v) {
  const ResidualBin& b = r.bin;
  const bool of_line = r.by == BinBy::line;
  const double unit = r.by == BinBy::angle ? core::degree : 1.0;
  v.result("line", static_cast<int>(b.low), core::plain().only_if(of_line), "Number of the line.");
  v.result("from", b.low * unit, si.only_if(!of_line), "Lower end of the bin.");
  v.result("to", b.high * unit, si.only_if(!of_line), "Upper end of the bin.");
  v.result("groups", b.groups, "Groups of returns in use.");
  v.result("rejected", b.rejected, "Groups taken out.");
  v.result("returns", b.returns, "Returns of the groups in use.");
  v.result("mean_before", b.mean_before, m, "Mean distance of groups from their planes, start values.");
  v.result("rms_before", b.rms_before, m, "RMS of these distances.");
  v.result("mean_after", b.mean_after, m, "Mean distance after the adjustment.");
  v.result("rms_after", b.rms_after, m, "RMS of these distances.");
  v.result("rms_returns", b.rms_returns, m, "RMS of all returns about the adjusted planes.");
  v.result("largest_w", b.largest_w, ratio, "Largest size of a standardised residual.");
}

struct Residuals {
  const CalibrationReport& report;
  std::vector<BinRow> by(BinBy what) const {
    std::vector<BinRow> out;
    for (const ResidualBin& b : residual_bins(report.adjustment, report.ties, what)) out.push_back({b, what});
    return out;
  }
};

template <class V>
void describe(const Residuals& r, V& v) {
  v.tables("by_line", r.by(BinBy::line), "Residuals by flight line.");
  v.tables("by_angle", r.by(BinBy::angle), "Residuals by scan angle, rad.");
  v.tables("by_range", r.by(BinBy::range), "Residuals by range, m.");
  v.tables("by_time", r.by(BinBy::time), "Residuals by seconds since `first_time`.");
  v.result("first_time", first_time(r.report.ties), core::seconds().always(), "GPS time of the first return of all lines.");
}

/// A surveyed point: on a plane of the adjustment, or a check point.
struct PointRow {
  ControlResidual of;
  bool on_plane = true;
};

template <class V>
void describe(const PointRow& r, V& v) {
  const core::Form on_plane = core::plain().only_if(r.on_plane);
  v.result("name", r.of.name, "Name of the point.");
  v.result("plane", r.of.plane, on_plane, "Plane that it lies on, from 0.");
  v.result("residual", r.of.residual, m, "Distance of the point from its plane; of a check point, height of the returns less its own.");
  v.result("sigma", r.of.sigma, m, "Standard deviation of the residual.");
  v.result("redundancy", r.of.redundancy, ratio.only_if(r.on_plane), "Share of an error of the point that its residual shows.");
  v.result("w", r.of.w, ratio, "Standardised residual.");
  v.result("rejected", r.of.rejected, on_plane, "True: taken out.");
}

std::vector<PointRow> points(const std::vector<ControlResidual>& of, bool on_plane) {
  std::vector<PointRow> out;
  for (const ControlResidual& c : of) out.push_back({c, on_plane});
  return out;
}

struct DifferenceMap {
  std::string file;
  double cell = 0.0, unit = 1.0;
  report::Statistics statistics;
};

template <class V>
void describe(const DifferenceMap& r, V& v) {
  v.result("file", r.file, "GeoTIFF beside this file.");
  v.result("cell", r.cell, m, "Side of a cell.");
  v.result("metres_per_unit", r.unit, ratio, "Metres per unit of the heights in the GeoTIFF.");
  v.table("statistics", r.statistics, "Height differences, m.");
}

struct DifferenceRow {
  std::array<int, 2> lines{};
  DifferenceMap before, after;
};

template <class V>
void describe(const DifferenceRow& r, V& v) {
  v.result("lines", r.lines, "Heights of the first line less those of the second.");
  v.table("before", r.before, "With the start values.");
  v.table("after", r.after, "With the result.");
}

std::vector<DifferenceRow> differences_of(const CalibrationReport& report) {
  std::vector<DifferenceRow> out;
  const auto map = [&](const LineDifference& d, bool before) -> DifferenceMap {
    const core::Grid& g = before ? d.before : d.after;
    return {difference_file(d, before), g.lattice.cell, report.vertical_unit, difference_statistics(g)};
  };
  for (const LineDifference& d : report.differences) out.push_back({{d.line_a, d.line_b}, map(d, true), map(d, false)});
  return out;
}

struct ReadingRow {
  TargetReading of;
  Agreement agreement;
};

template <class V>
void describe(const ReadingRow& r, V& v) {
  const Agreement& a = r.agreement;
  v.result("parameter", words_of(r.of.parameter).key, "Key of the parameter.");
  v.result("value", r.of.value, si, "Value by the flat target.");
  v.result("sigma", r.of.sigma, si, "Its standard deviation.");
  v.result("readings", r.of.readings, "Readings that it is the mean of.");
  v.result("note", r.of.note, "Which lines.");
  v.result("difference", a.difference, si.only_if(a.known), "Value less that of the adjustment.");
  v.result("joint_sigma", a.joint_sigma, si.only_if(a.known), "Standard deviation of the difference.");
  v.result("agrees", a.agrees, core::plain().only_if(a.known), "True: the difference is within two of these.");
}

std::vector<ReadingRow> readings_of(const CalibrationReport& report) {
  std::vector<ReadingRow> out;
  for (const TargetReading& r : report.readings) out.push_back({r, agreement_of(report.adjustment, r)});
  return out;
}

struct Frame {
  const trajectory::LocalFrame& of;
};

template <class V>
void describe(const Frame& r, V& v) {
  v.result("origin", r.of.origin, core::metres(), "Origin in ECEF.");
  v.result("local_R_ecef", r.of.local_R_ecef, "Rows: east, north, up.");
}

}  // namespace

template <class V>
void describe(const ReportOrigin& r, V& v) {
  v.result("from", r.flown_from, "UTC of the first return; empty where the week is not known.");
  v.result("to", r.flown_to, "UTC of the last return.");
}

template <class V>
void describe(const Finding& r, V& v) {
  std::vector<std::string> names;
  for (const Parameter p : r.parameters) names.emplace_back(words_of(p).key);
  v.result("what", r.what, "What was found.");
  v.result("cure", r.cure, "What to do.");
  v.result("parameters", names, "Parameters concerned.");
  v.result("refuses", r.refuses, "True: these parameters are not delivered.");
}

template <class V>
void describe(const Adjustment& r, V& v) {
  v.result("observations", r.observations, "Observations.");
  v.result("unknowns", r.unknowns, "Unknowns.");
  v.result("sigma0", r.sigma0, ratio, "A posteriori sigma of unit weight.");
  v.result("condition", r.condition, ratio, "Condition number of the scaled normal matrix of the calibration values; null: not computed.");
  v.result("iterations", r.iterations, "Rounds of linearisation.");
  v.result("groups", r.groups.size(), "Groups of returns: one line on one plane.");
  v.result("knot_spacing", r.knot_spacing, core::seconds().only_if(r.knot_spacing > 0.0),
           "Time between two knots of a line's corrections.");
  v.result("rejected_returns", r.rejected_returns, "Returns taken out.");
}

template <class V>
void describe(const VarianceComponent& r, V& v) {
  v.result("name", r.name, "Kind of observation.");
  v.result("stated", r.stated, si, "Stated sigma.");
  v.result("factor", r.factor, ratio, "Estimated sigma divided by the stated one.");
  v.result("redundancy", r.redundancy, ratio, "Redundancy that it is estimated from.");
  v.result("estimated", r.estimated, "False: too little redundancy, the stated one was kept.");
}

template <class V>
void describe(const CrossSection& r, V& v) {
  Eigen::Matrix2d ends;
  ends << r.ends[0].transpose(), r.ends[1].transpose();
  v.result("name", r.name, "Name of the section.");
  v.result("width", r.width, m, "Width of the strip whose returns are shown.");
  v.result("ends", ends, m, "Both ends on the map.");
}

template <class V>
void describe(const CalibrationReport& r, V& v) {
  const CalibrationVerdict verdict = verdict_of(r);
  v.result("survey", r.survey, "Name of the survey.");
  v.result("crs", r.crs, "CRS of sections and differences.");
  v.result("program", r.origin.program, "Program with its version.");
  v.table("flown", r.origin, "When it was flown.");
  v.result("inputs", r.origin.inputs, "Files that it was made from.");
  v.result("calibrated", verdict.calibrated, core::plain().only_if(!r.strips), "True: all estimated boresight angles are delivered.");
  v.result("verdict", verdict.text, "The result as sentences.");
  v.table("plane_differences", r.strips, "How the lines of a strip or joint adjustment meet on planes.");
  v.tables("findings", r.adjustment.findings, "What the flight does not determine, or what looks wrong.");
  v.result("notes", r.notes, "Further sentences.");
  v.tables_if(!r.strips || r.joint, "estimates", estimates_of(r.adjustment), "All parameters that can be estimated.");
  v.table("adjustment", r.adjustment, "The adjustment in figures.");
  v.table("flight", flight_design(r), "How the flight was flown.");
  v.tables("variance_components", r.adjustment.components, "Errors of the observations, as stated and as found.");
  v.table("residuals", Residuals{r}, "Groups of returns about their planes.");
  v.tables("control", points(r.adjustment.control, true), "Surveyed points that took part.");
  v.tables("checks", points(r.checks, false), "Surveyed points that took no part.");
  v.tables("sections", r.sections, "Cross sections.");
  v.tables("differences", differences_of(r), "Height differences of overlapping lines.");
  v.result("differences_after", differences_after(r), core::plain().only_if(!r.differences.empty()), "What `after` means there.");
  v.tables("readings", readings_of(r), "The same parameters by a flat target.");
  v.table("frame", Frame{r.ties.frame}, "Local frame of the tie planes.");
}

core::Value calibration_report_tree(const CalibrationReport& report) {
  core::Value out = core::Value::object(), rest = core::reported(report);
  if (!report.strips) {
    const DeliveredCalibration d = delivered(report.adjustment, report.sensor);
    out = io::calibration_tree(d.calibration, d.sigma);
  }
  for (core::Value::Member& member : rest.members()) out.members().push_back(std::move(member));
  if (!report.flat_target.is_null()) out["flat_target"] = report.flat_target;
  return out;
}

}  // namespace swath::calib
