// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/pmf.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config/option_visitors.h"
#include "tests/filters/ground_truth.h"

namespace swath::filters {
namespace {

auto run(const PmfOptions& o = {}) {
  return [o](core::Block& b, size_t own) { return classify_ground_pmf(b, own, o); };
}

TEST(Pmf, MadeScenesComeOutNearlyWhole) {
  // The first opening keeps 0.15 m over three cells: five standard deviations of the points. On a slope the lowest points of neighbouring
  // cells lie at places up to two cells apart: 0.25 times that is more.
  PmfOptions o;
  o.max_window_size = core::Metres(17.0);  // the widest house is 12 m
  test::expect_within(
      {{"flat", 0.5, 0}, {"town", 2.0, 0.1}, {"water", 0.5, 0}, {"void", 0.5, 0}, {"strip_edge", 0.5, 0}, {"slope", 5.0, 0}}, run(o));
}

TEST(Pmf, EveryWindowHasItsOwnThreshold) {
  // Zhang2003 eq 7 with windows of 3, 5, 9, 17 and 33 m and slope 0.1: 0.15, 0.35, 0.55, 0.95, 1.75 m. A square block of 7 m goes with the
  // window of 9 m if it is over 0.55 m high; one of 13 m with that of 17 m, over 0.95 m.
  struct Case {
    double half, height;
    bool ground;
  };
  for (const Case& c : {Case{3.5, 0.45, true}, Case{3.5, 0.65, false}, Case{6.5, 0.85, true}, Case{6.5, 1.05, false}}) {
    test::Scene s = test::make_scene("flat");
    std::vector<size_t> block;
    for (size_t p = 0; p < s.block.size(); ++p) {
      s.block.z[p] = 100.0;
      const double out = std::max(std::abs(s.block.x[p] - 100.0), std::abs(s.block.y[p] - 80.0));
      if (out < c.half) s.block.z[p] += c.height;
      if (out < c.half - 2.0) block.push_back(p);
    }
    PmfOptions o;
    o.slope = 0.1;
    classify_ground_pmf(s.block, s.block.size(), o);
    for (const size_t p : block) EXPECT_EQ(s.block.classification[p] == core::point_class::ground, c.ground) << c.half << " " << c.height;
  }
}

TEST(Pmf, ThresholdsAreTheSameInCellsOfAnotherSize) {
  // PCL's own rule would multiply the growth by the cell: 0.15 m + 0.1 * 4 m * 2 for the second window of 6 and 10 m.
  for (const double height : {0.45, 0.65}) {
    test::Scene s = test::make_scene("flat");
    std::vector<size_t> block;
    for (size_t p = 0; p < s.block.size(); ++p) {
      s.block.z[p] = 100.0;
      const double out = std::max(std::abs(s.block.x[p] - 100.0), std::abs(s.block.y[p] - 80.0));
      if (out < 4.0) s.block.z[p] += height;
      if (out < 2.0) block.push_back(p);
    }
    PmfOptions o;
    o.cell_size = core::Metres(2.0);
    o.max_window_size = core::Metres(10.0);
    o.slope = 0.1;
    classify_ground_pmf(s.block, s.block.size(), o);
    for (const size_t p : block) EXPECT_EQ(s.block.classification[p] == core::point_class::ground, height < 0.55) << height;
  }
}

TEST(Pmf, NoiseEarlyReturnsAndHaloKeepOut) { test::expect_only_own_last_returns_judged(run()); }

TEST(Pmf, SeamsBetweenPatchesDecideNothing) {
  PmfOptions o;
  o.max_window_size = core::Metres(5.0);
  constexpr double rounding = 0.01;  // %: single precision; the move is by whole cells
  for (const char* scene : {"slope", "town", "forest"}) EXPECT_LT(test::labels_that_hang_on_the_seams(scene, run(o)), rounding) << scene;
}

TEST(Pmf, OptionsAreCheckedAgainstOneAnother) {
  PmfOptions o;
  std::vector<core::Fault> faults;
  core::Value table = core::Value::object();
  table["cell_size"] = "50 m";
  core::read_options(core::described(o), table, "", faults);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].what, "max_window_size must span at least one cell");
}

}  // namespace
}  // namespace swath::filters
