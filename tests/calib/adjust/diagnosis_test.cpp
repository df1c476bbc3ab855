// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/diagnosis.h"

#include <gtest/gtest.h>

#include "tests/calib/tie_block.h"

namespace swath::calib {
namespace {

using namespace test;
using Eigen::MatrixXd;
using Eigen::VectorXd;

FlightShape shape_of_flight(std::vector<FlownLine> lines, int buildings, bool surveyed = false) {
  World w = make_world(std::move(lines), block_planes(3, buildings, 2));
  w.returns = 6;
  if (surveyed) survey(w.planes[4], 0.02, nullptr);
  const TieSet ties = ties_of(w, nullptr);
  CorrectionOptions o;
  o.position = o.attitude = CorrectionForm::none;
  const TieBench b(w, ties, w.exact, o, {boresight_roll});
  return shape_of(b.problem, b.state, linearise(b.problem, b.state, b.noise, 1.0).blocks);
}

TEST(Diagnosis, ShapeOfFlights) {
  const FlightShape full = shape_of_flight(full_pattern(), 4, true);
  EXPECT_EQ(full.lines, 8);
  EXPECT_TRUE(full.opposite && full.crossed && full.beside && full.two_heights && full.control);
  EXPECT_EQ(full.sloping, 8);
  EXPECT_GT(full.widest, 15.0 * deg);

  const FlightShape one_way = shape_of_flight({{0.0, 0.0}, {0.0, 40.0}}, 4);
  EXPECT_EQ(one_way.lines, 2);
  EXPECT_FALSE(one_way.opposite || one_way.crossed || one_way.beside || one_way.two_heights || one_way.control);

  const FlightShape level = shape_of_flight({{0.0, 0.0}, {180.0 * deg, 0.0}}, 0);
  EXPECT_TRUE(level.opposite);
  EXPECT_FALSE(level.crossed);
  EXPECT_EQ(level.sloping, 0);

  EXPECT_EQ(shape_of_flight({{0.0, 0.0}}, 4).lines, 1);
}

// Unknowns roll and pitch of free start values, with sigmas in limits of 0.005 deg and a correlation.
std::vector<Finding> two(double roll, double pitch, double correlation, const FlightShape& shape) {
  const double limit = 0.005 * deg;
  Eigen::Matrix2d C;
  C << roll * roll, roll * pitch * correlation, roll * pitch * correlation, pitch * pitch;
  C *= limit * limit;
  Separation s;
  s.information = C.inverse();
  s.formal = C.diagonal().cwiseSqrt();
  return diagnose({boresight_roll, boresight_pitch}, s, VectorXd::Constant(2, std::numeric_limits<double>::infinity()), shape, {});
}

TEST(Diagnosis, WellDeterminedSaysNothing) { EXPECT_TRUE(two(0.3, 0.5, 0.6, {8, true, true, true, true, true, 9, 9, 0.4}).empty()); }

TEST(Diagnosis, OneDirection) {
  const auto found = two(0.3, 500.0, 0.0, {2, false, false, false, false, false, 9, 9, 0.4});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found[0].refuses);
  EXPECT_EQ(found[0].parameters, std::vector<Parameter>{boresight_pitch});
  EXPECT_EQ(found[0].what, "boresight pitch and along-track shift cannot be separated: only one line direction");
  EXPECT_EQ(found[0].cure, "fly one line in the opposite direction over the same buildings");
}

TEST(Diagnosis, LevelGround) {
  const auto found = two(0.3, 500.0, 0.0, {4, true, true, false, false, false, 0, 9, 0.4});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NE(found[0].what.find("no sloping planes or walls"), std::string::npos);
  EXPECT_NE(found[0].cure.find("sloping roofs or walls"), std::string::npos);
}

TEST(Diagnosis, ACoarseValueIsNotRefused) {
  // 90 arcsec where a degree was known before: the flight has brought nearly all there is.
  const auto found = two(0.3, 5.0, 0.0, {2, false, false, false, false, false, 9, 9, 0.4});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_FALSE(found[0].refuses);
  EXPECT_EQ(found[0].parameters, std::vector<Parameter>{boresight_pitch});
  EXPECT_EQ(found[0].what.find("boresight pitch is coarse: known to 90 arcsec, where a sigma of 18 arcsec is graded good; "), 0u)
      << found[0].what;
  EXPECT_NE(found[0].what.find("only one line direction"), std::string::npos);
  EXPECT_EQ(found[0].cure, "fly one line in the opposite direction over the same buildings");
}

TEST(Diagnosis, CombinationsAreNamedTogether) {
  const auto found = two(500.0, 500.0, 0.9999, {4, true, false, false, false, false, 3, 9, 0.4});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].parameters, (std::vector<Parameter>{boresight_roll, boresight_pitch}));
  EXPECT_EQ(found[0].what.find("boresight roll and boresight pitch cannot be separated"), 0u);
  EXPECT_TRUE(found[0].refuses);
}

TEST(Diagnosis, WhatTheStartAlreadyTells) {
  // A sigma of 4 mm where 5 mm were known: most of it is not the flight's.
  Separation s;
  s.formal = VectorXd::Constant(1, 0.004);
  s.information = MatrixXd::Constant(1, 1, 1.0 / (0.004 * 0.004) - 1.0 / (0.005 * 0.005));
  const auto found = diagnose({lever_forward}, s, VectorXd::Constant(1, 0.005), {4, true, true, true, true, true, 9, 9, 0.4}, {});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found[0].refuses);
}

TEST(Diagnosis, RestingOnPositionsIsACaution) {
  Separation s;
  s.formal = VectorXd::Constant(1, 0.03);
  s.information = MatrixXd::Constant(1, 1, 1.0 / (0.03 * 0.03));
  s.unaided = VectorXd::Constant(1, 0.9);
  const auto found = diagnose({range_offset}, s, VectorXd::Constant(1, 1.0), {4, true, true, true, false, false, 9, 9, 0.4}, {});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_FALSE(found[0].refuses);
  EXPECT_NE(found[0].what.find("rests on the trajectory's positions alone"), std::string::npos);
  EXPECT_NE(found[0].what.find("common error of height"), std::string::npos);
}

TEST(Diagnosis, Condition) {
  EXPECT_DOUBLE_EQ(scaled_condition(Eigen::Vector2d(1e12, 1e-6).asDiagonal()), 1.0);
  Eigen::Matrix2d N;
  N << 4.0, 1.8, 1.8, 1.0;
  EXPECT_NEAR(scaled_condition(N), 1.9 / 0.1, 1e-9);
  N << 1.0, 1.0, 1.0, 1.0;
  EXPECT_TRUE(std::isinf(scaled_condition(N)));
}

TEST(Diagnosis, EveryParameterHasALimit) {
  for (int k = boresight_roll; k <= latency; ++k) EXPECT_GT(limit_of({}, static_cast<Parameter>(k)), 0.0);
}

}  // namespace
}  // namespace swath::calib
