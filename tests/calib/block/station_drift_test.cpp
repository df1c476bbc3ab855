// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/station_drift.h"

#include <gtest/gtest.h>

#include "io/text/value_file.h"
#include "tests/world/support.h"

namespace swath::calib {
namespace {

TEST(StationDrift, FlevolandsThreeFigures) {
  SWATH_SHARED_OR_SKIP(file, "vectors/p002_flevoland_synthetic.json");
  const core::Value v = io::read_value_file(file);
  std::vector<StripDifferences> strips;
  for (const core::Value& s : v.find("strips")->items()) {
    StripDifferences d;
    d.strip = s.find("strip")->as_text();
    for (const core::Value& t : s.find("t_s")->items()) d.time.push_back(t.as_number());
    for (const core::Value& x : s.find("dS_cm")->items()) d.difference.push_back(x.as_number());
    strips.push_back(d);
  }
  const DriftFound found = drift_of("dS_cm", strips);
  const core::Value& e = *v.find("expected");
  constexpr double tolerance = 1e-6;  // cm, stated with the vector
  EXPECT_NEAR(found.together.direct, e.find("rms_direct")->as_number(), tolerance);
  EXPECT_NEAR(found.together.less_mean, e.find("rms_minus_strip_means")->as_number(), tolerance);
  EXPECT_NEAR(found.together.less_line, e.find("rms_one_regression")->as_number(), tolerance);
  EXPECT_NEAR(found.together.a0, e.find("one_regression")->find("a0_cm")->as_number(), tolerance);
  EXPECT_NEAR(found.together.a1, e.find("one_regression")->find("a1_cm_per_s")->as_number(), tolerance);
  ASSERT_EQ(found.strips.size(), 4u);
  for (size_t k = 0; k < 4; ++k) {
    const core::Value& s = e.find("per_strip")->items()[k];
    EXPECT_NEAR(found.strips[k].direct, s.find("rms_direct")->as_number(), tolerance);
    EXPECT_NEAR(found.strips[k].less_mean, s.find("rms_minus_mean")->as_number(), tolerance);
    EXPECT_NEAR(found.strips[k].less_line, s.find("rms_regression")->as_number(), tolerance);
    EXPECT_NEAR(found.strips[k].a0, s.find("a0")->as_number(), tolerance);
    EXPECT_NEAR(found.strips[k].a1, s.find("a1")->as_number(), tolerance);
  }
}

TEST(StationDrift, ALineIsTakenAwayWhole) {
  // GPS times: 1e9 s must not cost digits.
  std::vector<StripDifferences> strips{{"1", {1e9, 1e9 + 10, 1e9 + 20}, {1.0, 1.5, 2.0}}, {"2", {1e9 + 100}, {4.0}}, {"3", {}, {}}};
  const DriftFound found = drift_of("dx", strips);
  ASSERT_EQ(found.strips.size(), 2u);
  EXPECT_NEAR(found.strips[0].a1, 0.05, 1e-12);
  EXPECT_NEAR(found.strips[0].less_line, 0.0, 1e-7);  // 1e9 s * 0.05 has a last place of 7e-9
  EXPECT_NEAR(found.strips[1].less_line, 0.0, 1e-12);
  EXPECT_NEAR(found.together.direct, std::sqrt((1 + 2.25 + 4 + 16) / 4), 1e-12);
  EXPECT_EQ(drift_of("dx", {}).together.stations, 0u);
}

}  // namespace
}  // namespace swath::calib
