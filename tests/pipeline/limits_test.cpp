// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/limits.h"

#include <gtest/gtest.h>

#include "core/config/result_visitors.h"
#include "io/text/value_file.h"

namespace swath::pipeline {
namespace {

const core::Value* named(const core::Value& list, const std::string& name) {
  for (const core::Value& one : list.items())
    if (one.find("name")->as_text() == name) return &one;
  return nullptr;
}

/// As report.json lists them.
core::Value listed(const Limits& limits, const Measured& measured) {
  core::Value list = core::Value::array();
  for (const JudgedLimit& l : judged(limits, measured)) list.push(core::reported(l));
  return list;
}

TEST(Limits, AMissedLimitIsNamedWithItsExcess) {
  Limits limits;
  limits.voids = 0.02;
  limits.truth_rms = core::Metres(0.05);
  const core::Value list = listed(limits, {.outside = 0.5, .voids = 0.032, .truth_rms = 0.0823});
  EXPECT_TRUE(named(list, "outside")->find("held")->as_bool());
  EXPECT_FALSE(named(list, "voids")->find("held")->as_bool());
  EXPECT_NEAR(named(list, "voids")->find("excess")->as_number(), 0.012, 1e-12);
  const std::vector<Warning> missed = missed_limits(list);
  ASSERT_EQ(missed.size(), 2u);
  EXPECT_EQ(missed[0].text, "run.limits.voids = 2 % is exceeded by 1.2 %: holes in the DTM 3.2 %");
  EXPECT_EQ(missed[1].code, "limit.truth_rms");
  EXPECT_NEAR(missed[1].figures[2].value, 0.0323, 1e-9);
  EXPECT_EQ(missed[1].text, "run.limits.truth_rms = 0.05 m is exceeded by 0.0323 m: 3D rms of the points against truth 0.0823 m");
}

TEST(Limits, MissedRequirementsAreCountedAndNamed) {
  Limits limits;
  limits.quality_level = 0;
  Measured found;
  found.quality_level = 2.0;
  const core::Value list = listed(limits, found);
  EXPECT_EQ(missed_limits(list)[0].text, "2 requirements of the quality level are missed (run.limits.quality_level allows 0)");
  const core::Value stages = io::parse_json(
      R"json([{"type": "readers.las"}, {"type": "report.quality", "findings": {"quality_level": "QL2", "judged": 5, "missed": 2, "requirements": [
          {"what": "density (ANPD)", "unit": "1/m2", "value": 1.25, "limit": 2, "at_least": true, "met": false},
          {"what": "spacing (ANPS)", "unit": "m", "value": 0.6, "limit": 0.71, "at_least": false, "met": true},
          {"what": "RMSE (NVA)", "unit": "m", "value": 0.13, "limit": 0.1, "at_least": false, "met": false},
          {"what": "errors (VVA)", "unit": "m", "value": null, "limit": 0.3, "at_least": false}]}}])json",
      "stages");
  const std::vector<Warning> missed = missed_limits(list, &stages);
  ASSERT_EQ(missed.size(), 1u);
  EXPECT_EQ(missed[0].code, "limit.quality_level");
  EXPECT_EQ(
      missed[0].text,
      "2 of 5 requirements of QL2 are missed (run.limits.quality_level allows 0): density (ANPD) 1.25 1/m2 (at least 2), RMSE (NVA) 0.13 m "
      "(at most 0.1)");
}

TEST(Limits, WhatNothingMeasuresIsNotJudgedAndAnEqualValueIsHeld) {
  Limits limits;
  limits.voids = 0.02;
  limits.outside = 0.0;
  const core::Value list = listed(limits, {.outside = 0.0, .voids = std::nullopt, .truth_rms = std::nullopt});
  EXPECT_TRUE(named(list, "voids")->find("held")->is_text());
  EXPECT_TRUE(named(list, "outside")->find("held")->as_bool());
  EXPECT_EQ(named(list, "truth_rms"), nullptr);
  EXPECT_TRUE(missed_limits(list).empty());
}

}  // namespace
}  // namespace swath::pipeline
