// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/flat_target_report.h"

#include <cmath>
#include <optional>
#include <utility>

#include "calib/report_units.h"
#include "core/config/result_visitors.h"
#include "core/config/units.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"

namespace swath::calib {
namespace {

using core::Form;
using core::to_degrees;
using Eigen::Vector2d;

constexpr Form target_ratio = core::plain().always(), metres = core::metres().always(), degrees = core::in_degrees().always(),
               arc_seconds = Form{"arcsec"}.always(), millionths = Form{"ppm"}.always();

struct Named {
  const char* name;
  const TargetAngle& angle;
};
std::vector<Named> angles_of(const FlatTarget& t) { return {{"pitch", t.pitch}, {"roll", t.roll}, {"heading", t.heading}}; }

template <class S>
std::optional<S> given(bool holds, S value) {
  return holds ? std::optional<S>(std::move(value)) : std::nullopt;
}

struct TargetReadingRow {
  Reading of;
  bool is_angle = true;
};

template <class V>
void describe(const TargetReadingRow& r, V& v) {
  const std::vector<int> both{r.of.first, r.of.second};
  v.result("lines", r.of.second >= 0 ? both : std::vector<int>{r.of.first}, "Numbers of the lines.");
  v.result("value_deg", to_degrees(r.of.value), degrees.only_if(r.is_angle), "Boresight angle that the lines show.");
  v.result("sigma_arcsec", r.of.sigma / arc_second, arc_seconds.only_if(r.is_angle), "Its standard deviation.");
  v.result("value_m", r.of.value, metres.only_if(!r.is_angle), "Range offset that the lines show.");
  v.result("sigma_m", r.of.sigma, metres.only_if(!r.is_angle), "Its standard deviation.");
}

std::vector<TargetReadingRow> rows_of(const std::vector<Reading>& readings, bool are_angles) {
  std::vector<TargetReadingRow> out;
  for (const Reading& r : readings) out.push_back({r, are_angles});
  return out;
}

struct AngleInDetail {
  TargetAngle of;
};

template <class V>
void describe(const AngleInDetail& r, V& v) {
  describe(r.of, v);
  v.tables_if(r.of.determined, "readings", rows_of(r.of.readings, true), "Readings by pairs of lines.");
}

struct RangeOffset {
  bool is_known = false;
  double present = 0.0, mean = 0.0, sigma = 0.0, value = 0.0;
};

template <class V>
void describe(const RangeOffset& r, V& v) {
  const Form m = metres.only_if(r.is_known);
  v.result("present_m", r.present, m, "Range offset in force.");
  v.result("mean_m", r.mean, m, "Mean of the readings.");
  v.result("sigma_m", r.sigma, m.in_summary(), "Standard deviation of the mean.");
  v.result("value_m", r.value, m.in_summary(), "New range offset: the mean where it is beyond the tolerance.");
}

RangeOffset range_offset_of(const FlatTarget& t) {
  return {t.range_determined, t.range_present, t.range_mean, t.range_sigma, t.calibration.range_offset.value};
}

struct RangeInDetail {
  RangeOffset mean;
  std::vector<Reading> readings;
};

template <class V>
void describe(const RangeInDetail& r, V& v) {
  describe(r.mean, v);
  v.tables_if(!r.readings.empty(), "readings", rows_of(r.readings, false), "Readings by line.");
}

struct ScanScale {
  double value = 1.0, sigma = 0.0;
};

template <class V>
void describe(const ScanScale& r, V& v) {
  v.result("value", r.value, target_ratio, "Scale of the scan angles.");
  v.result("sigma_ppm", 1e6 * r.sigma, millionths, "Its standard deviation.");
}

std::optional<ScanScale> scan_scale_of(const FlatTarget& t) {
  return given(t.done && t.joint.scan_scale.free, ScanScale{t.scan_scale, t.scan_scale_sigma});
}

struct Estimated {
  double value = 0.0, sigma = 0.0;
  bool is_angle = true;
};

template <class V>
void describe(const Estimated& r, V& v) {
  v.result("value_deg", to_degrees(r.value), degrees.only_if(r.is_angle), "Boresight angle.");
  v.result("sigma_arcsec", r.sigma / arc_second, arc_seconds.only_if(r.is_angle), "Its standard deviation.");
  v.result("value_m", r.value, metres.only_if(!r.is_angle), "Length.");
  v.result("sigma_m", r.sigma, metres.only_if(!r.is_angle), "Its standard deviation.");
}

struct Jointly {
  FlatTarget of;
};

template <class V>
void describe(const Jointly& r, V& v) {
  const JointTarget& j = r.of.joint;
  // What was left after the last round, on top of what the rounds have found.
  const auto angle = [](const JointTarget::One& one, core::Radians measured) {
    return given(one.free, Estimated{measured.value - one.value, one.sigma});
  };
  const auto arm = [](const JointTarget::One& one) { return given(one.free, Estimated{-one.value, one.sigma, false}); };
  v.table("roll", angle(j.roll, r.of.measured.roll), "Boresight roll.");
  v.table("pitch", angle(j.pitch, r.of.measured.pitch), "Boresight pitch.");
  v.table("heading", angle(j.heading, r.of.measured.heading), "Boresight heading.");
  v.table("datum_east", Estimated{j.datum.x(), j.datum_sigma.x(), false}, "Shift common to all lines.");
  v.table("datum_north", Estimated{j.datum.y(), j.datum_sigma.y(), false}, "Shift common to all lines.");
  v.table("lever_arm_forward_correction", arm(j.lever_forward), "To be added to the lever arm.");
  v.table("lever_arm_right_correction", arm(j.lever_right), "To be added to the lever arm.");
  v.result("lowest_height_m", j.lowest, metres, "Lowest flying height above the target.");
  v.result("highest_height_m", j.highest, metres, "Highest flying height above the target.");
  v.result("chi2", j.chi2, target_ratio, "Chi-square per degree of freedom.");
}

struct Corner {
  core::Geodetic at;
};

template <class V>
void describe(const Corner& r, V& v) {
  v.result("latitude_deg", to_degrees(r.at.latitude), core::in_degrees(9), "Latitude.");
  v.result("longitude_deg", to_degrees(r.at.longitude), core::in_degrees(9), "Longitude.");
  v.result("height_m", r.at.height, core::metres(), "Ellipsoidal height.");
}

/// What flat_target.json holds.
struct Details {
  const FlatTarget& of;
};

template <class V>
void describe(const Details& r, V& v) {
  const FlatTarget& t = r.of;
  v.result("done", t.done, "True: the target was found and seen.");
  v.table("target", given(t.done, t.target), "The target.");
  for (const auto& [name, a] : angles_of(t)) v.table(name, given(t.done, AngleInDetail{a}), "Boresight angle.");
  v.table("range_offset",
          given(t.done && (t.range_determined || !t.range_readings.empty()), RangeInDetail{range_offset_of(t), t.range_readings}),
          "Range offset.");
  v.table("scan_scale", scan_scale_of(t), "Scale of the scan angles by widths and places of the target.");
  v.result("findings", t.findings, "What is not determined or looks wrong, as sentences that end with what to do.");
  v.result("notes", t.notes, "What is right, or was allowed for, as sentences.");
  v.result("returns", t.returns, "Returns read.");
  v.result("rounds", t.rounds, core::plain().only_if(t.done), "Rounds of measuring and correcting.");
  v.table("jointly", given(t.done, Jointly{t}), "All parameters at once, by least squares.");
  v.tables_if(t.done, "lines", t.lines, "The target in each line.");
}

}  // namespace

template <class V>
void describe(const TargetAngle& a, V& v) {
  const Form deg = degrees.only_if(a.determined), arcsec = arc_seconds.only_if(a.determined), known = core::plain().only_if(a.determined);
  v.result("determined", a.determined, core::plain().in_summary(), "True: lines show it.");
  v.result("present_deg", to_degrees(a.present), degrees, "Angle in force.");
  v.result("value_deg", to_degrees(a.value), degrees.in_summary(), "New angle: the mean where it is beyond the tolerance.");
  v.result("mean_deg", to_degrees(a.mean), deg, "Mean of the readings.");
  v.result("sigma_arcsec", a.sigma / arc_second, arcsec.in_summary(), "Standard deviation of the mean.");
  v.result("sigma_of_readings_arcsec", a.own / arc_second, arcsec, "The same by the readings' own covariance.");
  v.result("sigma_by_scatter_arcsec", a.scatter / arc_second, arcsec.only_if(a.determined && a.scatter > 0.0),
           "The same by their scatter.");
  v.result("tolerance_arcsec", a.tolerance / arc_second, arcsec, "Difference up to which the angle in force is kept.");
  v.result("beyond_tolerance", a.beyond, known, "True: the angle is replaced.");
  v.result("by_two_heights", true, core::plain().only_if(a.determined && a.of_two_heights), "Angle and lever arm were separated.");
}

template <class V>
void describe(const SideView& r, V& v) {
  const Form m = metres.only_if(r.used);
  v.result("seen", r.used, "True: pulses on and off the roof show it.");
  v.result("outward_m", r.offset, m, "Distance from its surveyed or mean place.");
  v.result("sigma_m", std::sqrt(r.covariance(0, 0)), m, "Standard deviation of this distance.");
  v.result("pulses", r.pulses, core::plain().only_if(r.used), "Pulses that show it.");
}

template <class V>
void describe(const TargetView& s, V& v) {
  const Form n = core::plain().only_if(s.seen), m = metres.only_if(s.seen), number = target_ratio.only_if(s.seen),
             in_ppm = millionths.only_if(s.seen);
  v.result("seen", s.seen, "True: the line sees the target.");
  v.result("why_not", s.why_not, core::plain().only_if(!s.seen && !s.why_not.empty()), "Why it does not.");
  v.result("pulses", s.pulses, n, "Pulses near the target.");
  v.result("on_roof", s.on_roof, n, "Of them on the roof.");
  v.result("along_m", s.displacement.x(), m, "Displacement of the target along the flight.");
  v.result("along_sigma_of_returns_m", std::sqrt(s.covariance(0, 0)), m, "Its standard deviation by the returns alone.");
  v.result("across_m", s.displacement.y(), m, "Displacement to the right.");
  v.result("across_sigma_of_returns_m", std::sqrt(s.covariance(1, 1)), m, "Its standard deviation by the returns alone.");
  v.result("up_m", s.height, m, "Height above the surveyed or mean plane.");
  v.result("up_sigma_of_returns_m", s.height_sigma, m, "Its standard deviation by the returns alone.");
  v.result("tilt_along", s.tilt_along, number, "Upward slope along the flight.");
  v.result("tilt_across", s.tilt_across, number, "Upward slope to the right.");
  v.result("shear_deg", to_degrees(s.shear), degrees.only_if(s.seen), "Turn of the edges across the flight.");
  v.result("longer_ppm", 1e6 * s.strain_along, in_ppm, "Growth along the flight.");
  v.result("longer_sigma_ppm", 1e6 * s.strain_along_sigma, in_ppm, "Its standard deviation.");
  v.result("wider_ppm", 1e6 * s.strain_across, in_ppm, "Growth across the flight.");
  v.result("wider_sigma_ppm", 1e6 * s.strain_across_sigma, in_ppm, "Its standard deviation.");
  v.result("growth_at_edges_m", s.growth, m, "Growth outward at every edge.");
  v.result("blur_at_edges_m", s.blur, m, "Standard deviation of a pulse's place across an edge.");
  v.result("half_footprint_m", s.half_footprint, m, "Half the band with returns on and off the roof.");
  v.result("roughness_m", s.roughness, m, "RMS of the roof's returns about their plane.");
  v.result("chi2", s.chi2, number, "Chi-square per degree of freedom of the edges' fit.");
  v.tables_if(s.seen, "edges", s.sides, "Edges in the order of the corners.");
}

template <class V>
void describe(const TargetLine& l, V& v) {
  const Form m = metres.only_if(l.measured), deg = degrees.only_if(l.measured), used = core::plain().only_if(l.measured);
  v.result("line", l.line, "Number of the line.");
  v.result("takes_part", l.measured, "True: the line is part of the readings.");
  v.result("kept_one_pulse_in", l.kept_one_in, core::plain().only_if(l.kept_one_in > 1), "Pulses were thinned by this.");
  v.result("role", name_of(l.role), used, "Where the line has the target in its swath.");
  v.result("heading_deg", to_degrees(core::wrap_two_pi(l.after.heading)), deg, "Heading of the aircraft.");
  v.result("height_m", l.target.z(), m, "Height of the scanner above the target.");
  v.result("target_to_the_right_m", l.target.y(), m, "Distance of the target from the scanner to the right.");
  v.result("scan_angle_deg", to_degrees(l.scan_angle), deg, "Scan angle of the target.");
  v.result("along_sigma_m", l.sigma.x(), m, "Standard deviation of `before` along the flight.");
  v.result("across_sigma_m", l.sigma.y(), m, "The same to the right.");
  v.result("up_sigma_m", l.sigma.z(), m, "The same in height.");
  v.table("before", l.before, "The target with the calibration in force.");
  v.table("after", l.after, "The target with what was found.");
}

template <class V>
void describe(const RoofTarget& r, V& v) {
  std::vector<Corner> corners;
  for (const Vector2d& c : r.corners) corners.push_back({core::geodetic_of(r.frame.to_ecef({c.x(), c.y(), r.up(c)}))});
  v.result("name", r.name, "Name of the target.");
  v.result("surveyed", r.surveyed, "False: it was found in the data, and is the mean of the lines.");
  v.tables("corners", corners, "Corners, counter-clockwise.");
}

void describe(const FlatTarget& t, core::ResultVisitor& v) {
  v.result("done", t.done, "True: the target was found and seen.");
  v.result("target", t.target.name, core::plain().only_if(t.done), "Name of the target.");
  for (const auto& [name, a] : angles_of(t)) v.table(name, given(t.done, a), "Boresight angle.");
  v.table("range_offset", given(t.done && t.range_determined, range_offset_of(t)), "Range offset.");
  v.table("scan_scale", scan_scale_of(t), "Scale of the scan angles by widths and places of the target.");
  v.result("findings", t.findings, core::plain().in_summary(),
           "What is not determined or looks wrong, as sentences that end with what to do.");
  v.result("notes", t.notes, "What is right, or was allowed for, as sentences.");
}

core::Value value_of(const FlatTarget& t) { return core::reported(Details{t}); }

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

std::vector<TargetReading> readings_in(const core::Value& tree) {
  std::vector<TargetReading> out;
  for (const auto& [key, parameter] :
       {std::pair{"roll", georef::boresight_roll}, {"pitch", georef::boresight_pitch}, {"heading", georef::boresight_heading}}) {
    const core::Value* angle = tree.find(key);
    const core::Value* mean = angle ? angle->find("mean_deg") : nullptr;
    if (!mean) continue;
    out.push_back({parameter,
                   mean->as_number() * core::degree,
                   angle->find("sigma_arcsec")->as_number() * arc_second,
                   angle->find("readings")->items().size(),
                   {}});
  }
  if (const core::Value* range = tree.find("range_offset"))
    out.push_back({georef::range_offset, range->find("mean_m")->as_number(), range->find("sigma_m")->as_number(), 1, {}});
  if (const core::Value* scale = tree.find("scan_scale"))
    out.push_back({georef::scan_scale, scale->find("value")->as_number(), 1e-6 * scale->find("sigma_ppm")->as_number(), 1, {}});
  return out;
}

}  // namespace swath::calib
