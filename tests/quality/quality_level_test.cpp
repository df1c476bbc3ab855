// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/quality_level.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace swath::quality {
namespace {

MeasuredQuality good() {
  MeasuredQuality m;
  m.spacing = 0.6, m.density = 2.8, m.even = 0.97, m.void_area = 0.0, m.intraswath = 0.03, m.interswath = 0.05, m.nva = 0.08, m.vva = 0.2;
  return m;
}

size_t missed(QualityLevel level, const MeasuredQuality& m, const StatedLimits& stated = {}) {
  size_t n = 0;
  for (const Requirement& r : judge_level(level, stated, m)) n += r.is_missed();
  return n;
}

TEST(QualityLevel, ASurveyMeetsOneAndMissesTheNext) {
  EXPECT_EQ(missed(QualityLevel::QL2, good()), 0u);
  EXPECT_EQ(missed(QualityLevel::QL3, good()), 0u);
  EXPECT_EQ(missed(QualityLevel::QL1, good()), 2u);  // spacing and density
  EXPECT_EQ(missed(QualityLevel::QL0, good()), 4u);  // and interswath, NVA
}

TEST(QualityLevel, EveryRequirementCanBeMissed) {
  const auto with = [](std::optional<double> MeasuredQuality::*what, double value) {
    MeasuredQuality m = good();
    m.*what = value;
    return missed(QualityLevel::QL2, m);
  };
  using M = MeasuredQuality;
  EXPECT_EQ(with(&M::spacing, 0.72), 1u);
  EXPECT_EQ(with(&M::density, 1.9), 1u);
  EXPECT_EQ(with(&M::even, 0.89), 1u);
  EXPECT_EQ(with(&M::void_area, 8.1), 1u);
  EXPECT_EQ(with(&M::intraswath, 0.061), 1u);
  EXPECT_EQ(with(&M::interswath, 0.081), 1u);
  EXPECT_EQ(with(&M::nva, 0.101), 1u);
}

TEST(QualityLevel, UnderVegetationOnlyAContractSetsALimit) {
  MeasuredQuality m = good();
  m.vva = 5.0;
  EXPECT_EQ(missed(QualityLevel::QL2, m), 0u);  // tables 4 of 2024 rev. A and later have no column for it
  StatedLimits stated;
  stated.vva = core::Metres(0.3);
  EXPECT_EQ(missed(QualityLevel::QL2, m, stated), 1u);
}

// Tables 1, 2 and 4 of the Lidar Base Specification 2025 rev. A.
TEST(QualityLevel, LimitsAreThoseOfTheTables) {
  struct Row {
    QualityLevel level;
    double spacing, density, intraswath, interswath, nva;
  };
  for (const Row& r : {Row{QualityLevel::QL0, 0.35, 8.0, 0.03, 0.04, 0.050}, Row{QualityLevel::QL1, 0.35, 8.0, 0.06, 0.08, 0.100},
                       Row{QualityLevel::QL2, 0.71, 2.0, 0.06, 0.08, 0.100}, Row{QualityLevel::QL3, 1.41, 0.5, 0.12, 0.16, 0.200}}) {
    const LevelLimits l = limits_of(r.level);
    EXPECT_EQ(l.spacing, r.spacing);
    EXPECT_EQ(l.density, r.density);
    EXPECT_EQ(l.intraswath, r.intraswath);
    EXPECT_EQ(l.interswath, r.interswath);
    EXPECT_EQ(l.nva, r.nva);
  }
}

TEST(QualityLevel, WhatIsNotMeasuredIsNeitherMetNorMissed) {
  const std::vector<Requirement> list = judge_level(QualityLevel::QL2, {}, {});
  EXPECT_EQ(list.size(), 7u);
  for (const Requirement& r : list) {
    EXPECT_FALSE(r.is_met()) << r.what;
    EXPECT_FALSE(r.is_missed()) << r.what;
  }
}

TEST(QualityLevel, AContractTakesTheLevelsPlace) {
  StatedLimits stated;
  stated.nva = core::Metres(0.07);
  stated.density = 4.0;
  EXPECT_EQ(missed(QualityLevel::QL2, good(), stated), 2u);
  EXPECT_EQ(judge_level(QualityLevel::none, stated, good()).size(), 2u);
  EXPECT_TRUE(judge_level(QualityLevel::none, {}, good()).empty());
  EXPECT_THROW(limits_of(QualityLevel::none), core::Error);
}

}  // namespace
}  // namespace swath::quality
