// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/block_page.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/config/units.h"
#include "report/chart.h"
#include "report/correlation.h"
#include "report/html.h"
#include "report/page.h"

namespace swath::calib {
namespace {

using Eigen::Vector2d;
using report::count_text;
using report::number_text;

/// One, two or five times a power of ten, not above x.
double round_factor(double x) {
  const double ten = std::pow(10.0, std::floor(std::log10(x)));
  return x / ten >= 5.0 ? 5.0 * ten : x / ten >= 2.0 ? 2.0 * ten : ten;
}

std::string six_digits(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6g", v);
  return text;
}

void add_ellipse(report::Series& s, const Vector2d& at, const Eigen::Matrix2d& C, double factor) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(C);
  const Eigen::Matrix2d axes = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  constexpr int corners = 24;
  for (int k = 0; k <= corners; ++k) {
    const double a = 2.0 * core::pi * k / corners;
    const Vector2d p = at + factor * axes * Vector2d(std::cos(a), std::sin(a));
    s.x.push_back(p.x()), s.y.push_back(p.y());
  }
  s.x.push_back(std::nan("")), s.y.push_back(std::nan(""));
}

report::Chart block_plan(const ReadBlock& read, const BlockSolution& s, const BlockFound& found, double& factor) {
  constexpr size_t shown = 400;  // ellipses
  const ImageBlock& b = read.block;
  report::Series images{"images", {}, {}, {}, report::Mark::dots, 0}, control{"control", {}, {}, {}, report::Mark::dots, 1},
      check{"check points", {}, {}, {}, report::Mark::dots, 2}, ellipses{"ellipses of points", {}, {}, {}, report::Mark::line, 4};
  Vector2d low = b.images[0].position.head<2>(), high = low;
  for (const BlockImage& i : b.images) {
    images.x.push_back(i.position.x()), images.y.push_back(i.position.y());
    low = low.cwiseMin(i.position.head<2>()), high = high.cwiseMax(i.position.head<2>());
  }
  for (const BlockControl& c : b.control) {
    report::Series& to = c.check ? check : control;
    to.x.push_back(c.position.x()), to.y.push_back(c.position.y());
  }
  const double extent = (high - low).norm();
  factor = found.plan > 0.0 ? round_factor(std::max(1.0, 0.012 * extent / found.plan)) : 1.0;
  const size_t step = std::max<size_t>(1, b.points.size() / shown);
  for (size_t p = 0; p < b.points.size(); p += step)
    if (s.linear.point_column[p] >= 0)
      add_ellipse(ellipses, b.points[p].position.head<2>(), s.inference.points[p].topLeftCorner<2, 2>(), factor);
  report::Panel panel;
  panel.title = "Block, error ellipses " + number_text(factor, 0) + " times enlarged";
  panel.x_label = "east (m)", panel.y_label = "north (m)";
  panel.equal_scale = true;
  for (report::Series* one : {&ellipses, &images, &control, &check})
    if (!one->x.empty()) panel.series.push_back(*one);
  report::Chart chart;
  chart.panels.push_back(panel);
  chart.panel_height = 700;
  return chart;
}

/// Mean residuals by cells of the image plane of one camera, as lines.
report::Chart image_residuals(const ReadBlock& read, const BlockSolution& s, std::uint32_t camera, double& factor) {
  constexpr int cells = 12;
  const ImageBlock& b = read.block;
  struct Cell {
    Vector2d sum = Vector2d::Zero();
    double n = 0.0;
  };
  std::vector<Cell> grid(cells * cells);
  double reach = 1e-9;
  for (const ImageRay& r : b.rays)
    if (b.images[r.image].camera == camera) reach = std::max({reach, std::abs(r.x), std::abs(r.y)});
  const auto cell = [&](double v) { return std::clamp(static_cast<int>((v / reach + 1.0) / 2.0 * cells), 0, cells - 1); };
  for (const BlockObservation& o : s.linear.observations) {
    if (o.kind != ObservationKind::ray || s.weights.of_ray[o.index] < 0.5) continue;
    const ImageRay& r = b.rays[o.index];
    if (b.images[r.image].camera != camera) continue;
    Cell& c = grid[static_cast<size_t>(cell(r.y) * cells + cell(r.x))];
    c.sum += Vector2d(s.linear.residual[o.row], s.linear.residual[o.row + 1]) * r.sigma * s.weights.ray;
    c.n += 1.0;
  }
  double largest = 1e-9;
  for (const Cell& c : grid)
    if (c.n > 0.0) largest = std::max(largest, (c.sum / c.n).norm());
  factor = round_factor(1.6 * reach / cells / largest);
  report::Series lines{"mean residuals", {}, {}, {}, report::Mark::line, 0}, roots{"cells", {}, {}, {}, report::Mark::dots, 4};
  for (int row = 0; row < cells; ++row)
    for (int column = 0; column < cells; ++column) {
      const Cell& c = grid[static_cast<size_t>(row * cells + column)];
      if (!(c.n > 0.0)) continue;
      const Vector2d at((2.0 * (column + 0.5) / cells - 1.0) * reach, (2.0 * (row + 0.5) / cells - 1.0) * reach),
          to = at + factor * c.sum / c.n;
      roots.x.push_back(at.x()), roots.y.push_back(at.y());
      for (const Vector2d& p : {at, to}) lines.x.push_back(p.x()), lines.y.push_back(p.y());
      lines.x.push_back(std::nan("")), lines.y.push_back(std::nan(""));
    }
  report::Panel panel;
  panel.title = "Camera " + b.cameras[camera].name + ": mean residuals by cells, " + number_text(factor, 0) + " times enlarged; largest " +
                number_text(1e3 * largest, 2) + " um";
  panel.x_label = "x (mm)", panel.y_label = "y (mm)";
  panel.equal_scale = true;
  panel.series = {lines, roots};
  report::Chart chart;
  chart.panels.push_back(panel);
  chart.panel_height = 600;
  return chart;
}

void add_precision(report::Page& page, const BlockFound& f) {
  page.section("Precision");
  report::Table t;
  t.id = "precision";
  t.columns = {{"", false}, {"value"}};
  const auto row = [&](const char* name, const std::string& value) { t.rows.push_back({name, value}); };
  row("Images, points, image points", count_text(f.images) + ", " + count_text(f.points) + ", " + count_text(f.rays));
  row("Redundancy", number_text(f.redundancy, 0));
  row("sigma0 (1: sigmas and residuals agree)", number_text(f.sigma0, 3));
  row("Residuals of image coordinates, rms (um)", number_text(f.image_rms, 2));
  row("Sigma of points in plan, rms and largest (m)", number_text(f.plan, 4) + ", " + number_text(f.max_plan, 4));
  row("Sigma of heights, rms and largest (m)", number_text(f.height, 4) + ", " + number_text(f.max_height, 4));
  row("Sigma of perspective centres (m)", number_text(f.station_sigma, 4));
  row("Sigma of angles (deg)", number_text(f.angle_sigma, 5));
  if (f.gsd > 0.0) row("Ground sample distance (m)", number_text(f.gsd, 4));
  row("Mean redundancy of an image coordinate", number_text(f.ray_redundancy, 3));
  row("Inner reliability of image coordinates, median and largest (um)", number_text(f.inner, 1) + ", " + number_text(f.max_inner, 1));
  row("Outer reliability, median and largest (m)", number_text(f.outer, 4) + ", " + number_text(f.max_outer, 4));
  page.table(t);
  report::Table k{"factors", "Factors on the stated sigmas", {{"observations", false}, {"factor"}, {"redundancy"}, {"", false}}, {}, {}};
  for (const FactorFound& x : f.factors)
    k.rows.push_back({x.kind, number_text(x.factor, 3), number_text(x.redundancy, 1), x.estimated ? "estimated" : "kept"});
  page.table(k);
}

void add_check_points(report::Page& page, const BlockFound& f) {
  if (f.differences.empty()) return;
  page.section("Control and check points");
  if (!f.check.empty()) {
    report::Table t{"check",
                    "Check points, adjusted less surveyed",
                    {{"coordinate", false}, {"points"}, {"mean (m)"}, {"sd (m)"}, {"rms (m)"}, {"rms (GSD)"}, {"rms over sigma"}},
                    {},
                    {}};
    for (const CheckFound& c : f.check)
      t.rows.push_back({c.coordinate, count_text(c.points), number_text(c.mean, 4), number_text(c.sd, 4), number_text(c.rms, 4),
                        c.gsd > 0.0 ? number_text(c.rms / c.gsd, 2) : "", number_text(c.over_sigma, 2)});
    page.table(t);
  }
  report::Table t{"points", "Points", {{"name", false}, {"use", false}, {"east (m)"}, {"north (m)"}, {"up (m)"}, {"sigma up (m)"}}, {}, {}};
  for (const PointDifference& p : f.differences) {
    const auto cell = [&](size_t k) { return p.known[k] ? number_text(p.difference[static_cast<Eigen::Index>(k)], 4) : std::string(); };
    t.rows.push_back({p.name, p.check ? "check" : "control", cell(0), cell(1), cell(2), number_text(p.sigma.z(), 4)});
  }
  page.table(t);
}

void add_cameras(report::Page& page, const ReadBlock& read, const BlockSolution& s, const BlockFound& f) {
  page.section("Cameras");
  for (std::uint32_t c = 0; c < f.cameras.size(); ++c) {
    const CameraFound& camera = f.cameras[c];
    report::Table t{"camera-" + std::to_string(c + 1),
                    "Camera " + camera.name,
                    {{"value", false}, {"adjusted"}, {"sigma"}, {"unit", false}, {"", false}},
                    {},
                    {}};
    for (const CameraValueFound& v : camera.values)
      t.rows.push_back({v.name, six_digits(v.value), v.held ? "" : six_digits(v.sigma), v.unit,
                        v.held                              ? "held"
                        : std::abs(v.value) > 3.0 * v.sigma ? ""
                                                            : "not significant"});
    page.table(t);
    if (camera.correlated.size() > 1) {
      report::CorrelationChart chart{"Correlation of the values of " + camera.name, camera.correlated, {}};
      for (Eigen::Index i = 0; i < camera.correlation.rows(); ++i)
        for (Eigen::Index j = 0; j < camera.correlation.cols(); ++j) chart.values.push_back(camera.correlation(i, j));
      page.figure_svg(report::svg(chart), "Correlation of the adjusted values");
    }
    double factor = 1.0;
    const report::Chart residuals = image_residuals(read, s, c, factor);
    page.figure_svg(report::svg(residuals),
                    "Mean residuals of image points by cells of the image plane, computed less measured, enlarged " +
                        number_text(factor, 0) + " times. A pattern is distortion that the camera's values do not hold");
  }
}

void add_direct(report::Page& page, const BlockFound& f) {
  if (f.direct.empty()) return;
  page.section("Direct and integrated orientation");
  report::Table t{"direct",
                  "By the trajectory alone, and after the adjustment",
                  {{"component", false},
                   {"unit", false},
                   {"sigma direct"},
                   {"sigma integrated"},
                   {"mean difference"},
                   {"rms difference"},
                   {"rms over sigma"}},
                  {},
                  {}};
  for (const DirectCompared& c : f.direct) {
    const int decimals = c.unit == "m" ? 4 : 5;
    t.rows.push_back({c.component, c.unit, c.is_known ? number_text(c.direct, decimals) : "not known", number_text(c.integrated, decimals),
                      number_text(c.mean, decimals), number_text(c.rms, decimals), c.is_tested ? number_text(c.over_sigma, 2) : ""});
  }
  page.table(t);
  page.paragraph("Integrated less direct; sigmas are medians over the images, with those of lever arm and boresight.");
}

void add_drifts(report::Page& page, const BlockFound& f) {
  if (f.drifts.empty()) return;
  page.section("Shift and drift of stations");
  report::Table t{
      "drifts",
      "Shift at the first station and change to the last",
      {{"strip", false}, {"shift east (m)"}, {"north"}, {"up"}, {"sigma up"}, {"change east (m)"}, {"north"}, {"up"}, {"sigma up"}},
      {},
      {}};
  for (const SetDriftFound& d : f.drifts)
    t.rows.push_back({d.of_strip ? std::to_string(d.strip) : "block", number_text(d.shift.x(), 3), number_text(d.shift.y(), 3),
                      number_text(d.shift.z(), 3), number_text(d.shift_sigma.z(), 3), number_text(d.change.x(), 3),
                      number_text(d.change.y(), 3), number_text(d.change.z(), 3), number_text(d.change_sigma.z(), 3)});
  page.table(t);
}

void add_datum(report::Page& page, const BlockFound& f) {
  if (!f.datum) return;
  const DatumFound& d = *f.datum;
  page.section("Datum of stations against control");
  report::Table t{"datum", "Stations less control", {{"value", false}, {"unit", false}, {"found"}, {"sigma"}}, {}, {}};
  static constexpr std::array<const char*, 3> axes{"east", "north", "up"};
  for (int k = 0; k < 3; ++k)
    t.rows.push_back(
        {std::string("shift ") + axes[static_cast<size_t>(k)], "m", number_text(d.shift[k], 4), number_text(d.shift_sigma[k], 4)});
  if (d.similarity) {
    for (int k = 0; k < 3; ++k)
      t.rows.push_back({std::string("rotation about ") + axes[static_cast<size_t>(k)], "deg", number_text(d.rotation[k] / core::degree, 6),
                        number_text(d.rotation_sigma[k] / core::degree, 6)});
    t.rows.push_back({"scale less 1", "ppm", number_text(1e6 * d.scale, 2), number_text(1e6 * d.scale_sigma, 2)});
  }
  page.table(t);
  page.paragraph("Products are in the datum of control.");
}

void add_suspects(report::Page& page, const BlockFound& f) {
  page.section("Tests");
  page.paragraph(count_text(f.rejected) + " of " + count_text(f.observations) +
                 " observations have a |w| (residual over its own standard deviation) above 3.29, where one in a thousand is expected; " +
                 count_text(f.without_weight) + " image points have no weight.");
  if (f.suspects.empty()) return;
  report::Table t{"suspects", "Largest |w|", {{"observation", false}, {"w"}, {"residual"}, {"unit", false}, {"redundancy"}}, {}, {}};
  for (const SuspectFound& x : f.suspects)
    t.rows.push_back({x.what, number_text(x.w, 2), number_text(x.residual, 3), x.unit, number_text(x.redundancy, 3)});
  page.table(t);
}

}  // namespace

std::string block_page(const ReadBlock& read, const BlockConfig& config, const BlockSolution& s, const BlockFound& f) {
  report::Page page("Block of images", count_text(f.images) + " images, CRS " + config.crs + ", started from " + f.started_from);
  page.banner(f.findings.empty() ? report::Tone::good : report::Tone::caution,
              f.findings.empty() ? "Adjusted: sigmas and residuals agree." : "Adjusted, with notes.");
  if (!f.findings.empty()) page.list(f.findings);
  add_precision(page, f);
  add_check_points(page, f);
  page.section("Plan");
  double factor = 1.0;
  const report::Chart plan = block_plan(read, s, f, factor);
  page.figure_svg(report::svg(plan),
                  "Images, control and points with their standard error ellipses, enlarged " + number_text(factor, 0) + " times");
  add_direct(page, f);
  add_drifts(page, f);
  add_datum(page, f);
  add_cameras(page, read, s, f);
  add_suspects(page, f);
  return page.html();
}

}  // namespace swath::calib
