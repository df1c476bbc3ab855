// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/csf.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config/option_visitors.h"
#include "tests/filters/ground_truth.h"

namespace swath::filters {
namespace {

auto run(const CsfOptions& o = {}) {
  return [o](core::Block& b, size_t own) { return classify_ground_csf(b, own, o); };
}

TEST(Csf, MadeScenesComeOutNearlyWhole) {
  test::expect_within({{"flat", 0.1, 0},
                       {"slope", 0.1, 0},
                       {"town", 0.5, 0.5},
                       {"forest", 2.5, 0.5},
                       {"water", 0.1, 0},
                       {"void", 0.1, 0},
                       {"strip_edge", 0.1, 0}},
                      run());
}

TEST(Csf, TheThresholdIsADistanceFromTheCloth) {
  for (const double above : {0.3, 0.7}) {
    test::Scene s = test::make_scene("flat");
    std::vector<size_t> raised;
    for (size_t p = 50; p < s.block.size(); p += 211) raised.push_back(p), s.block.z[p] = 100.0 + above;
    CsfOptions o;
    o.smooth = false;  // which would lay it on points 0.3 m higher
    classify_ground_csf(s.block, s.block.size(), o);
    for (const size_t p : raised) EXPECT_EQ(s.block.classification[p] == core::point_class::ground, above < 0.5) << above;
  }
}

TEST(Csf, AStiffClothBridgesWhatASoftOneSagsInto) {
  const auto errors = [](double half, int rigidness) {
    test::Scene s = test::make_scene("flat");
    for (size_t p = 0; p < s.block.size(); ++p)
      if (std::abs(s.block.x[p] - 100.0) < half && std::abs(s.block.y[p] - 80.0) < half) {
        s.block.z[p] += 3.0;
        s.truth[p] = core::point_class::building;
      }
    CsfOptions o;
    o.rigidness = rigidness;
    classify_ground_csf(s.block, s.block.size(), o);
    return test::ground_errors(s.block, s.truth);
  };
  EXPECT_EQ(errors(10.0, 3).type_2(), 0.0);
  EXPECT_GT(errors(40.0, 1).type_2(), 50.0);
}

TEST(Csf, ASlopeThatTheClothHangsOverIsLaidDown) {
  // A ridge: turned upside down a trough that a stiff cloth spans.
  const auto lost = [](bool smooth) {
    test::Scene s = test::make_scene("flat");
    for (size_t p = 0; p < s.block.size(); ++p) s.block.z[p] += std::max(0.0, 4.0 - 0.25 * std::abs(s.block.x[p] - 100.0));
    CsfOptions o;
    o.smooth = smooth;
    classify_ground_csf(s.block, s.block.size(), o);
    return test::ground_errors(s.block, s.truth).type_1();
  };
  EXPECT_LT(lost(true), 2.0);
  EXPECT_GT(lost(false), 2.0 * lost(true));
}

TEST(Csf, NoiseEarlyReturnsAndHaloKeepOut) { test::expect_only_own_last_returns_judged(run()); }

TEST(Csf, SeamsBetweenPatchesDecideLittle) {
  CsfOptions o;
  o.span = core::Metres(30.0);
  constexpr double bearable = 0.5;  // %: the particles move against the points too
  for (const char* scene : {"slope", "town"}) EXPECT_LT(test::labels_that_hang_on_the_seams(scene, run(o)), bearable) << scene;
}

TEST(Csf, OptionsAreCheckedAgainstOneAnother) {
  CsfOptions o;
  std::vector<core::Fault> faults;
  core::Value table = core::Value::object();
  table["span"] = "0.5 m";
  core::read_options(core::described(o), table, "", faults);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].what, "span must hold at least one particle");
}

}  // namespace
}  // namespace swath::filters
