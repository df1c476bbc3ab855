// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/noise/visibility.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/config/option_visitors.h"
#include "core/error.h"
#include "tests/world/scene.h"

namespace swath::filters {
namespace {

using Eigen::Vector3d;

/// A scanner that flies along y, 500 m above and to the west: beams of up to 22 deg.
std::vector<Vector3d> seen_from(const core::Block& b) {
  std::vector<Vector3d> out;
  for (size_t p = 0; p < b.size(); ++p) out.emplace_back(0.0, b.y[p], 600.0);
  return out;
}

core::Lattice cells_of(const core::Block& b, double cell) {
  return core::lattice_of(cell, b.origin.x(), b.origin.y(), b.origin.x() + test::scene_width, b.origin.y() + test::scene_height);
}

void label(test::Scene& s) {
  for (size_t p = 0; p < s.block.size(); ++p)
    s.block.classification[p] = s.truth[p] == core::point_class::ground ? core::point_class::ground : core::point_class::unassigned;
}

void add_return(test::Scene& s, double x, double y, double z) {
  core::resize(s.block, s.block.size() + 1);
  s.block.x.back() = x, s.block.y.back() = y, s.block.z.back() = z;
  s.block.time.back() = 2000.0 + static_cast<double>(s.block.size());
  s.block.return_number.back() = s.block.return_count.back() = 1;
  s.block.classification.back() = core::point_class::unassigned;
}

TEST(Visibility, ReturnsInSpaceThatOtherBeamsPassedAreNoise) {
  for (const char* name : {"flat", "slope", "town", "forest", "bridge"}) {
    test::Scene s = test::make_scene(name);
    label(s);
    const size_t before = s.block.size();
    for (int k = 0; k < 10; ++k) add_return(s, 30.0 + 14.0 * k, 80.0, s.terrain(30.0 + 14.0 * k, 80.0) + 28.0);
    const size_t all = s.block.size();
    Visibility v;
    const VisibilityCounts n = trace_visibility(s.block, all, seen_from(s.block), cells_of(s.block, 10.0), {}, v);
    size_t found = 0;
    for (size_t p = before; p < all; ++p) found += s.block.classification[p] == core::point_class::high_noise;
    EXPECT_EQ(found, 10u) << name;
    constexpr double bearable = 0.001;  // of the clean returns
    EXPECT_LE(static_cast<double>(n.noise - found), bearable * static_cast<double>(before)) << name;
  }
}

TEST(Visibility, AShareOfZeroKeepsAll) {
  test::Scene s = test::make_scene("flat");
  label(s);
  add_return(s, 100.0, 80.0, 125.0);
  VisibilityOptions o;
  o.solid = 0.0;
  Visibility v;
  EXPECT_EQ(trace_visibility(s.block, s.block.size(), seen_from(s.block), cells_of(s.block, 10.0), o, v).noise, 0u);
}

TEST(Visibility, VerticalBeamsGiveTheGapFractionOfTheLayersTheyPass) {
  // Three pulses in one voxel column: one ends 9 m up, one 5 m up and goes on to the ground, one reaches the ground alone.
  core::Block b;
  b.origin = {1000.0, 2000.0, 0.0};
  const double heights[] = {9.0, 5.0, 0.5, 0.5};
  const double times[] = {1.0, 2.0, 2.0, 3.0};
  core::resize(b, 4);
  core::add_columns(b, {core::Column::time, core::Column::return_number, core::Column::return_count, core::Column::classification});
  std::vector<Vector3d> scanner;
  for (size_t p = 0; p < 4; ++p) {
    b.x[p] = b.y[p] = 1.0;
    b.z[p] = heights[p];
    b.time[p] = times[p];
    b.return_number[p] = p == 2 ? 2 : 1;
    b.return_count[p] = p == 1 || p == 2 ? 2 : 1;
    b.classification[p] = p < 2 ? core::point_class::unassigned : core::point_class::ground;
    scanner.emplace_back(1.0, 1.0, 500.0);
  }
  VisibilityOptions o;
  o.cell = core::Metres(2.0);
  o.solid = 0.0;
  Visibility v;
  trace_visibility(b, 4, scanner, core::Lattice{2.0, 500, 1000, 1, 1}, o, v);
  ASSERT_EQ(v.layers, 20);
  EXPECT_DOUBLE_EQ(v.penetration(0), 2.0 / 3.0);
  EXPECT_EQ(v.gap(0, 5), 1.0);               // 10 to 12 m: all three pass
  EXPECT_DOUBLE_EQ(v.gap(0, 4), 2.0 / 3.0);  // 8 to 10 m: one of three ends
  EXPECT_EQ(v.gap(0, 3), 1.0);               // the pulse that goes on is counted once
  EXPECT_DOUBLE_EQ(v.gap(0, 2), 1.0 / 2.0);  // 4 to 6 m: one of two is met, and goes on
  EXPECT_EQ(v.gap(0, 1), 1.0);
  EXPECT_DOUBLE_EQ(v.gap_fraction(0), 1.0 / 3.0);
  EXPECT_TRUE(std::isnan(v.gap(0, 19)) || v.gap(0, 19) == 1.0);
  EXPECT_EQ(v.seen().reason[0], core::Void::none);
}

TEST(Visibility, GroundUnderARoofIsNeverSeenAndWhereNoBeamCameIsNoData) {
  test::Scene s = test::make_scene("town");
  label(s);
  Visibility v;
  VisibilityOptions o;
  o.cell = core::Metres(2.0);
  trace_visibility(s.block, s.block.size(), seen_from(s.block), cells_of(s.block, 2.0), o, v);
  const core::Grid seen = v.seen();
  const auto at = [&](double x, double y) {
    return seen.reason[seen.lattice.at(static_cast<int>(core::cell_index(s.block.origin.x() + x, 2.0) - seen.lattice.i0),
                                       static_cast<int>(core::cell_index(s.block.origin.y() + y, 2.0) - seen.lattice.j0))];
  };
  EXPECT_EQ(at(56.0, 55.0), core::Void::never_seen);  // the middle of a house
  EXPECT_EQ(at(75.0, 55.0), core::Void::none);        // a street

  test::Scene hole = test::make_scene("void");
  label(hole);
  trace_visibility(hole.block, hole.block.size(), seen_from(hole.block), cells_of(hole.block, 2.0), o, v);
  const core::Grid with_hole = v.seen();
  const auto& l = with_hole.lattice;
  EXPECT_EQ(with_hole.reason[l.at(50, 50)], core::Void::no_data);
  EXPECT_EQ(with_hole.reason[l.at(10, 50)], core::Void::none);
}

TEST(Visibility, RastersDoNotDependOnTiles) {
  test::Scene s = test::make_scene("forest");
  label(s);
  VisibilityOptions o;
  o.reach = core::Metres(25.0);
  const core::Lattice whole_lattice = cells_of(s.block, 10.0);
  core::Block whole = s.block;
  Visibility all;
  trace_visibility(whole, whole.size(), seen_from(whole), whole_lattice, o, all);
  // One tile: its own points, then those of the halo.
  const double x0 = 60.0, x1 = 120.0;
  std::vector<std::uint32_t> rows, behind;
  for (std::uint32_t p = 0; p < s.block.size(); ++p) {
    if (s.block.x[p] >= x0 && s.block.x[p] < x1)
      rows.push_back(p);
    else if (s.block.x[p] >= x0 - halo(o) && s.block.x[p] < x1 + halo(o))
      behind.push_back(p);
  }
  const size_t own = rows.size();
  rows.insert(rows.end(), behind.begin(), behind.end());
  core::Block tile = core::select(s.block, rows);
  core::Lattice l = whole_lattice;
  l.i0 += 6;
  l.nx = 6;
  Visibility part;
  trace_visibility(tile, own, seen_from(tile), l, o, part);
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) {
      const size_t a = l.at(i, j), b = whole_lattice.at(i + 6, j);
      EXPECT_EQ(part.pulses[a], all.pulses[b]);
      for (int k = 0; k < part.layers; ++k) {
        const auto n = static_cast<size_t>(part.layers), h = static_cast<size_t>(k);
        ASSERT_EQ(part.passed[a * n + h], all.passed[b * n + h]) << i << " " << j << " layer " << k;
        ASSERT_EQ(part.met[a * n + h], all.met[b * n + h]);
      }
    }
}

TEST(Visibility, ReturnsWithoutAScannerPositionAreCounted) {
  test::Scene s = test::make_scene("flat");
  std::vector<Vector3d> scanner = seen_from(s.block);
  scanner[3] = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  Visibility v;
  const VisibilityCounts n = trace_visibility(s.block, s.block.size(), scanner, cells_of(s.block, 10.0), {}, v);
  EXPECT_EQ(n.no_position, 1u);
  VisibilityOptions o;
  o.voxel = core::Metres(0.002);
  EXPECT_THROW(trace_visibility(s.block, s.block.size(), scanner, {}, o, v), core::Error);
}

TEST(Visibility, OptionsAreCheckedAgainstOneAnother) {
  VisibilityOptions o;
  std::vector<core::Fault> faults;
  core::Value table = core::Value::object();
  table["cell"] = "1 m";
  core::read_options(core::described(o), table, "", faults);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].what, "cell must span at least one voxel");
}

}  // namespace
}  // namespace swath::filters
