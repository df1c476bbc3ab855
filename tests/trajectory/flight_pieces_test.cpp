// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/flight_pieces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/trajectory/made_flight.h"

namespace swath::trajectory {
namespace {

constexpr double turn_rate = 0.0087;

/// 60 s at rest, 100 s north at 50 m/s, a half turn at 4 deg/s, 100 s south; 1 Hz, 2 cm.
PointFixes there_and_back() {
  test::MadeFlight random(1);
  PointFixes out;
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  for (int t = 0; t < 305; ++t) {
    const double course = t < 160 ? 0.0 : std::min((t - 160) * 4.0, 180.0) * std::numbers::pi / 180.0;
    if (t > 60) p += 50.0 * Eigen::Vector3d(std::sin(course), std::cos(course), 0.0);
    out.time.push_back(t);
    out.position.push_back(p + 0.02 * Eigen::Vector3d(random.normal(), random.normal(), random.normal()));
    out.covariance.push_back(4e-4 * Eigen::Matrix3d::Identity());
  }
  return out;
}

void expect_covers(const std::vector<FlightPiece>& pieces, size_t n) {
  size_t at = 0;
  for (const FlightPiece& p : pieces) {
    EXPECT_EQ(p.first, at);
    EXPECT_GT(p.end, p.first);
    at = p.end;
  }
  EXPECT_EQ(at, n);
}

TEST(FlightPieces, StandsStraightPiecesAndTurnsByCourse) {
  const PointFixes fixes = there_and_back();
  const std::vector<FlightPiece> pieces = pieces_by_course(fixes, turn_rate, 2.5);
  expect_covers(pieces, fixes.size());
  ASSERT_EQ(pieces.size(), 4u);
  const PieceKind kinds[] = {PieceKind::standing, PieceKind::straight, PieceKind::turn, PieceKind::straight};
  constexpr double edge = 6.0;  // fixes: the course is that of five seconds
  const double ends[] = {60, 160, 206, 305};
  for (size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(pieces[k].kind, kinds[k]) << k;
    EXPECT_NEAR(static_cast<double>(pieces[k].end), ends[k], edge) << k;
  }
  EXPECT_EQ(pieces[1].name(1), "straight 1, 0 deg");
  EXPECT_EQ(pieces[3].name(2), "straight 2, 180 deg");
}

TEST(FlightPieces, TurbulenceIsNotATurnAndAGapEndsAPiece) {
  PointFixes fixes = test::MadeFlight(6).fixes(200, 1.0);
  EXPECT_EQ(pieces_by_course(fixes, turn_rate, 2.5).size(), 1u);
  for (size_t i = 100; i < fixes.size(); ++i) fixes.time[i] += 30.0;
  const auto pieces = pieces_by_course(fixes, turn_rate, 2.5);
  expect_covers(pieces, fixes.size());
  ASSERT_GE(pieces.size(), 2u);
  EXPECT_TRUE(std::any_of(pieces.begin(), pieces.end(), [](const FlightPiece& p) { return p.first == 100; }));
}

TEST(FlightPieces, StatedLinesHaveTheirNumber) {
  const PointFixes fixes = test::MadeFlight(7).fixes(100, 1.0);
  const auto pieces = pieces_by_line(fixes, {{3, 9.5, 40.5}, {4, 40.6, 70.5}});
  expect_covers(pieces, fixes.size());
  ASSERT_EQ(pieces.size(), 4u);
  EXPECT_EQ(pieces[1].name(0), "line 3");
  EXPECT_EQ(pieces[2].name(0), "line 4");
  EXPECT_EQ(pieces[0].name(0), "turns");
}

TEST(FlightPieces, LevelsHoldForAMinuteOrSo) {
  const PointFixes fixes = test::MadeFlight(8).fixes(400, 1.0);
  const auto level = level_pieces(fixes, pieces_by_course(fixes, turn_rate, 2.5));
  EXPECT_EQ(level.size(), 7u);
  EXPECT_EQ(level.front(), 0u);
  for (size_t k = 1; k < level.size(); ++k) EXPECT_GE(level[k] - level[k - 1], 20u);
  // Short pieces are joined; the last is never a stump.
  const auto joined = level_pieces(fixes, pieces_by_line(fixes, {{1, 30.0, 35.0}, {2, 390.0, 400.0}}));
  for (size_t k = 1; k < joined.size(); ++k) EXPECT_GE(joined[k] - joined[k - 1], 20u);
  EXPECT_GE(fixes.size() - joined.back(), 20u);
  EXPECT_EQ(level_pieces(test::MadeFlight(8).fixes(5, 1.0), {{PieceKind::straight, 0, 5}}), std::vector<size_t>{0});
}

}  // namespace
}  // namespace swath::trajectory
