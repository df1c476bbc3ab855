// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/flat_target_report.h"

#include <algorithm>
#include <cmath>

#include "core/config/units.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"

namespace swath::calib {
namespace {

using calib::FlatTarget;
using calib::Reading;
using calib::TargetAngle;
using calib::TargetLine;
using calib::TargetView;
using core::Value;
using Eigen::Vector2d;

constexpr double arc_second = core::degree / 3600.0;

struct Named {
  const char* name;
  const TargetAngle& angle;
};
std::vector<Named> angles_of(const FlatTarget& t) { return {{"pitch", t.pitch}, {"roll", t.roll}, {"heading", t.heading}}; }

Value lines_of(const Reading& r) {
  Value out = Value::array();
  out.push(r.first);
  if (r.second >= 0) out.push(r.second);
  return out;
}

Value value_of(const TargetView& v) {
  Value out = Value::object();
  out["seen"] = v.seen;
  if (!v.seen) {
    if (!v.why_not.empty()) out["why_not"] = v.why_not;
    return out;
  }
  out["pulses"] = v.pulses;
  out["on_roof"] = v.on_roof;
  out["along_m"] = v.displacement.x();
  out["along_sigma_of_returns_m"] = std::sqrt(v.covariance(0, 0));
  out["across_m"] = v.displacement.y();
  out["across_sigma_of_returns_m"] = std::sqrt(v.covariance(1, 1));
  out["up_m"] = v.height;
  out["up_sigma_of_returns_m"] = v.height_sigma;
  out["tilt_along"] = v.tilt_along;
  out["tilt_across"] = v.tilt_across;
  out["shear_deg"] = core::to_degrees(v.shear);
  out["longer_ppm"] = 1e6 * v.strain_along;
  out["longer_sigma_ppm"] = 1e6 * v.strain_along_sigma;
  out["wider_ppm"] = 1e6 * v.strain_across;
  out["wider_sigma_ppm"] = 1e6 * v.strain_across_sigma;
  out["growth_at_edges_m"] = v.growth;
  out["blur_at_edges_m"] = v.blur;
  out["half_footprint_m"] = v.half_footprint;
  out["roughness_m"] = v.roughness;
  out["chi2"] = v.chi2;
  Value& edges = out["edges"] = Value::array();
  for (const calib::SideView& s : v.sides) {
    Value one = Value::object();
    one["seen"] = s.used;
    if (s.used) {
      one["outward_m"] = s.offset;
      one["sigma_m"] = std::sqrt(s.covariance(0, 0));
      one["pulses"] = s.pulses;
    }
    edges.push(one);
  }
  return out;
}

Value value_of(const TargetLine& l) {
  Value out = Value::object();
  out["line"] = l.line;
  out["takes_part"] = l.measured;
  if (l.kept_one_in > 1) out["kept_one_pulse_in"] = l.kept_one_in;
  if (l.measured) {
    out["role"] = calib::name_of(l.role);
    out["heading_deg"] = core::to_degrees(core::wrap_two_pi(l.after.heading));
    out["height_m"] = l.target.z();
    out["target_to_the_right_m"] = l.target.y();
    out["scan_angle_deg"] = core::to_degrees(l.scan_angle);
    out["along_sigma_m"] = l.sigma.x();
    out["across_sigma_m"] = l.sigma.y();
    out["up_sigma_m"] = l.sigma.z();
  }
  out["before"] = value_of(l.before);
  out["after"] = value_of(l.after);
  return out;
}

Value value_of(const TargetAngle& a) {
  Value out = Value::object();
  out["determined"] = a.determined;
  out["present_deg"] = core::to_degrees(a.present);
  out["value_deg"] = core::to_degrees(a.value);
  if (!a.determined) return out;
  out["mean_deg"] = core::to_degrees(a.mean);
  out["sigma_arcsec"] = a.sigma / arc_second;
  out["sigma_of_readings_arcsec"] = a.own / arc_second;
  if (a.scatter > 0.0) out["sigma_by_scatter_arcsec"] = a.scatter / arc_second;
  out["tolerance_arcsec"] = a.tolerance / arc_second;
  out["beyond_tolerance"] = a.beyond;
  if (a.of_two_heights) out["by_two_heights"] = true;
  Value& readings = out["readings"] = Value::array();
  for (const Reading& r : a.readings) {
    Value one = Value::object();
    one["lines"] = lines_of(r);
    one["value_deg"] = core::to_degrees(r.value);
    one["sigma_arcsec"] = r.sigma / arc_second;
    readings.push(one);
  }
  return out;
}

Value joint_of(const FlatTarget& t) {
  const calib::JointTarget& j = t.joint;
  Value out = Value::object();
  const auto angle = [&](const char* name, const calib::JointTarget::One& one, double measured) {
    if (!one.free) return;
    out[name]["value_deg"] = core::to_degrees(measured - one.value);
    out[name]["sigma_arcsec"] = one.sigma / arc_second;
  };
  // What was left after the last round, on top of what the rounds have found.
  angle("roll", j.roll, t.measured.roll.value);
  angle("pitch", j.pitch, t.measured.pitch.value);
  angle("heading", j.heading, t.measured.heading.value);
  const auto metres = [&](const char* name, double value, double sigma) {
    out[name]["value_m"] = value;
    out[name]["sigma_m"] = sigma;
  };
  metres("datum_east", j.datum.x(), j.datum_sigma.x());
  metres("datum_north", j.datum.y(), j.datum_sigma.y());
  if (j.lever_forward.free) metres("lever_arm_forward_correction", -j.lever_forward.value, j.lever_forward.sigma);
  if (j.lever_right.free) metres("lever_arm_right_correction", -j.lever_right.value, j.lever_right.sigma);
  out["lowest_height_m"] = j.lowest;
  out["highest_height_m"] = j.highest;
  out["chi2"] = j.chi2;
  return out;
}

}  // namespace

Value summary_of(const FlatTarget& t) {
  Value out = Value::object();
  out["done"] = t.done;
  if (t.done) {
    out["target"] = t.target.name;
    for (const auto& [name, a] : angles_of(t)) {
      Value one = value_of(a);
      std::erase_if(one.members(), [](const Value::Member& m) { return m.first == "readings"; });
      out[name] = one;
    }
    if (t.range_determined) {
      out["range_offset"]["present_m"] = t.range_present;
      out["range_offset"]["mean_m"] = t.range_mean;
      out["range_offset"]["sigma_m"] = t.range_sigma;
      out["range_offset"]["value_m"] = t.calibration.range_offset.value;
    }
    if (t.joint.scan_scale.free) {
      out["scan_scale"]["value"] = t.scan_scale;
      out["scan_scale"]["sigma_ppm"] = 1e6 * t.scan_scale_sigma;
    }
  }
  Value& words = out["findings"] = Value::array();
  for (const std::string& f : t.findings) words.push(f);
  return out;
}

Value value_of(const FlatTarget& t) {
  Value out = summary_of(t);
  out["returns"] = t.returns;
  if (!t.done) return out;
  out["rounds"] = t.rounds;
  Value target = Value::object();
  target["name"] = t.target.name;
  target["surveyed"] = t.target.surveyed;
  Value& corners = target["corners"] = Value::array();
  for (const Vector2d& c : t.target.corners) {
    const core::Geodetic g = core::geodetic_of(t.target.frame.to_ecef({c.x(), c.y(), t.target.up(c)}));
    Value one = Value::object();
    one["latitude_deg"] = core::to_degrees(g.latitude);
    one["longitude_deg"] = core::to_degrees(g.longitude);
    one["height_m"] = g.height;
    corners.push(one);
  }
  out["target"] = target;
  for (const auto& [name, a] : angles_of(t)) out[name] = value_of(a);
  for (const Reading& r : t.range_readings) {
    Value one = Value::object();
    one["lines"] = lines_of(r);
    one["value_m"] = r.value;
    one["sigma_m"] = r.sigma;
    out["range_offset"]["readings"].push(one);
  }
  out["jointly"] = joint_of(t);
  Value& lines = out["lines"] = Value::array();
  for (const TargetLine& l : t.lines) lines.push(value_of(l));
  return out;
}

std::string readings_csv(const FlatTarget& t) {
  std::string out = "quantity,first_line,second_line,value,unit,sigma,sigma_unit\n";
  const auto row = [&](const char* name, const Reading& r, double unit, const char* unit_name, double sigma_unit, const char* sigma_name) {
    out += std::string(name) + "," + std::to_string(r.first) + "," + (r.second >= 0 ? std::to_string(r.second) : "") + "," +
           core::format_number(r.value / unit) + "," + unit_name + "," + core::format_number(r.sigma / sigma_unit) + "," + sigma_name +
           "\n";
  };
  for (const auto& [name, a] : angles_of(t))
    for (const Reading& r : a.readings) row(name, r, core::degree, "deg", arc_second, "arcsec");
  for (const Reading& r : t.range_readings) row("range_offset", r, 1.0, "m", 1.0, "m");
  return out;
}

namespace {

constexpr int grey = 4;  // of the palette

/// Edges of one view in plan, displacements `enlarged`.
report::Series edges_in_plan(const FlatTarget& t, const TargetView& v, double enlarged, int colour, const std::string& name) {
  report::Series s{name, {}, {}, {}, report::Mark::line, colour};
  for (size_t k = 0; k < v.sides.size(); ++k) {
    const calib::SideView& side = v.sides[k];
    if (!side.used) continue;
    const Vector2d a = t.target.corners[k], b = t.target.corners[(k + 1) % t.target.sides()], d = (b - a).normalized();
    const Vector2d outward(d.y(), -d.x());
    for (const double at : {-0.45, 0.45}) {
      const double along = at * (b - a).norm();
      const Vector2d p = 0.5 * (a + b) + along * d + enlarged * (side.offset + side.slope * (along - side.at)) * outward;
      s.x.push_back(p.x());
      s.y.push_back(p.y());
    }
    s.x.push_back(std::nan(""));
    s.y.push_back(std::nan(""));
  }
  return s;
}

/// A power of ten, or two or five of it, by which displacements become some metres long.
double enlargement(const FlatTarget& t, bool after) {
  double largest = 1e-3;
  for (const TargetLine& l : t.lines) {
    const TargetView& v = after ? l.after : l.before;
    if (v.seen)
      for (const calib::SideView& s : v.sides)
        if (s.used) largest = std::max(largest, std::abs(s.offset));
  }
  constexpr double shown = 6.0;  // m on the plan
  const double ratio = std::max(1.0, shown / largest), ten = std::pow(10.0, std::floor(std::log10(ratio)));
  return ratio / ten >= 5.0 ? 5.0 * ten : ratio / ten >= 2.0 ? 2.0 * ten : ten;
}

report::Panel plan(const FlatTarget& t, bool after) {
  const double enlarged = enlargement(t, after);
  report::Panel p;
  p.title = std::string(after ? "Edges after" : "Edges before") + ", displacements enlarged " + core::format_number(enlarged) + " times";
  p.x_label = after ? "east (m) " : "east (m)";
  p.y_label = "north (m)";
  p.equal_scale = true;
  report::Series outline{t.target.surveyed ? "surveyed" : "mean", {}, {}, {}, report::Mark::line, grey};
  for (size_t k = 0; k <= t.target.sides(); ++k) {
    outline.x.push_back(t.target.corners[k % t.target.sides()].x());
    outline.y.push_back(t.target.corners[k % t.target.sides()].y());
  }
  p.series.push_back(outline);
  int colour = 0;
  for (const TargetLine& l : t.lines) {
    if (!l.measured) continue;
    if (colour == grey) ++colour;
    p.series.push_back(edges_in_plan(t, after ? l.after : l.before, enlarged, colour++, "line " + std::to_string(l.line)));
  }
  return p;
}

report::Panel readings(const std::string& name, const TargetAngle& a) {
  report::Panel p;
  p.title = name + ": readings less the mean, with their sigmas";
  p.x_label = "reading of " + name;
  p.y_label = "arcsec";
  report::Series mean{"sigma of the mean", {0.5, static_cast<double>(a.readings.size()) + 0.5}, {}, {}, report::Mark::band, grey};
  mean.y.assign(2, a.sigma / arc_second);
  p.series.push_back(mean);
  report::Series dots{"", {}, {}, {}, report::Mark::dots, 0}, bars{"", {}, {}, {}, report::Mark::line, 0};
  for (size_t i = 0; i < a.readings.size(); ++i) {
    const double x = static_cast<double>(i + 1), y = (a.readings[i].value - a.mean) / arc_second, s = a.readings[i].sigma / arc_second;
    dots.x.push_back(x);
    dots.y.push_back(y);
    for (const double end : {y - s, y + s}) {
      bars.x.push_back(x);
      bars.y.push_back(end);
    }
    bars.x.push_back(std::nan(""));
    bars.y.push_back(std::nan(""));
  }
  p.series.push_back(bars);
  p.series.push_back(dots);
  return p;
}

report::Panel displacements(const FlatTarget& t) {
  report::Panel p;
  p.title = "Displacement of the target in each line, before";
  p.x_label = "line";
  p.y_label = "m";
  report::Series along{"along", {}, {}, {}, report::Mark::dots, 0}, across{"across", {}, {}, {}, report::Mark::dots, 1},
      up{"up", {}, {}, {}, report::Mark::dots, 2};
  for (const TargetLine& l : t.lines) {
    if (!l.before.seen) continue;
    constexpr double vague = 0.5;  // m
    const auto add = [&](report::Series& s, double shift, double value) {
      s.x.push_back(l.line + shift);
      s.y.push_back(value);
    };
    constexpr double beside = 0.1;
    add(along, -beside, l.before.displacement.x());
    if (l.before.covariance(1, 1) < vague * vague) add(across, 0.0, l.before.displacement.y());
    add(up, beside, l.before.height);
  }
  p.series = {along, across, up};
  return p;
}

}  // namespace

report::Chart chart_of(const FlatTarget& t) {
  report::Chart c;
  c.title = "Flat target: " + t.target.name;
  if (!t.done) return c;
  c.panels = {displacements(t), plan(t, false), plan(t, true)};
  for (const auto& [name, a] : angles_of(t))
    if (a.determined) c.panels.push_back(readings(name, a));
  c.panel_height = 320;
  return c;
}

}  // namespace swath::calib
