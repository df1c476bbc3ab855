// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/corridor/clearance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/config/units.h"
#include "tests/world/power_line.h"

namespace swath::terrain {
namespace {

struct Looked {
  test::PowerLineScene scene;
  std::vector<Obstacle> obstacles;
  PowerLines lines;
};

Looked look(const test::LineOfWires& o) {
  Looked out{test::make_power_line(o), {}, {}};
  std::vector<WirePoint> wires;
  std::vector<TowerPoint> towers;
  const core::Block& b = out.scene.block;
  for (size_t p = 0; p < b.size(); ++p) {
    const std::uint8_t t = out.scene.truth[p];
    if (t == core::point_class::wire) wires.push_back({b.x[p], b.y[p], b.z[p], b.strip[p]});
    if (t == test::tower_class) towers.push_back({b.x[p], b.y[p], b.z[p]});
    if (t == core::point_class::ground) out.obstacles.push_back({b.x[p], b.y[p], b.z[p], Hazard::ground});
    if (t == core::point_class::high_vegetation) out.obstacles.push_back({b.x[p], b.y[p], b.z[p], Hazard::vegetation});
  }
  out.lines = find_power_lines(wires, towers);
  return out;
}

const Clearance* of_kind(const ConductorClearances& c, Hazard kind) {
  const auto at = std::find_if(c.smallest.begin(), c.smallest.end(), [&](const Clearance& k) { return k.kind == kind; });
  return at == c.smallest.end() ? nullptr : &*at;
}

const test::TrueWire* true_wire(const Looked& l, const Conductor& c) {
  for (const test::TrueWire& w : l.scene.wires) {
    const Eigen::Vector3d m = w.at(0.5 * w.length);
    const double s = c.strand.line.s(m.head<2>());
    if (s > c.first.s && s < c.last.s && (c.strand.at(s) - m).norm() < 0.4) return &w;
  }
  return nullptr;
}

double lowest_over_ground(const Looked& l, const test::TrueWire& w) {
  double out = 1e300;
  for (double u = 0.0; u <= w.length; u += 0.1) {
    const Eigen::Vector3d p = w.at(u);
    out = std::min(out, p.z() - l.scene.terrain(p.x(), p.y()));
  }
  return out;
}

TEST(Clearance, ToTheGroundIsTrueToFiveCentimetresAndSoIsItsSigma) {
  double squares = 0.0, ratios = 0.0, n = 0.0;
  test::LineOfWires o;
  o.trees = false;
  for (o.seed = 1; o.seed <= 10; ++o.seed) {
    const Looked l = look(o);
    const Obstacles obstacles(l.obstacles);
    for (size_t k = 0; k < l.lines.conductors.size(); ++k) {
      const test::TrueWire* w = true_wire(l, l.lines.conductors[k]);
      const ConductorClearances c = clearances_of(l.lines, k, obstacles, {});
      ASSERT_TRUE(w && of_kind(c, Hazard::ground));
      const double error = of_kind(c, Hazard::ground)->at_rest - lowest_over_ground(l, *w);
      squares += error * error, ratios += std::pow(error / of_kind(c, Hazard::ground)->sigma, 2), ++n;
    }
  }
  EXPECT_EQ(n, 90.0);
  EXPECT_LE(std::sqrt(squares / n), 0.05);
  EXPECT_NEAR(std::sqrt(ratios / n), 1.0, 0.15);
}

TEST(Clearance, ToOtherWiresIsThatOfTheTrueOnes) {
  test::LineOfWires o;
  o.trees = false;
  const Looked l = look(o);
  const Obstacles none({});
  for (size_t k = 0; k < l.lines.conductors.size(); ++k) {
    const test::TrueWire* w = true_wire(l, l.lines.conductors[k]);
    ASSERT_TRUE(w);
    double truth = 1e300;
    for (const test::TrueWire& other : l.scene.wires)
      for (double u = 0.0; u <= w->length && &other != w && other.span == w->span; u += 0.5)
        for (double v = std::max(0.0, u - 3.0); v <= std::min(other.length, u + 3.0); v += 0.1)
          truth = std::min(truth, (w->at(u) - other.at(v)).norm());
    const ConductorClearances c = clearances_of(l.lines, k, none, {});
    ASSERT_EQ(c.smallest.size(), 1u);  // there is no ground
    EXPECT_NEAR(c.smallest[0].at_rest, truth, 5 * c.smallest[0].sigma);
    EXPECT_LT(c.smallest[0].swung, c.smallest[0].at_rest);
  }
}

/// A wire of 100 m, exact, sag 2.5 m, 20 m high at its ends.
PowerLines one_wire() {
  PowerLines lines;
  Conductor c;
  c.strand.line = {{0.0, 0.0}, {1.0, 0.0}};
  c.strand.fit.curve = {50.0, 17.5, 0.0, 1.0 / 500.4};
  c.strand.fit.found = true;
  c.first.s = 0.0, c.last.s = 100.0;
  lines.conductors.push_back(c);
  lines.spans.push_back({{0}, c.strand.line, 0.0, 100.0, {}, {}});
  return lines;
}

TEST(Clearance, ASwungWireComesNearerBesideAndNotBelow) {
  const PowerLines lines = one_wire();
  ClearanceOptions o;
  o.limit = {6.0, 2.5, 5.0, 1.15};
  o.swing = core::pi / 6;
  const double d = lines.conductors[0].chord(50.0) - 17.5;  // the sag
  // At the height and 4 m beside: swung by 30 degrees the wire comes d sin 30 nearer, and rises by d (1 - cos 30).
  const std::vector<Obstacle> beside{{50.0, 4.0, 17.5, Hazard::vegetation}};
  const ConductorClearances c = clearances_of(lines, 0, Obstacles(beside), o);
  const Clearance* v = of_kind(c, Hazard::vegetation);
  ASSERT_TRUE(v);
  EXPECT_NEAR(v->at_rest, 4.0, 1e-6);
  EXPECT_NEAR(v->swung, std::hypot(4.0 - d * 0.5, d * (1.0 - std::cos(o.swing))), 1e-6);
  EXPECT_TRUE(v->is_kept());
  EXPECT_TRUE(c.infringements.empty());
  // Straight below: it only rises.
  const std::vector<Obstacle> below{{50.0, 0.0, 15.5, Hazard::building}};
  const ConductorClearances b = clearances_of(lines, 0, Obstacles(below), o);
  ASSERT_TRUE(of_kind(b, Hazard::building));
  EXPECT_NEAR(of_kind(b, Hazard::building)->swung, 2.0, 1e-6);
  EXPECT_FALSE(of_kind(b, Hazard::building)->is_kept());
  ASSERT_EQ(b.infringements.size(), 1u);
  EXPECT_EQ(b.infringements[0].kind, Hazard::building);
  // Out of reach: nothing.
  EXPECT_TRUE(clearances_of(lines, 0, Obstacles({{50.0, 60.0, 15.5, Hazard::building}}), o).smallest.empty());
}

TEST(Clearance, ATreeFallsInWhereItIsLongerThanTheWay) {
  const PowerLines lines = one_wire();
  std::vector<Obstacle> all;
  for (double x = 20.0; x <= 80.0; x += 1.0)
    for (double y = -30.0; y <= 30.0; y += 1.0) all.push_back({x, y, 0.0, Hazard::ground});
  all.push_back({50.0, 10.0, 22.0, Hazard::vegetation});   // sqrt(10^2 + 17.5^2) = 20.2 m away
  all.push_back({30.0, -20.0, 22.0, Hazard::vegetation});  // 27.2 m away
  ClearanceOptions o;
  o.limit = {6.0, 2.5, 5.0, 1.15};
  const std::vector<FallingTree> trees = falling_trees(lines, 0, Obstacles(all), o);
  ASSERT_EQ(trees.size(), 1u);
  EXPECT_NEAR(trees[0].height, 22.0, 1e-6);
  EXPECT_NEAR(trees[0].margin, std::hypot(10.0, 17.5) - 22.0, 0.01);
}

}  // namespace
}  // namespace swath::terrain
