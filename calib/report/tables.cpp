// SPDX-License-Identifier: GPL-3.0-or-later
// Over 400 lines: one table after another, each a few lines, which share their helpers.
#include "calib/report/tables.h"

#include <algorithm>
#include <cmath>

#include "calib/report/agreement.h"
#include "calib/report/delivered.h"
#include "calib/report/residual_bins.h"
#include "calib/report/verdict.h"
#include "core/config/units.h"
#include "core/geo/frames.h"
#include "core/printable.h"
#include "io/survey/calibration_file.h"

namespace swath::calib {
namespace {

using core::Value;

/// Rows of one CSV file.
class Csv {
 public:
  explicit Csv(const char* head) : text_(std::string(head) + "\n") {}
  Csv& operator<<(double v) { return put(std::isfinite(v) ? core::format_number(v) : ""); }
  Csv& operator<<(std::uint64_t v) { return put(std::to_string(v)); }
  Csv& operator<<(int v) { return put(std::to_string(v)); }
  Csv& operator<<(std::string_view v) { return put(core::csv_field(v)); }
  void end() {
    text_ += "\n";
    first_ = true;
  }
  std::string text() && { return std::move(text_); }

 private:
  Csv& put(const std::string& field) {
    if (!first_) text_ += ",";
    first_ = false;
    text_ += field;
    return *this;
  }
  std::string text_;
  bool first_ = true;
};

Value list_of(const auto& numbers) {
  Value out = Value::array();
  for (const double v : numbers) out.push(v);
  return out;
}

Value names_of(const std::vector<calib::Parameter>& parameters) {
  Value out = Value::array();
  for (const calib::Parameter p : parameters) out.push(words_of(p).key);
  return out;
}

Value estimates_tree(const calib::Adjustment& a) {
  Value out = Value::array();
  for (int k = 0; k < estimated_count; ++k) {
    const calib::Parameter p = parameter_at(k);
    const calib::Estimate& e = a.estimates[static_cast<size_t>(k)];
    const bool delivered = is_delivered(a, p);
    Value one;
    one["parameter"] = words_of(p).key;
    one["name"] = words_of(p).name;
    one["unit"] = words_of(p).unit;
    one["estimated"] = e.estimated;
    one["delivered"] = delivered;
    one["nominal"] = e.start;
    if (e.estimated) {
      one["grade"] = calib::name_of(delivered || e.grade == calib::Grade::unsettled ? e.grade : calib::Grade::undetermined);
      one["found"] = e.found;
      one["found_sigma"] = e.found_sigma;
    }
    if (delivered) {
      one["value"] = e.value;
      one["sigma"] = e.sigma;
    }
    if (e.estimated) {
      one["formal"] = e.formal;
      one["jackknife_lines"] = e.jackknife_lines;
      one["jackknife_planes"] = e.jackknife_planes;
      one["white"] = e.white;
      one["held"] = e.held;
      one["apriori"] = e.apriori;
      one["determined"] = e.determined;
    }
    out.push(std::move(one));
  }
  return out;
}

Value correlation_tree(const calib::Adjustment& a) {
  Value out, names = Value::array(), rows = Value::array();
  for (int k = 0; k < estimated_count; ++k)
    if (a.estimates[static_cast<size_t>(k)].estimated) names.push(words_of(parameter_at(k)).key);
  for (Eigen::Index r = 0; r < a.correlation.rows(); ++r) rows.push(list_of(a.correlation.row(r)));
  out["parameters"] = std::move(names);
  out["matrix"] = std::move(rows);
  return out;
}

Value flight_tree(const CalibrationReport& report) {
  Value lines = Value::array(), pairs = Value::array(), planes = Value::object(), out;
  for (const ReportedLine& l : report.lines) {
    Value one;
    one["id"] = l.id;
    one["name"] = l.name;
    one["heading"] = l.heading;
    one["height"] = l.height;
    one["speed"] = l.speed;
    one["length"] = l.length;
    one["first"] = l.first;
    one["last"] = l.last;
    one["returns"] = l.returns;
    one["planes"] = planes_of(report.ties, l.id);
    lines.push(std::move(one));
  }
  for (size_t a = 0; a < report.lines.size(); ++a)
    for (size_t b = a + 1; b < report.lines.size(); ++b) {
      const std::uint64_t common = common_planes(report.ties, report.lines[a].id, report.lines[b].id);
      if (common == 0) continue;
      Value one;
      one["lines"].push(report.lines[a].id);
      one["lines"].push(report.lines[b].id);
      one["planes"] = common;
      one["turn"] = std::abs(core::wrap_pi(report.lines[b].heading - report.lines[a].heading));
      pairs.push(std::move(one));
    }
  for (int k = 0; k <= static_cast<int>(calib::TieKind::target); ++k) {
    const auto kind = static_cast<calib::TieKind>(k);
    Value& one = planes[calib::name_of(kind)];
    const auto count = [&](auto&& is) {
      return static_cast<std::uint64_t>(std::count_if(report.ties.planes.begin(), report.ties.planes.end(), is));
    };
    one["planes"] = count([&](const calib::TiePlane& p) { return p.kind == kind; });
    one["surveyed"] = count([&](const calib::TiePlane& p) { return p.kind == kind && !p.control.empty(); });
  }
  out["lines"] = std::move(lines);
  out["pairs"] = std::move(pairs);
  out["planes"] = std::move(planes);
  return out;
}

Value bins_tree(const CalibrationReport& report, BinBy by, double unit) {
  Value out = Value::array();
  for (const ResidualBin& b : residual_bins(report.adjustment, report.ties, by)) {
    Value one;
    if (by == BinBy::line) {
      one["line"] = static_cast<std::int64_t>(b.low);
    } else {
      one["from"] = b.low * unit;
      one["to"] = b.high * unit;
    }
    one["groups"] = b.groups;
    one["rejected"] = b.rejected;
    one["returns"] = b.returns;
    one["mean_before"] = b.mean_before;
    one["rms_before"] = b.rms_before;
    one["mean_after"] = b.mean_after;
    one["rms_after"] = b.rms_after;
    one["rms_returns"] = b.rms_returns;
    one["largest_w"] = b.largest_w;
    out.push(std::move(one));
  }
  return out;
}

/// Points of the adjustment lie on planes, check points do not.
Value control_tree(const std::vector<calib::ControlResidual>& rows, bool of_planes) {
  Value out = Value::array();
  for (const calib::ControlResidual& c : rows) {
    Value one;
    one["name"] = c.name;
    if (of_planes) one["plane"] = static_cast<std::uint64_t>(c.plane);
    one["residual"] = c.residual;
    one["sigma"] = c.sigma;
    if (of_planes) one["redundancy"] = c.redundancy;
    one["w"] = c.w;
    if (of_planes) one["rejected"] = c.rejected;
    out.push(std::move(one));
  }
  return out;
}

Value differences_tree(const CalibrationReport& report) {
  Value out = Value::array();
  for (const LineDifference& d : report.differences) {
    Value one;
    one["lines"].push(d.line_a);
    one["lines"].push(d.line_b);
    for (const bool before : {true, false}) {
      const core::Grid& g = before ? d.before : d.after;
      const report::Statistics s = difference_statistics(g);
      Value& side = one[before ? "before" : "after"];
      side["file"] = difference_file(d, before);
      side["cell"] = g.lattice.cell;
      side["metres_per_unit"] = report.vertical_unit;  // of the file's heights
      side["statistics"] = report::value_of(s);
    }
    out.push(std::move(one));
  }
  return out;
}

Value sections_tree(const CalibrationReport& report) {
  Value out = Value::array();
  for (const CrossSection& s : report.sections) {
    Value one;
    one["name"] = s.name;
    one["width"] = s.width;
    for (const Eigen::Vector2d& end : s.ends) one["ends"].push(list_of(end));
    out.push(std::move(one));
  }
  return out;
}

Value readings_tree(const CalibrationReport& report) {
  Value out = Value::array();
  for (const TargetReading& r : report.readings) {
    const Agreement g = agreement_of(report.adjustment, r);
    Value one;
    one["parameter"] = words_of(r.parameter).key;
    one["value"] = r.value;
    one["sigma"] = r.sigma;
    one["readings"] = r.readings;
    one["note"] = r.note;
    if (g.known) {
      one["difference"] = g.difference;
      one["joint_sigma"] = g.joint_sigma;
      one["agrees"] = g.agrees;
    }
    out.push(std::move(one));
  }
  return out;
}

Value strips_tree(const calib::PlaneDifferences& d) {
  const auto of = [](const calib::PairOnPlanes& p) {
    Value one;
    one["planes"] = p.planes;
    one["mean_before"] = p.mean_before;
    one["rms_before"] = p.rms_before;
    one["mean_after"] = p.mean_after;
    one["rms_after"] = p.rms_after;
    return one;
  };
  Value out;
  out["all"] = of(d.all);
  out["pairs"] = Value::array();
  for (const calib::PairOnPlanes& p : d.pairs) {
    Value one;
    one["lines"].push(p.line_a);
    one["lines"].push(p.line_b);
    const Value rest = of(p);
    for (const auto& [key, value] : rest.members()) one[key] = value;
    out["pairs"].push(std::move(one));
  }
  return out;
}

}  // namespace

std::string differences_after(const CalibrationReport& report) {
  return report.strips ? "Before: with the trajectory as it was given. After: with the corrected trajectory."
                       : "Before: with the start values. After: with the delivered calibration and the trajectory as it was given, as in a "
                         "survey that uses this calibration; the corrections of the lines (corrections.csv) are not in it.";
}

std::string difference_file(const LineDifference& d, bool before) {
  return "differences/" + std::to_string(d.line_a) + "_" + std::to_string(d.line_b) + (before ? "_before.tif" : "_after.tif");
}

core::Value calibration_report_tree(const CalibrationReport& report) {
  const calib::Adjustment& a = report.adjustment;
  const CalibrationVerdict v = verdict_of(report);
  Value out;
  if (!report.strips) {
    const DeliveredCalibration d = delivered(a, report.sensor);
    out = io::calibration_tree(d.calibration, d.sigma);
  }
  out["survey"] = report.survey;
  out["crs"] = report.crs;
  out["program"] = report.origin.program;
  out["flown"]["from"] = report.origin.flown_from;
  out["flown"]["to"] = report.origin.flown_to;
  Value& inputs = out["inputs"] = Value::array();
  for (const std::string& input : report.origin.inputs) inputs.push(input);
  if (!report.strips) out["calibrated"] = v.calibrated;
  out["verdict"] = v.text;
  if (report.strips) out["plane_differences"] = strips_tree(*report.strips);
  Value findings = Value::array(), components = Value::array();
  for (const calib::Finding& f : a.findings) {
    Value one;
    one["what"] = f.what;
    one["cure"] = f.cure;
    one["parameters"] = names_of(f.parameters);
    one["refuses"] = f.refuses;
    findings.push(std::move(one));
  }
  out["findings"] = std::move(findings);
  out["notes"] = Value::array();
  for (const std::string& note : report.notes) out["notes"].push(note);
  if (!report.strips) {
    out["estimates"] = estimates_tree(a);
    if (!out.find("correlation")) out["correlation"] = correlation_tree(a);
  }
  Value& sums = out["adjustment"];
  sums["observations"] = a.observations;
  sums["unknowns"] = a.unknowns;
  sums["sigma0"] = a.sigma0;
  sums["condition"] = a.condition;
  sums["iterations"] = a.iterations;
  sums["groups"] = static_cast<std::uint64_t>(a.groups.size());
  sums["rejected_returns"] = a.rejected_returns;
  out["flight"] = flight_tree(report);
  for (const calib::VarianceComponent& c : a.components) {
    Value one;
    one["name"] = c.name;
    one["stated"] = c.stated;
    one["factor"] = c.factor;
    one["redundancy"] = c.redundancy;
    one["estimated"] = c.estimated;
    components.push(std::move(one));
  }
  out["variance_components"] = std::move(components);
  Value& residuals = out["residuals"];
  residuals["by_line"] = bins_tree(report, BinBy::line, 1.0);
  residuals["by_angle"] = bins_tree(report, BinBy::angle, core::degree);
  residuals["by_range"] = bins_tree(report, BinBy::range, 1.0);
  residuals["by_time"] = bins_tree(report, BinBy::time, 1.0);
  residuals["first_time"] = first_time(report.ties);
  out["control"] = control_tree(a.control, true);
  out["checks"] = control_tree(report.checks, false);
  out["sections"] = sections_tree(report);
  out["differences"] = differences_tree(report);
  if (!report.differences.empty()) out["differences_after"] = differences_after(report);
  out["readings"] = readings_tree(report);
  if (!report.flat_target.is_null()) out["flat_target"] = report.flat_target;
  Value& frame = out["frame"];
  frame["origin"] = list_of(report.ties.frame.origin);
  for (Eigen::Index r = 0; r < 3; ++r) frame["local_R_ecef"].push(list_of(report.ties.frame.local_R_ecef.row(r)));
  return out;
}

std::string residuals_csv(const CalibrationReport& report) {
  Csv csv("plane,kind,line,returns,time_s,scan_angle_deg,range_m,before_m,after_m,rms_m,redundancy,w,rejected");
  for (const calib::GroupResidual& g : report.adjustment.groups) {
    csv << static_cast<std::uint64_t>(g.plane) << calib::name_of(report.ties.planes[g.plane].kind) << report.ties.lines[g.line].id
        << static_cast<std::uint64_t>(g.returns) << bin_value(g, report.ties, BinBy::time) << bin_value(g, report.ties, BinBy::angle)
        << g.range << g.before << g.after << g.rms << g.redundancy << g.w << static_cast<int>(g.rejected);
    csv.end();
  }
  return std::move(csv).text();
}

std::string corrections_csv(const CalibrationReport& report) {
  Csv csv(
      "line,time_s,north_m,east_m,down_m,roll_rad,pitch_rad,heading_rad,sigma_north_m,sigma_east_m,sigma_down_m,sigma_roll_rad,"
      "sigma_pitch_rad,sigma_heading_rad,apriori_north_m,apriori_east_m,apriori_down_m,apriori_roll_rad,apriori_pitch_rad,"
      "apriori_heading_rad");
  const double first = first_time(report.ties);
  for (const calib::LineCorrection& c : report.adjustment.corrections)
    for (size_t k = 0; k < c.time.size(); ++k) {
      csv << c.line << c.time[k] - first;
      for (const auto* columns : {&c.value, &c.sigma, &c.apriori})
        for (size_t axis = 0; axis < 6; ++axis) csv << (k < columns->size() ? (*columns)[k][axis] : calib::not_known);
      csv.end();
    }
  return std::move(csv).text();
}

std::string planes_csv(const CalibrationReport& report) {
  Csv csv(
      "plane,kind,name,east_m,north_m,up_m,normal_east,normal_north,normal_up,half_u_m,half_v_m,roughness_m,sigma_height_m,control_points,"
      "groups");
  std::vector<std::uint64_t> groups(report.ties.planes.size());
  for (const calib::TieGroup& g : report.ties.groups) ++groups[g.plane];
  const bool adjusted = report.adjustment.planes.size() == report.ties.planes.size();
  for (size_t k = 0; k < report.ties.planes.size(); ++k) {
    const calib::TiePlane& found = report.ties.planes[k];
    const calib::TiePlane& p = adjusted ? report.adjustment.planes[k] : found;
    csv << static_cast<std::uint64_t>(k) << calib::name_of(found.kind) << found.name << p.centre[0] << p.centre[1] << p.centre[2]
        << p.normal[0] << p.normal[1] << p.normal[2] << found.half[0] << found.half[1] << found.roughness
        << (k < report.adjustment.plane_sigma.size() ? report.adjustment.plane_sigma[k][0] : calib::not_known)
        << static_cast<std::uint64_t>(found.control.size()) << groups[k];
    csv.end();
  }
  return std::move(csv).text();
}

std::string sections_csv(const CalibrationReport& report) {
  Csv csv("section,state,line,along_m,height_m");
  for (size_t s = 0; s < report.sections.size(); ++s)
    for (const bool before : {true, false})
      for (const SectionPoints& points : before ? report.sections[s].before : report.sections[s].after)
        for (size_t k = 0; k < points.along.size(); ++k) {
          csv << static_cast<std::uint64_t>(s) << std::string_view(before ? "before" : "after") << points.line << points.along[k]
              << points.height[k];
          csv.end();
        }
  return std::move(csv).text();
}

}  // namespace swath::calib
