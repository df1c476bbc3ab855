// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/contours/contour_shape.h"

#include <gtest/gtest.h>

#include <numeric>

#include "terrain/contours/contour_surface.h"
#include "tests/terrain/lines.h"
#include "tests/terrain/made.h"

namespace swath::terrain {
namespace {

ContourOptions every(double interval, std::optional<double> tolerance = std::nullopt) {
  ContourOptions o;
  o.interval = core::Metres(interval);
  if (tolerance) o.tolerance = core::Metres(*tolerance);
  return o;
}

std::vector<Segment> traced(const core::Grid& g, const ContourOptions& o) {
  return trace(contour_surface(g, vertical_tolerance(o)), g.lattice, o);
}

std::vector<ContourLine> lines_of(const core::Grid& g, const ContourOptions& o) {
  Facets f = test::facets_of(g);
  return contour_lines(traced(g, o), o, f).lines;
}

double rms_against(const std::vector<ContourLine>& lines, const test::Surface& truth) {
  double sum = 0.0;
  size_t n = 0;
  for (const ContourLine& l : lines)
    for (const auto& v : l.vertices) {
      const double e = truth(v.x(), v.y()) - l.height;
      sum += e * e;
      ++n;
    }
  return std::sqrt(sum / static_cast<double>(n));
}

double rms_of_cells(const core::Grid& g, const test::Surface& truth) {
  double sum = 0.0;
  for (int j = 0; j < g.lattice.ny; ++j)
    for (int i = 0; i < g.lattice.nx; ++i) {
      const double e = g.height[g.lattice.at(i, j)] - truth(g.lattice.centre_x(i), g.lattice.centre_y(j));
      sum += e * e;
    }
  return std::sqrt(sum / static_cast<double>(g.lattice.size()));
}

double largest_turn(const std::vector<ContourLine>& lines) {
  std::vector<double> turns;
  for (const ContourLine& l : lines)
    for (size_t k = 2; k < l.vertices.size(); ++k) {
      const Eigen::Vector2d a = l.vertices[k - 1] - l.vertices[k - 2], b = l.vertices[k] - l.vertices[k - 1];
      turns.push_back(std::abs(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b))));
    }
  std::sort(turns.begin(), turns.end());
  return turns.empty() ? 0.0 : turns[turns.size() * 95 / 100];
}

const test::Surface cone = [](double x, double y) { return 40.0 - 0.4 * std::hypot(x - 60.3, y - 59.6); };
const test::Surface paraboloid = [](double x, double y) { return 0.004 * ((x - 60.3) * (x - 60.3) + (y - 59.6) * (y - 59.6)); };
const test::Surface saddle = [](double x, double y) { return 20.0 + 0.006 * ((x - 60.25) * (x - 60.25) - (y - 59.75) * (y - 59.75)); };
const test::Surface plane = [](double x, double y) { return 3.0 + 0.11 * x + 0.07 * y; };
const test::Surface hills = [](double x, double y) { return 50.0 + 6.0 * std::sin(x / 11.0) * std::cos(y / 9.0) + 0.02 * x; };

/// White noise of the cells: what a model of raw points has at worst.
core::Grid noisy(const test::Surface& truth, double sigma, unsigned seed) {
  core::Grid g = test::sampled({1.0, 0, 0, 120, 120}, truth);
  std::mt19937 random(seed);
  std::normal_distribution<float> noise(0.0f, static_cast<float>(sigma));
  for (float& h : g.height) h += noise(random);
  return g;
}

TEST(ContourShape, NothingMeetsOnAnyTerrain) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> whole(0, 4);
  core::Grid steps = test::sampled({1.0, 4600000, 500000, 90, 90}, [&](double, double) { return 0.5 * whole(random); });  // saddles, ties
  core::Grid holed = noisy(hills, 0.3, 9);
  for (int n = 0; n < 60; ++n) holed.height[static_cast<size_t>(random() % holed.height.size())] = std::nanf("");
  core::Grid cliff = noisy([](double x, double y) { return (x > 60.0 + 5.0 * std::sin(y / 7.0) ? 30.0 : 0.0) + 0.05 * x; }, 0.05, 4);
  struct Case {
    const char* name;
    core::Grid grid;
    double interval, tolerance;
  };
  for (const Case& c :
       {Case{"steps", steps, 1.0, 0.25}, Case{"steps", steps, 0.5, 0.05}, Case{"holed hills", holed, 0.5, 0.125},
        Case{"cliff", cliff, 1.0, 0.25}, Case{"flat with noise", noisy([](double x, double) { return 0.004 * x; }, 0.1, 3), 0.2, 0.05},
        Case{"cone", noisy(cone, 0.0, 1), 0.5, 0.1}, Case{"saddle", noisy(saddle, 0.02, 1), 0.5, 0.1}}) {
    const auto raw = join(traced(c.grid, every(c.interval, c.tolerance)), every(c.interval));
    EXPECT_EQ(test::meetings(raw, 2.0), 0u) << c.name << " as traced";
    const auto lines = lines_of(c.grid, every(c.interval, c.tolerance));
    EXPECT_GT(lines.size(), 3u);
    EXPECT_EQ(test::meetings(lines, 2.0), 0u) << c.name;
    Facets f = test::facets_of(c.grid);
    // Vertices squeezed off a node leave the surface by up to 1e-4 of the edge's rise.
    double rise = 0.0;
    for (int j = 0; j < c.grid.lattice.ny; ++j)
      for (int i = 1; i < c.grid.lattice.nx; ++i) {
        const double d = std::abs(c.grid.height[c.grid.lattice.at(i, j)] - c.grid.height[c.grid.lattice.at(i - 1, j)]);
        if (d > rise) rise = d;
      }
    EXPECT_LE(test::farthest_from(f, raw, 4), contour_surface_share * c.tolerance + 2e-4 * rise + 1e-5) << c.name;
    EXPECT_LE(test::farthest_from(f, lines, 20), c.tolerance + 2e-4 * rise + 1e-9) << c.name;
    ASSERT_EQ(raw.size(), lines.size()) << c.name;
    for (size_t k = 0; k < raw.size(); ++k) {
      EXPECT_EQ(raw[k].closed, lines[k].closed);
      if (raw[k].closed) {
        EXPECT_GT(signed_area(raw[k].vertices) * signed_area(lines[k].vertices), 0.0) << c.name << " " << k;
      } else {
        EXPECT_EQ(raw[k].vertices.front(), lines[k].vertices.front());
        EXPECT_EQ(raw[k].vertices.back(), lines[k].vertices.back());
      }
    }
  }
}

TEST(ContourShape, VerticesAreNoWorseThanTheGrid) {
  for (const double sigma : {0.01, 0.03, 0.1})
    for (const auto* truth : {&cone, &paraboloid, &saddle, &plane, &hills}) {
      const core::Grid g = noisy(*truth, sigma, 11);
      const double cells = rms_of_cells(g, *truth), vertices = rms_against(lines_of(g, every(1.0)), *truth);
      EXPECT_LE(vertices, cells) << "sigma " << sigma;
    }
}

TEST(ContourShape, AnalyticTerrainKeepsItsContours) {
  // Without noise what is left is interpolation (cell^2 / 8 of the curvature), simplification (a twentieth of a cell times the slope, at
  // most) and smoothing, each far below the tolerance of 0.05 m.
  constexpr double bound = 0.02;
  for (const auto* truth : {&cone, &paraboloid, &saddle, &plane, &hills}) {
    const auto lines = lines_of(test::sampled({1.0, 0, 0, 120, 120}, *truth), every(1.0));
    EXPECT_LE(rms_against(lines, *truth), bound);
  }
  // Contours of a plane are straight: two vertices where nothing ends them but the longest segment allowed.
  for (const ContourLine& l : lines_of(test::sampled({1.0, 0, 0, 120, 120}, plane), every(1.0)))
    EXPECT_LE(static_cast<double>(l.vertices.size()), 2.0 + length(l.vertices) / 16.0);
}

TEST(ContourShape, LinesBecomeSmoothAndShort) {
  const core::Grid g = noisy(hills, 0.03, 2);
  const auto raw = lines_of(g, every(1.0, 0.0)), smooth = lines_of(g, every(1.0));
  const auto sum = [](const std::vector<ContourLine>& lines) {
    return std::accumulate(lines.begin(), lines.end(), size_t{0}, [](size_t n, const ContourLine& l) { return n + l.vertices.size(); });
  };
  EXPECT_LT(sum(smooth), sum(raw) / 2);
  EXPECT_LT(largest_turn(smooth), 30.0 * core::degree);
  std::cout << "  95 % of the turns below " << core::to_degrees(largest_turn(raw)) << " deg as traced, "
            << core::to_degrees(largest_turn(smooth)) << " deg smoothed; vertices " << sum(raw) << " and " << sum(smooth) << "\n";
}

TEST(ContourShape, ToleranceZeroChangesNothing) {
  const core::Grid g = noisy(hills, 0.1, 2);
  const auto raw = join(trace(g, g.lattice, every(1.0)), every(1.0)), kept = lines_of(g, every(1.0, 0.0));
  ASSERT_EQ(raw.size(), kept.size());
  for (size_t k = 0; k < raw.size(); ++k) EXPECT_EQ(raw[k].vertices, kept[k].vertices);
}

}  // namespace
}  // namespace swath::terrain
