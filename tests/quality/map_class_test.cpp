// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/map_class.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "io/text/value_file.h"
#include "tests/world/support.h"

namespace swath::quality {
namespace {

/// Brandalize, tables 06 and 09, of a map 1:1000 with an interval of 1 m.
TEST(MapClass, LimitsByBothRules) {
  const auto limits = [](MapRule rule, size_t k) { return ground_limits(map_classes(rule)[k], 1000, 1.0); };
  EXPECT_DOUBLE_EQ(limits(MapRule::paper, 0).height_pec, 0.60);
  EXPECT_DOUBLE_EQ(limits(MapRule::paper, 0).height_ep, 0.40);
  EXPECT_DOUBLE_EQ(limits(MapRule::decree, 0).height_pec, 0.50);
  EXPECT_DOUBLE_EQ(limits(MapRule::decree, 0).height_ep, 1.0 / 3);
  for (const MapRule rule : {MapRule::paper, MapRule::decree}) {
    EXPECT_DOUBLE_EQ(limits(rule, 0).plan_pec, 0.5);
    EXPECT_DOUBLE_EQ(limits(rule, 0).plan_ep, 0.3);
    EXPECT_DOUBLE_EQ(limits(rule, 1).plan_pec, 0.8);
    EXPECT_DOUBLE_EQ(limits(rule, 2).plan_ep, 0.6);
    EXPECT_DOUBLE_EQ(limits(rule, 1).height_pec, 0.60);
    EXPECT_DOUBLE_EQ(limits(rule, 2).height_pec, 0.75);
    EXPECT_DOUBLE_EQ(limits(rule, 2).height_ep, 0.50);
  }
  EXPECT_EQ(map_classes(MapRule::pcd).size(), 4u);
}

TEST(MapClass, PublishedTables) {
  SWATH_SHARED_OR_SKIP(file, "vectors/p004_formulas.json");
  const core::Value all = io::read_value_file(file);
  const auto rule = [](const core::Value& v) { return v.find("table")->as_text() == "paper" ? MapRule::paper : MapRule::decree; };
  const auto number = [](const core::Value& v, const char* key) { return v.find(key)->as_number(); };
  const auto name = [](const core::Value& v, const char* key) { return v.find(key)->is_text() ? v.find(key)->as_text() : std::string(); };
  constexpr double tolerance = 1e-9;  // of the vectors
  for (const core::Value& one : all.find("pec_limits")->find("examples")->items())
    for (const MapClass& c : map_classes(rule(one))) {
      const MapLimits l = ground_limits(c, number(one, "scale"), number(one, "EQ"));
      const auto& row = one.find(c.name)->items();
      const std::array<double, 4> mine{l.plan_pec, l.plan_ep, l.height_pec, l.height_ep};
      for (size_t k = 0; k < 4; ++k) EXPECT_NEAR(mine[k], row[k].as_number(), tolerance * mine[k]) << c.name << k;
    }
  EXPECT_EQ(all.find("pec_limits")->find("k")->as_number(), pec_of_ep);
  for (const core::Value& one : all.find("pec_class")->items()) {
    const std::string plan = plan_class(rule(one), number(one, "scale"), number(one, "ep_xy"));
    const std::string height = height_class(rule(one), number(one, "EQ"), number(one, "ep_z"));
    EXPECT_EQ(plan, name(one, "plan"));
    EXPECT_EQ(height, name(one, "alt"));
    EXPECT_EQ(both_classes(plan, height), name(one, "both"));
  }
}

TEST(MapClass, TheBestWhoseLimitsHold) {
  EXPECT_EQ(plan_class(MapRule::decree, 2000, 0.6), "A");  // met exactly
  EXPECT_EQ(plan_class(MapRule::decree, 1000, 0.38), "B");
  EXPECT_EQ(plan_class(MapRule::decree, 1000, 0.7), "");
  EXPECT_EQ(height_class(MapRule::paper, 1.0, 0.35), "A");
  EXPECT_EQ(height_class(MapRule::decree, 1.0, 0.35), "B");
  EXPECT_EQ(height_class(MapRule::decree, 1.0, 0.3, 0.55), "B");  // 90 % of the errors are over the PEC of A
  EXPECT_EQ(height_class(MapRule::pcd, 1.0, 0.6), "");
  EXPECT_EQ(both_classes("A", "C"), "C");
  EXPECT_EQ(both_classes("A", ""), "");
}

TEST(MapClass, IntervalsAndCFactor) {
  EXPECT_DOUBLE_EQ(closest_interval(MapRule::decree, "A", 0.15), 0.45);
  EXPECT_DOUBLE_EQ(closest_interval(MapRule::paper, "A", 0.20), 0.50);
  EXPECT_THROW(closest_interval(MapRule::paper, "D", 0.2), core::Error);
  // 90 % of the errors may need more than the standard error does: the class is reached at that interval, and just not below it.
  EXPECT_DOUBLE_EQ(closest_interval(MapRule::decree, "A", 0.15, 0.20), 0.45);
  EXPECT_DOUBLE_EQ(closest_interval(MapRule::decree, "A", 0.15, 0.30), 0.60);
  EXPECT_EQ(height_class(MapRule::decree, 0.60, 0.15, 0.30), "A");
  EXPECT_EQ(height_class(MapRule::decree, 0.59, 0.15, 0.30), "B");
  EXPECT_NEAR(interval_of(1200, 2200), 0.545454545455, 1e-12);
  EXPECT_NEAR(c_factor_of(1200, interval_of(1200, 914)), 914, 1e-9);
}

}  // namespace
}  // namespace swath::quality
