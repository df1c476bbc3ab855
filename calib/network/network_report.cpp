// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/network/network_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "calib/adjust/diagnosis.h"
#include "calib/network/doubtful_lines.h"
#include "calib/report_units.h"
#include "core/config/units.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "report/html.h"
#include "trajectory/trajectory.h"

namespace swath::calib {
namespace {

using report::number_text;

constexpr double knot_seconds = 1.0;
constexpr size_t most_points = 2000;  // of a curve
constexpr std::array<const char*, 6> axes{"north", "east", "down", "roll", "pitch", "heading"};
constexpr double unit_of(size_t axis) { return axis < 3 ? centimetre : arc_second; }

std::array<double, 6> sigmas_at(const core::TrajectoryData& t, double time) {
  const core::CovarianceSeries::Matrix9 c = t.covariance.at(time);
  std::array<double, 6> out{};
  for (int i = 0; i < 3; ++i) {
    out[static_cast<size_t>(i)] = std::sqrt(std::max(0.0, c(i, i)));
    out[static_cast<size_t>(i) + 3] = std::sqrt(std::max(0.0, c(i + 6, i + 6)));
  }
  return out;
}

/// What has to be added to one pose to make it the other.
std::array<double, 6> difference(const trajectory::Pose& from, const trajectory::Pose& to) {
  const core::Geodetic g = core::geodetic_of(from.position);
  const Eigen::Matrix3d ned = core::ecef_R_ned(g.latitude, g.longitude);
  const Eigen::Vector3d moved = ned.transpose() * (to.position - from.position);
  const core::Attitude a = core::attitude_of(ned.transpose() * from.ecef_R_body), b = core::attitude_of(ned.transpose() * to.ecef_R_body);
  return {moved.x(), moved.y(), moved.z(), b.roll - a.roll, b.pitch - a.pitch, std::remainder(b.heading - a.heading, 2 * core::pi)};
}

std::vector<LineCorrection> corrections(const AdjustedNetwork& network, const trajectory::Trajectory& before,
                                        const trajectory::Trajectory& after) {
  trajectory::Cursor from(before), to(after);
  std::vector<LineCorrection> out;
  for (const TieLine& line : network.ties.lines) {
    LineCorrection c;
    c.line = line.id;
    const int steps = std::max(1, static_cast<int>(std::ceil((line.last - line.first) / knot_seconds)));
    for (int i = 0; i <= steps; ++i) {
      const double t = line.first + (line.last - line.first) * i / steps;
      if (!from.seek(t) || !to.seek(t)) continue;
      c.time.push_back(t);
      c.value.push_back(difference(from.pose(t), to.pose(t)));
      c.sigma.push_back(sigmas_at(after.data(), t));
      c.apriori.push_back(sigmas_at(before.data(), t));
    }
    out.push_back(std::move(c));
  }
  return out;
}

void put_groups(const AdjustedNetwork& n, Adjustment& a) {
  for (size_t g = 0; g < n.after.size(); ++g) {
    const PlaneMisfit& m = n.after[g];
    GroupResidual r{m.plane, m.line, m.returns, m.time, m.angle, m.range, n.before[g].mean, m.mean, m.rms, 0.0, 0.0, m.weight <= 0.0};
    if (g < n.tests.group.size()) r.redundancy = n.tests.group[g].redundancy, r.w = n.tests.group[g].w;
    a.groups.push_back(r);
    a.rejected_returns += m.rejected;
  }
  for (const ControlTest& c : n.tests.points) a.control.push_back({c.name, c.plane, c.residual, c.sigma, c.redundancy, c.w, false});
}

void put_values(const AdjustedNetwork& n, Adjustment& a) {
  const LimitOptions limits;  // of calib.adjust, as it has them by default
  a.condition = not_known;
  a.calibration = n.calibration;
  for (int p = boresight_roll; p <= latency; ++p) {
    Estimate& e = a.estimates[static_cast<size_t>(p)];
    e.parameter = static_cast<Parameter>(p);
    e.start = e.value = e.found = value_of(n.calibration, e.parameter);
  }
  for (const NetworkValue& v : n.values) {
    Estimate& e = a.estimates[static_cast<size_t>(v.parameter)];
    e.estimated = e.delivered = true;
    e.grade = v.sigma <= limit_of(limits, v.parameter) ? Grade::good : Grade::coarse;
    e.start = v.start, e.apriori = v.apriori;
    e.value = e.found = v.value;
    e.sigma = e.found_sigma = e.formal = v.sigma;
    e.white = e.held = not_known;
    e.determined = std::isfinite(v.apriori) ? 1.0 - v.sigma * v.sigma / (v.apriori * v.apriori) : 1.0;
    if (e.determined < limits.determined) e.grade = Grade::undetermined;
  }
  const Eigen::VectorXd scale = n.covariance.diagonal().cwiseSqrt().cwiseInverse();
  a.correlation = scale.asDiagonal() * n.covariance * scale.asDiagonal();
}

ReportSection kinds_of(const AdjustedNetwork& n) {
  ReportSection s;
  s.heading = "Kinds of observation";
  s.paragraphs = {
      "The residuals of each kind beside what its sigmas predict: 1 where the sigmas are right, above where errors are larger than "
      "stated. Redundancy: degrees of freedom of these residuals; a kind with few of them shows little. IMU and GNSS keep the sigmas that "
      "the smoother gave them; those of ranges, angles and surfaces are listed with the adjustment."};
  report::Table t{"kinds", "Residuals by kind", {{"kind", false}, {"observations"}, {"redundancy"}, {"factor on the sigma"}}, {}, {}};
  for (const NetworkComponent& c : n.components)
    t.rows.push_back({c.words, report::count_text(c.observations), number_text(c.redundancy, 1), number_text(c.factor, 2)});
  s.tables.push_back(std::move(t));
  return s;
}

/// Corrections against what they should be: the variance that an estimate loses by further observations is that of its change.
ReportSection changes_of(const Adjustment& a) {
  ReportSection s;
  s.heading = "What the surfaces changed";
  s.paragraphs = {
      "RMS along each line of what the adjustment moved and turned the smoother's trajectory by, and how large that should be by the "
      "sigmas of both: the variance that surfaces take away is the variance of the change. A correction of more than three times that "
      "says that a line, the smoother's noise or the mounting is not what was stated.",
  };
  report::Table change{"changes", "Change by the surfaces, found and expected", {{"line"}}, {}, {}};
  report::Table sigma{"sigmas", "Mean sigma along each line, smoother and adjustment", {{"line"}}, {}, {}};
  for (size_t k = 0; k < 6; ++k)
    for (report::Table* t : {&change, &sigma}) t->columns.push_back({std::string(axes[k]) + (k < 3 ? " (cm)" : " (arcsec)")});
  for (const LineCorrection& c : a.corrections) {
    if (c.time.empty()) continue;
    for (report::Table* t : {&change, &sigma}) t->rows.push_back({std::to_string(c.line)});
    bool large = false;
    for (size_t k = 0; k < 6; ++k) {
      double found = 0, expected = 0, was = 0, is = 0;
      for (size_t i = 0; i < c.time.size(); ++i) {
        found += c.value[i][k] * c.value[i][k];
        const double before = c.apriori[i][k] * c.apriori[i][k], after = c.sigma[i][k] * c.sigma[i][k];
        expected += std::max(0.0, before - after), was += before, is += after;
      }
      const auto text = [&](double sum) {
        return number_text(std::sqrt(sum / static_cast<double>(c.time.size())) / unit_of(k), k < 3 ? 2 : 1);
      };
      change.rows.back().push_back(text(found) + " / " + text(expected));
      sigma.rows.back().push_back(text(was) + " / " + text(is));
      large = large || found > 9 * std::max(expected, 0.01 * was);
    }
    change.tones.push_back(large ? report::Tone::caution : report::Tone::plain);
  }
  s.tables = {std::move(change), std::move(sigma)};
  return s;
}

ReportSection biases_of(const AdjustedNetwork& n) {
  ReportSection s;
  s.heading = "Biases of the IMU";
  s.paragraphs = {"As the adjustment found them, with one sigma to both sides."};
  report::Chart chart;
  chart.title = "Biases of the IMU";
  chart.panel_height = 150;
  constexpr std::array<const char*, 3> body{"forward", "right", "down"};
  const size_t every = std::max<size_t>(1, n.biases.size() / most_points);
  for (const bool gyro : {true, false})
    for (int axis = 0; axis < 3; ++axis) {
      const double unit = gyro ? core::degree / 3600.0 : 9.80665e-3;
      report::Series value{"", {}, {}, {}, report::Mark::line, 0}, band{"", {}, {}, {}, report::Mark::band, 0};
      for (size_t i = 0; i < n.biases.size(); i += every) {
        const SensorBias& b = n.biases[i];
        const double v = (gyro ? b.gyro : b.force)[axis] / unit, sigma = (gyro ? b.gyro_sigma : b.force_sigma)[axis] / unit;
        value.x.push_back(b.time - n.biases.front().time), value.y.push_back(v);
        band.x.push_back(value.x.back()), band.y.push_back(v - sigma), band.y2.push_back(v + sigma);
      }
      report::Panel p;
      p.x_label = "time since the first record (s)";
      p.y_label = std::string(gyro ? "gyro " : "accelerometer ") + body[static_cast<size_t>(axis)] + (gyro ? " (deg/h)" : " (mg)");
      p.series = {std::move(band), std::move(value)};
      chart.panels.push_back(std::move(p));
    }
  s.figures.push_back({"biases", std::move(chart), "Biases of gyros and accelerometers over the flight."});
  return s;
}

}  // namespace

void put_network(const AdjustedNetwork& network, const trajectory::Trajectory& before, const trajectory::Trajectory& after,
                 CalibrationReport& report) {
  Adjustment& a = report.adjustment;
  put_groups(network, a);
  put_values(network, a);
  a.components = network.sigmas;
  a.planes = network.planes;
  a.plane_sigma = network.tests.plane_sigma;
  a.corrections = corrections(network, before, after);
  a.unknowns = network.unknowns;
  a.iterations = network.iterations;
  a.converged = network.settled;
  double squares = 0.0, redundancy = 0.0;
  for (const NetworkComponent& c : network.components) {
    a.observations += c.observations;
    if (!std::isfinite(c.factor)) continue;
    squares += c.factor * c.factor * c.redundancy;
    redundancy += c.redundancy;
  }
  a.sigma0 = redundancy > 0.0 ? std::sqrt(squares / redundancy) : not_known;
  if (!network.settled)
    a.findings.push_back(
        {"the states still moved when the iterations ended", "raise iterations, or look for lines that do not fit", {}, false});
  for (Finding& f : doubtful_lines(network.ties.lines, a.corrections, a.groups)) a.findings.push_back(std::move(f));
  report.ties = network.ties;
  report.joint = true;
  report.strips = plane_differences(network.ties, a);
  report.sections_of_joint = {kinds_of(network), changes_of(a), biases_of(network)};
  report.notes.push_back("Planes were sought " + core::counted(network.rounds, "time") + "; the last round moved the returns by " +
                         number_text(network.last_move / millimetre, 1) +
                         " mm. A plane seen in one line departs from that of all lines by " +
                         number_text(network.surface_sigma / millimetre, 1) + " mm (sigma).");
}

}  // namespace swath::calib
