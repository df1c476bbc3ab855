// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/contours/contour_surface.h"

#include <gtest/gtest.h>

#include "terrain/contours/contour_lines.h"
#include "tests/terrain/lines.h"
#include "tests/terrain/made.h"

namespace swath::terrain {
namespace {

core::Grid noisy(const test::Surface& truth, double sigma, core::Lattice lattice = {1.0, 0, 0, 140, 130}) {
  core::Grid g = test::sampled(lattice, truth);
  std::mt19937 random(3);
  std::normal_distribution<float> noise(0.0F, static_cast<float>(sigma));
  for (float& h : g.height) h += noise(random);
  return g;
}

double rms_between(const core::Grid& g, const test::Surface& truth, int rim) {
  double sum = 0.0, n = 0.0;
  for (int j = rim; j < g.lattice.ny - rim; ++j)
    for (int i = rim; i < g.lattice.nx - rim; ++i) {
      const double e = static_cast<double>(g.height[g.lattice.at(i, j)]) - truth(g.lattice.centre_x(i), g.lattice.centre_y(j));
      sum += e * e;
      n += 1.0;
    }
  return std::sqrt(sum / n);
}

TEST(ContourSurface, StaysWithinItsShareOfTheTolerance) {
  const core::Grid rough = noisy([](double x, double y) { return 0.1 * x + (y > 60 ? 5.0 : 0.0); }, 0.2);
  for (const double tolerance : {0.02, 0.1, 0.5}) {
    const core::Grid s = contour_surface(rough, tolerance);
    double most = 0.0;
    for (size_t c = 0; c < s.height.size(); ++c)
      most = std::max(most, std::abs(static_cast<double>(s.height[c]) - static_cast<double>(rough.height[c])));
    EXPECT_LE(most, contour_surface_share * tolerance + 1e-5) << tolerance;  // heights of 15 m as floats
    EXPECT_GT(most, 0.7 * tolerance);
  }
  EXPECT_EQ(contour_surface(rough, 0.0).height, rough.height);
}

TEST(ContourSurface, TakesUnevennessOffAnEvenSlopeAndKeepsTheSlope) {
  const test::Surface slope = [](double x, double y) { return 3.0 + 0.04 * x + 0.02 * y; };
  const core::Grid s = contour_surface(noisy(slope, 0.02), 0.1);
  EXPECT_LT(rms_between(s, slope, 0), 0.02 / 3.0);
  // Without noise a plane is left as it is, up to its rim and beside voids.
  core::Grid exact = test::sampled({1.0, 0, 0, 60, 50}, slope);
  for (const auto& [i, j] : {std::pair{20, 20}, {21, 20}, {40, 7}, {59, 49}}) exact.height[exact.lattice.at(i, j)] = std::nanf("");
  const core::Grid kept = contour_surface(exact, 0.1);
  for (size_t c = 0; c < kept.height.size(); ++c) {
    if (std::isnan(exact.height[c])) {
      EXPECT_TRUE(std::isnan(kept.height[c]));
    } else {
      EXPECT_NEAR(kept.height[c], exact.height[c], 1e-5) << c;
    }
  }
}

TEST(ContourSurface, KeepsHillsOfSomeFewCells) {
  // Curvature as steep as 1 / 20 m: a plain mean of the kernel would be 0.5 * 9 / 20 = 0.2 m off.
  const test::Surface hills = [](double x, double y) { return 50.0 + 6.0 * std::sin(x / 11.0) * std::cos(y / 9.0); };
  EXPECT_LT(rms_between(contour_surface(noisy(hills, 0.0), 0.2), hills, 12), 0.02);
}

TEST(ContourSurface, LevelWaterStaysLevel) {
  const core::Grid lake = test::sampled(
      {1.0, 0, 0, 80, 80}, [](double x, double y) { return std::max(100.0, 100.0 + 0.3 * (std::hypot(x - 40.0, y - 40.0) - 25.0)); });
  const core::Grid s = contour_surface(lake, 0.1);
  for (int j = 0; j < 80; ++j)
    for (int i = 0; i < 80; ++i)
      if (std::hypot(i + 0.5 - 40.0, j + 0.5 - 40.0) < 23.0) {
        EXPECT_EQ(s.height[s.lattice.at(i, j)], 100.0F);
      }
}

TEST(ContourSurface, AWindowGivesTheHeightsOfTheWhole) {
  core::Grid whole = noisy([](double x, double y) { return 0.1 * x + 3.0 * std::sin(y / 15.0); }, 0.1, {1.0, 100, 200, 190, 180});
  std::mt19937 random(8);
  for (int n = 0; n < 30; ++n) whole.height[static_cast<size_t>(random() % whole.height.size())] = std::nanf("");
  const double tolerance = 0.1;
  const core::Grid expected = contour_surface(whole, tolerance);
  const int reach = contour_surface_reach(tolerance);
  core::Grid part(core::Lattice{1.0, 120, 230, 2 * reach + 40, 2 * reach + 30});
  const auto at = [&](int i, int j) { return whole.lattice.at(20 + i, 30 + j); };
  for (int j = 0; j < part.lattice.ny; ++j)
    for (int i = 0; i < part.lattice.nx; ++i) part.height[part.lattice.at(i, j)] = whole.height[at(i, j)];
  const core::Grid s = contour_surface(part, tolerance);
  int known = 0;
  for (int j = reach; j < part.lattice.ny - reach; ++j)
    for (int i = reach; i < part.lattice.nx - reach; ++i) {
      const float mine = s.height[part.lattice.at(i, j)], theirs = expected.height[at(i, j)];
      if (std::isnan(theirs)) continue;
      ++known;
      ASSERT_EQ(mine, theirs) << i << " " << j;  // to the last bit
    }
  EXPECT_GT(known, 1100);
}

/// Mean turn of the lines as written, radians per metre: 0 where lines are straight. `traced`: the surface that they are traced on.
double turning(const core::Grid& model, const core::Grid& traced, const ContourOptions& o) {
  double turned = 0.0, metres = 0.0;
  Facets surface = test::facets_of(model);
  for (const ContourLine& l : contour_lines(trace(traced, traced.lattice, o), o, surface).lines) {
    for (size_t k = 2; k < l.vertices.size(); ++k) {
      const Eigen::Vector2d a = l.vertices[k - 1] - l.vertices[k - 2], b = l.vertices[k] - l.vertices[k - 1];
      turned += std::abs(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)));
    }
    metres += length(l.vertices);
  }
  return turned / metres;
}

TEST(ContourSurface, ContoursOfAnEvenSlopeDoNotWander) {
  // 4 % of slope, 1 cm of noise, 2.5 cm of tolerance: on the model itself every line wanders by a quarter of a metre and turns back and
  // forth.
  const core::Grid g = noisy([](double x, double) { return 20.0 + 0.04 * x; }, 0.01);
  ContourOptions o;
  o.interval = core::Metres(0.5);
  const double raw = turning(g, g, o), smooth = turning(g, contour_surface(g, vertical_tolerance(o)), o);
  EXPECT_LT(smooth, raw / 4.0);
  EXPECT_LT(smooth, 0.15);  // 9 deg per metre
  std::cout << "  turning " << raw << " rad/m on the model, " << smooth << " on the smoothed surface\n";
}

}  // namespace
}  // namespace swath::terrain
