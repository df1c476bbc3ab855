// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/calib/report/made_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "core/config/units.h"

namespace swath::calib {
namespace {

constexpr double arc_second = core::degree / 3600.0, infinite = std::numeric_limits<double>::infinity();
constexpr double start_time = 1.3e9;

class Numbers {
 public:
  double normal(double sigma) { return sigma * std::sqrt(-2.0 * std::log(share())) * std::cos(2.0 * core::pi * share()); }
  double between(double low, double high) { return low + (high - low) * share(); }

 private:
  double share() { return (static_cast<double>(engine_()) + 0.5) / 4294967296.0; }
  std::mt19937 engine_{20240611};
};

struct FlightPlan {
  double heading, height, first;
};
const std::vector<FlightPlan>& plan() {
  static const std::vector<FlightPlan> lines{{31.0, 702, 0},    {211.0, 699, 190}, {121.0, 704, 410},
                                             {301.0, 700, 600}, {31.2, 1098, 860}, {211.1, 1103, 1060}};
  return lines;
}

void estimate(calib::Adjustment& a, calib::Parameter p, double start, double value, double sigma, double apriori) {
  calib::Estimate& e = a.estimates[static_cast<size_t>(p)];
  e.estimated = true;
  e.start = start;
  e.value = value;
  e.apriori = apriori;
  e.sigma = sigma;
  e.formal = 0.93 * sigma;
  e.white = 0.11 * sigma;
  e.jackknife_lines = sigma;
  e.jackknife_planes = 0.81 * sigma;
  e.determined = std::isfinite(apriori) ? 1.0 - std::pow(e.formal / apriori, 2) : 1.0;
}

void add_estimates(calib::Adjustment& a) {
  for (int k = 0; k <= calib::latency; ++k) a.estimates[static_cast<size_t>(k)].parameter = static_cast<calib::Parameter>(k);
  estimate(a, calib::boresight_roll, 0.1 * core::degree, 0.31437 * core::degree, 1.2 * arc_second, infinite);
  estimate(a, calib::boresight_pitch, -0.2 * core::degree, -0.18264 * core::degree, 1.9 * arc_second, infinite);
  estimate(a, calib::boresight_heading, 0.0, 0.44107 * core::degree, 3.4 * arc_second, infinite);
  estimate(a, calib::range_offset, 0.0, -0.1273, 0.0081, 0.5);
  estimate(a, calib::range_scale, 1.0, 1.000031, 21e-6, 50e-6);
  estimate(a, calib::scan_scale, 1.0, 0.999842, 12e-6, 1e-3);
  a.estimates[calib::lever_forward].start = a.estimates[calib::lever_forward].value = 0.12;
  a.correlation = Eigen::MatrixXd::Identity(6, 6);
  Numbers random;
  for (Eigen::Index r = 0; r < 6; ++r)
    for (Eigen::Index c = 0; c < r; ++c) a.correlation(r, c) = a.correlation(c, r) = random.between(-0.4, 0.4);
  a.correlation(3, 4) = a.correlation(4, 3) = -0.91;
  a.formal = a.held = Eigen::MatrixXd::Zero(calib::latency + 1, calib::latency + 1);
  a.held_correlation = Eigen::MatrixXd::Identity(calib::latency + 1, calib::latency + 1);
  for (const calib::Estimate& e : a.estimates) a.formal(e.parameter, e.parameter) = e.formal * e.formal;
  a.calibration.roll.value = a.estimates[calib::boresight_roll].value;
  a.calibration.pitch.value = a.estimates[calib::boresight_pitch].value;
  a.calibration.heading.value = a.estimates[calib::boresight_heading].value;
  a.calibration.lever_arm_scanner[0].value = 0.12;
  a.calibration.range_offset.value = a.estimates[calib::range_offset].value;
  a.calibration.range_scale = a.estimates[calib::range_scale].value;
  a.calibration.scan_scale = a.estimates[calib::scan_scale].value;
}

void add_lines(CalibrationReport& r) {
  for (size_t k = 0; k < plan().size(); ++k) {
    const FlightPlan& p = plan()[k];
    const double first = start_time + p.first, last = first + 38.0 + static_cast<double>(k);
    const int id = static_cast<int>(k) + 1;
    r.lines.push_back({id, k < 4 ? "low " + std::to_string(id) : "high <" + std::to_string(id) + "> & back", p.heading * core::degree,
                       p.height, 61.3 + 0.4 * static_cast<double>(k), (last - first) * 61.3, first, last, 3100000 + 1234 * k});
    r.ties.lines.push_back({id, first, last});
  }
}

void add_planes(CalibrationReport& r, Numbers& random) {
  for (std::uint32_t k = 0; k < 90; ++k) {
    calib::TiePlane p;
    p.kind = k < 2 ? calib::TieKind::target : k < 40 ? calib::TieKind::roof : k < 43 ? calib::TieKind::wall : calib::TieKind::ground;
    p.centre = {random.between(-900, 900), random.between(-900, 900), random.between(0, 20)};
    p.normal = Eigen::Vector3d(random.normal(0.3), random.normal(0.3), 1.0).normalized();
    p.half = {random.between(2, 12), random.between(2, 6)};
    p.roughness = random.between(0.015, 0.03);
    if (p.kind == calib::TieKind::target) {
      p.name = k == 0 ? "hangar" : "apron, south";
      for (int c = 0; c < 4; ++c) p.control.push_back({p.centre, 0.02, p.name + " corner " + std::to_string(c + 1)});
    }
    r.ties.planes.push_back(p);
    r.adjustment.plane_sigma.push_back({random.between(0.004, 0.012), 1e-4, 1e-4});
    for (std::uint32_t line = 0; line < r.ties.lines.size(); ++line) {
      if (random.between(0, 1) < 0.25) continue;
      const calib::TieLine& l = r.ties.lines[line];
      const auto n = static_cast<std::uint32_t>(random.between(40, 200));
      r.ties.groups.push_back({k, line, 0, 0});
      calib::GroupResidual g;
      g.plane = k;
      g.line = line;
      g.returns = n;
      g.time = random.between(l.first, l.last);
      g.angle = random.between(-0.45, 0.45);
      g.range = plan()[line].height / std::cos(g.angle) + random.normal(8);
      g.before = 0.35 * std::sin(g.angle) * (line % 2 ? 1 : -1) + random.normal(0.08);
      g.after = random.normal(0.006);
      g.rms = random.between(0.017, 0.026);
      g.redundancy = random.between(0.6, 0.98);
      g.w = g.after / 0.006;
      g.rejected = random.between(0, 1) < 0.02;
      if (g.rejected) {
        g.after += 0.06;
        g.w = g.after / 0.006;
      }
      r.adjustment.groups.push_back(g);
    }
  }
  r.adjustment.planes = r.ties.planes;
}

void add_corrections(CalibrationReport& r, Numbers& random) {
  for (const calib::TieLine& l : r.ties.lines) {
    calib::LineCorrection c;
    c.line = l.id;
    std::array<double, 6> value{}, step{};
    for (size_t axis = 0; axis < 6; ++axis) {
      value[axis] = random.normal(axis < 3 ? 0.02 : 5 * arc_second);
      step[axis] = random.normal(axis < 3 ? 0.004 : 1.5 * arc_second);
    }
    for (double t = l.first; t <= l.last; t += 9.0) {
      c.time.push_back(t);
      c.value.push_back(value);
      c.sigma.push_back({0.006, 0.006, 0.008, 2 * arc_second, 2 * arc_second, 5 * arc_second});
      c.apriori.push_back({0.02, 0.02, 0.03, 5 * arc_second, 5 * arc_second, 15 * arc_second});
      for (size_t axis = 0; axis < 6; ++axis) value[axis] += step[axis];
    }
    r.adjustment.corrections.push_back(std::move(c));
  }
}

/// A gable of 8 m height over 24 m.
CrossSection gable(const std::vector<ReportedLine>& lines, Numbers& random) {
  CrossSection s{"gable 14, across its ridge", 0.5, {Eigen::Vector2d(500100.0, 5320040.0), Eigen::Vector2d(500124.0, 5320058.0)}, {}, {}};
  for (size_t k = 0; k < lines.size(); ++k) {
    SectionPoints before{lines[k].id, {}, {}}, after{lines[k].id, {}, {}};
    const double shift = (k % 2 ? 1.1 : -0.9) + 0.2 * static_cast<double>(k), lift = 0.1 * static_cast<double>(k % 3);
    for (int n = 0; n < 260; ++n) {
      const double at = random.between(0, 30);
      const auto roof = [](double x) { return 412.0 + std::max(0.0, 8.0 - std::abs(x - 15.0) * 8.0 / 12.0); };
      before.along.push_back(at);
      before.height.push_back(roof(at - shift) + lift + random.normal(0.03));
      after.along.push_back(at);
      after.height.push_back(roof(at) + random.normal(0.03));
    }
    s.before.push_back(std::move(before));
    s.after.push_back(std::move(after));
  }
  return s;
}

LineDifference difference(int a, int b, Numbers& random) {
  const core::Lattice lattice = core::lattice_of(2.0, 500000.0, 5320000.0, 500360.0, 5320180.0);
  LineDifference d{a, b, core::Grid(lattice), core::Grid(lattice)};
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      const size_t k = lattice.at(i, j);
      if (std::hypot(i - 60.0, j - 40.0) < 14.0 || j > 20 + i / 2) continue;  // woods, and where the lines part
      const double across = (j - lattice.ny / 2.0) / lattice.ny;
      d.before.height[k] = static_cast<float>(0.9 * across + random.normal(0.03));
      d.after.height[k] = static_cast<float>(0.012 * across + random.normal(0.012));
      d.before.reason[k] = d.after.reason[k] = core::Void::none;
    }
  return d;
}

/// In the shape of flat_target.json.
core::Value made_flat_target() {
  core::Value t = core::Value::object();
  t["done"] = true;
  const auto reading = [](std::vector<int> lines, const char* value, double v, const char* sigma, double s) {
    core::Value r = core::Value::object();
    r["lines"] = core::Value::array();
    for (const int l : lines) r["lines"].push(l);
    r[value] = v;
    r[sigma] = s;
    return r;
  };
  core::Value& roll = t["roll"];
  roll["determined"] = true;
  roll["present_deg"] = 0.3;
  roll["mean_deg"] = 0.3154875;
  roll["sigma_arcsec"] = 9.0;
  roll["sigma_by_scatter_arcsec"] = 7.5;
  roll["tolerance_arcsec"] = 18.0;
  roll["beyond_tolerance"] = true;
  roll["readings"].push(reading({1, 2}, "value_deg", 0.315, "sigma_arcsec", 12.0));
  roll["readings"].push(reading({1, 4}, "value_deg", 0.316, "sigma_arcsec", 13.5));
  t["heading"]["determined"] = false;
  t["heading"]["present_deg"] = -0.1;
  t["range_offset"]["readings"].push(reading({3}, "value_m", -0.0312, "sigma_m", 0.0125));
  core::Value seen = core::Value::object();
  seen["line"] = 1;
  seen["role"] = "nadir";
  seen["heading_deg"] = 58.25;
  seen["height_m"] = 687.5;
  seen["scan_angle_deg"] = 1.164;
  seen["before"]["pulses"] = 2244;
  seen["before"]["along_m"] = 0.812;
  seen["before"]["across_m"] = -0.533;
  seen["before"]["up_m"] = 0.12;
  seen["after"]["along_m"] = 0.0123;
  seen["after"]["across_m"] = 0.0031;
  seen["after"]["up_m"] = -0.0257;
  seen["along_sigma_m"] = 0.0507;
  seen["across_sigma_m"] = 0.0504;
  seen["up_sigma_m"] = 0.0265;
  t["lines"].push(seen);
  core::Value unseen = core::Value::object();
  unseen["line"] = 2;
  unseen["before"]["seen"] = false;
  unseen["after"]["seen"] = false;
  t["lines"].push(unseen);
  return t;
}

}  // namespace

CalibrationReport made_report(bool refused) {
  CalibrationReport r;
  Numbers random;
  r.survey = "Airfield <north> & town";
  r.crs = "EPSG:32632";
  add_estimates(r.adjustment);
  add_lines(r);
  add_planes(r, random);
  add_corrections(r, random);
  calib::Adjustment& a = r.adjustment;
  a.condition = 184.3;
  a.sigma0 = 1.013;
  a.observations = 58231;
  a.unknowns = 462;
  a.rejected_returns = 817;
  a.iterations = 7;
  a.components = {{"range", 0.02, 1.07, 51234.5, true},
                  {"angle", 3.6 * arc_second, 1.0, 0.8, false},
                  {"trajectory position", 0.021, 0.94, 88.1, true},
                  {"trajectory attitude", 6.1 * arc_second, 1.12, 91.7, true},
                  {"control", 0.02, 1.21, 6.4, true}};
  for (std::uint32_t c = 0; c < 8; ++c) {
    const double residual = c == 5 ? 0.094 : random.normal(0.015);
    a.control.push_back({r.ties.planes[c / 4].control[c % 4].name, c / 4, residual, 0.02, 0.86, residual / 0.0186, c == 5});
  }
  r.checks.push_back({"check 1", 0, 0.013, 0.022, 1.0, 0.59, false});
  r.checks.push_back({"check 2", 0, -0.021, 0.022, 1.0, -0.95, false});
  a.findings.push_back({"apron, south corner 2 disagrees with the flight by 9.4 cm", "check its coordinates and its datum", {}, false});
  if (refused)
    a.findings.push_back({"range offset and range scale cannot be separated: only one flying height",
                          "fly the same lines at twice the height",
                          {calib::range_scale},
                          true});
  r.sections.push_back(gable(r.lines, random));
  for (const auto& [first, second] : {std::pair(1, 2), {1, 3}, {2, 5}}) r.differences.push_back(difference(first, second, random));
  r.readings = {{calib::boresight_roll, 0.31437 * core::degree + 4 * arc_second, 9 * arc_second, 4, "lines 1 and 2, along the wall"},
                {calib::boresight_pitch, -0.18264 * core::degree - 31 * arc_second, 12 * arc_second, 6, "profiles, opposite lines"},
                {calib::scan_offset, 2 * arc_second, 8 * arc_second, 2, ""}};
  r.flat_target = made_flat_target();
  r.notes = {"The start values were found by matching height grids of the lines.", "Planes were extracted anew 2 times."};
  return r;
}

FlatTarget made_target() {
  FlatTarget t;
  t.done = true;
  t.target.name = "hall";
  t.target.frame = trajectory::local_frame({4177000.0, 774000.0, 4710000.0});
  t.target.corners = {{30, 15}, {-30, 15}, {-30, -15}, {30, -15}};
  TargetLine l;
  l.line = 4;
  l.measured = true;
  l.role = TargetRole::edge;
  l.before.seen = l.after.seen = true;
  l.before.displacement = {1.5, -0.5};
  l.before.covariance = l.after.covariance = Eigen::Matrix2d::Identity() * 4e-4;
  for (const double offset : {0.5, 1.5, -0.5, -1.5}) {
    SideView s;
    s.used = true;
    s.offset = offset;
    l.before.sides.push_back(s);
    s.offset = 0.01 * offset;
    l.after.sides.push_back(s);
  }
  t.lines.push_back(l);
  l.line = 5;
  l.measured = l.before.seen = l.after.seen = false;
  l.before.why_not = l.after.why_not = "no returns near the target";
  t.lines.push_back(l);
  t.pitch.determined = t.pitch.beyond = true;
  t.pitch.mean = t.pitch.value = 0.1 * core::degree;
  t.pitch.sigma = t.pitch.own = 2e-5;
  Reading r;
  r.first = 1, r.second = 2;
  r.value = 0.1 * core::degree, r.sigma = 2e-5;
  t.pitch.readings.push_back(r);
  r.second = -1;
  r.value = 0.12, r.sigma = 0.03;
  t.range_determined = true;
  t.range_mean = 0.12;
  t.range_readings.push_back(r);
  t.findings = {"roll is not determined"};
  return t;
}

}  // namespace swath::calib
