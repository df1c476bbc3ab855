// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/limits.h"

#include <gtest/gtest.h>

#include "core/config/result_visitors.h"

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
