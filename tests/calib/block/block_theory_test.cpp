// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/block_theory.h"

#include <gtest/gtest.h>

#include "io/text/value_file.h"
#include "tests/world/support.h"

namespace swath::calib {
namespace {

constexpr double half_a_percent = 0.005;  // stated with the vector
const TheoryCase no_drift{"1", DriftSets::none, ControlLayout::chains, 0}, block_drift{"2", DriftSets::block, ControlLayout::chains, 0},
    strip_drift{"3", DriftSets::strip, ControlLayout::chains, 0}, cross_strips{"4", DriftSets::strip, ControlLayout::corners, 2};

void expect_mu(const TheoryFound& f, double xy, double z, double share = half_a_percent) {
  EXPECT_EQ(f.refused, "") << f.name;
  EXPECT_NEAR(f.mu_xy / f.unit, xy, share * xy) << f.name;
  EXPECT_NEAR(f.mu_z / f.unit, z, share * z) << f.name;
}

TEST(BlockTheory, Quadro1) {
  expect_mu(theory_of({}, no_drift), 0.959, 1.502);
  expect_mu(theory_of({}, block_drift), 1.620, 1.680);
  expect_mu(theory_of({}, strip_drift), 2.101, 2.288);
  expect_mu(theory_of({}, cross_strips), 1.533, 2.268);
  expect_mu(theory_of({}, {"no control", DriftSets::none, ControlLayout::none, 0}), 1.119, 1.702);
  expect_mu(theory_of({}, {"four corners", DriftSets::block, ControlLayout::corners, 0}), 1.681, 2.238);
}

TEST(BlockTheory, TheLayoutIsThatOfThePaper) {
  SWATH_SHARED_OR_SKIP(file, "vectors/p002_geometry.json");
  const core::Value v = io::read_value_file(file);
  const ImageBlock b = theoretical_block({}, cross_strips);
  std::vector<core::Value> photos = v.find("photos_a")->items();
  for (const core::Value& p : v.find("photos_b_cross")->items()) photos.push_back(p);
  ASSERT_EQ(b.images.size(), photos.size());
  for (size_t i = 0; i < photos.size(); ++i) {
    const auto field = [&](size_t k) { return photos[i].items()[k].as_number(); };
    EXPECT_NEAR((b.images[i].position - Eigen::Vector3d(field(0), field(1), field(2))).norm(), 0.0, 1e-6) << i;
    EXPECT_NEAR(b.images[i].camera_R_local(0, 0), std::cos(field(3)), 1e-8) << i;
    EXPECT_NEAR(b.images[i].camera_R_local(0, 1), std::sin(field(3)), 1e-8) << i;
    EXPECT_NEAR(b.images[i].time, field(5), 1e-6) << i;
  }
  ASSERT_EQ(b.points.size(), 273u);
  EXPECT_EQ(b.rays.size(), 1332u);
  EXPECT_EQ(theoretical_block({}, no_drift).control.size(), v.find("control_a")->members().size());
}

TEST(BlockTheory, SmallerAndLargerBlocksAndPoorStations) {
  SWATH_SHARED_OR_SKIP(file, "vectors/p002_quadro1.json");
  const core::Value v = io::read_value_file(file);
  for (const auto& [name, strips, images] : {std::tuple{"4x11", 4, 11}, std::tuple{"10x31", 10, 31}}) {
    TheoryOptions o;
    o.strips = strips, o.images = images;
    const auto& expected = v.find("block_size_none_block_strip")->find(name)->items();
    size_t k = 0;
    for (const TheoryCase& c : {no_drift, block_drift, strip_drift}) {
      const auto& pair = expected[k++].items();
      expect_mu(theory_of(o, c), pair[0].as_number(), pair[1].as_number());
    }
  }
  TheoryOptions poor;
  poor.sigma_station = core::Metres(10.0 * poor.unit());
  for (const TheoryCase& c : {no_drift, block_drift, strip_drift, cross_strips}) {
    const double ratio_xy = theory_of(poor, c).mu_xy / theory_of({}, c).mu_xy, ratio_z = theory_of(poor, c).mu_z / theory_of({}, c).mu_z;
    EXPECT_GT(ratio_xy, 1.65) << c.name;  // 1.7 to 2.3, rounded
    EXPECT_LT(ratio_z, 2.35) << c.name;
  }
}

TEST(BlockTheory, FourCornersWithStripDriftAreRefused) {
  const TheoryFound f = theory_of({}, {"corners", DriftSets::strip, ControlLayout::corners, 0});
  EXPECT_NE(f.refused.find("cross strips"), std::string::npos) << f.refused;
  EXPECT_NE(f.refused.find("chains"), std::string::npos) << f.refused;
}

TEST(BlockTheory, BackwardsGivesTheStationSigmaOfATolerance) {
  const TheoryTable t = theory_table({});
  ASSERT_EQ(t.allowed.size(), 16u);
  // The vector's Quadro 2 was interpolated between samples a factor of 2 apart: up to 7 % smaller.
  const auto near = [](const std::optional<double>& found, double expected) {
    EXPECT_NEAR(found.value_or(0.0), expected, 0.08 * expected);
  };
  EXPECT_FALSE(t.allowed[0].for_xy);
  EXPECT_FALSE(t.allowed[0].xy_unreachable);
  near(t.allowed[0].for_z, 19.58), near(t.allowed[3].for_z, 1.531), near(t.allowed[3].for_xy, 8.05);
  near(t.allowed[10].for_z, 0.700), near(t.allowed[15].for_z, 0.320);
  // What is found leads back to the tolerance: 0.8 m in plan and 0.6 m in height at 1:25 000.
  constexpr double exact = 2e-4;  // of the tolerance: the search ends at half of it
  for (const auto& [row, which] :
       {std::pair{size_t{3}, no_drift}, {size_t{7}, block_drift}, {size_t{11}, strip_drift}, {size_t{15}, cross_strips}}) {
    TheoryOptions o;
    o.scale = 25000.0;
    o.sigma_station = core::Metres(*t.allowed[row].for_z);
    EXPECT_NEAR(theory_of(o, which).mu_z, 0.6, exact * 0.6) << which.name;
    o.sigma_station = core::Metres(*t.allowed[row].for_xy);
    EXPECT_NEAR(theory_of(o, which).mu_xy, 0.8, exact * 0.8) << which.name;
  }
  EXPECT_NE(theory_text(t).find("in units of sigma0 times the scale"), std::string::npos);
  EXPECT_NE(theory_text(t).find("4 strip drift, cross strips"), std::string::npos);
}

/// Control of 0.3 m is that at every scale of a demand, not 0.3 m of the block's own.
TEST(BlockTheory, StatedControlKeepsItsSigmaAtTheDemandsScale) {
  TheoryOptions o;
  o.sigma_control = core::Metres(0.3);
  o.cases = {strip_drift};
  o.demands = {{"1:25 000", 40000.0, core::Metres(1.5), core::Metres(1.0)}};
  const AllowedFound a = theory_table(o).allowed.at(0);
  o.scale = 40000.0;
  o.sigma_station = core::Metres(a.for_z.value());
  EXPECT_NEAR(theory_of(o, strip_drift).mu_z, 1.0, 2e-4);
  o.sigma_station = core::Metres(a.for_xy.value());
  EXPECT_NEAR(theory_of(o, strip_drift).mu_xy, 1.5, 3e-4);
}

TEST(BlockTheory, WhatIsNotAskedIsNotMissed) {
  TheoryOptions o;
  o.cases = {{"corners", DriftSets::strip, ControlLayout::corners, 0}};
  o.demands = {{"1:25 000", 40000.0, {}, core::Metres(1.0)}};
  const AllowedFound a = theory_table(o).allowed.at(0);
  EXPECT_FALSE(a.xy_unreachable);
  EXPECT_TRUE(a.z_unreachable);
  EXPECT_NE(theory_of(o, o.cases[0]).refused.find("strips 1, 2, 3, 4, 5, 6"), std::string::npos);
}

}  // namespace
}  // namespace swath::calib
