// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/shift_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "core/config/units.h"

namespace swath::calib {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double height = 700.0;

// Level flight by an azimuth: how a point across the track moves, m/rad.
Matrix3d by_boresight(double azimuth, double across) {
  const Vector3d along(std::sin(azimuth), std::cos(azimuth), 0.0), right(std::cos(azimuth), -std::sin(azimuth), 0.0);
  Matrix3d J;
  J.col(0) = -height * right + across * Vector3d::UnitZ() * -1.0;
  J.col(1) = height * along;
  J.col(2) = -across * along;
  return J;
}

struct Line {
  double azimuth, offset;
};

/// Shifts between all pairs of lines at places across the block; each line with its own errors.
std::vector<ObservedShift> shifts_of(const std::vector<Line>& lines, const Vector3d& error, const LineErrors& sigma, bool relief,
                                     unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::map<size_t, std::pair<Vector3d, Vector3d>> of;
  for (size_t l = 0; l < lines.size(); ++l)
    of[l] = {Vector3d(sigma.horizontal * normal(random), sigma.horizontal * normal(random), sigma.height * normal(random)),
             sigma.attitude * Vector3d(normal(random), normal(random), normal(random))};
  std::vector<ObservedShift> out;
  std::uniform_real_distribution<double> place(-200.0, 200.0);
  for (std::uint64_t square = 0; square < 60; ++square) {
    const double x = place(random), y = place(random);
    // What each line saw there, with its own noise, so that pairs of a square are not independent.
    std::vector<Vector3d> seen;
    std::vector<Matrix3d> by;
    for (size_t l = 0; l < lines.size(); ++l) {
      by.push_back(by_boresight(lines[l].azimuth, std::cos(lines[l].azimuth) * x - std::sin(lines[l].azimuth) * y - lines[l].offset));
      seen.push_back(by[l] * (error + of[l].second) + of[l].first +
                     Vector3d(0.1 * normal(random), 0.1 * normal(random), 0.03 * normal(random)));
    }
    for (size_t a = 0; a < lines.size(); ++a)
      for (size_t b = a + 1; b < lines.size(); ++b) {
        ObservedShift s;
        s.line_a = static_cast<int>(a), s.line_b = static_cast<int>(b), s.look_a = a, s.look_b = b, s.square = square;
        s.by_a = by[a], s.by_b = by[b];
        s.shift = seen[b] - seen[a];
        s.relief = relief;
        s.covariance = Vector3d(relief ? 0.02 : 1e12, relief ? 0.02 : 1e12, 0.0018).asDiagonal();
        if (square % 10 == 0 && relief) s.shift.x() += 4.0;  // one in ten matched the wrong house
        out.push_back(s);
      }
  }
  return out;
}

const std::vector<Line> four{{0.0, 0.0}, {core::pi, 0.0}, {core::pi / 2, 0.0}, {0.0, 150.0}};
constexpr LineErrors line_errors{0.05, 0.05, 5e-5};

TEST(ShiftFit, ErrorsAgreeWithTheirSigmas) {
  const Vector3d error(1e-3, -2e-3, 1.5e-3);
  Vector3d squares = Vector3d::Zero();
  constexpr int seeds = 60;
  for (unsigned seed = 0; seed < seeds; ++seed) {
    auto shifts = shifts_of(four, error, line_errors, true, seed);
    const ShiftFit3 f = fit_shifts(shifts, line_errors, 2e-3, 6e-3);
    ASSERT_TRUE(f.determined[0] && f.determined[1] && f.determined[2]);
    squares += (f.error - error).cwiseQuotient(f.sigma).cwiseAbs2() / seeds;
    for (const ObservedShift& s : shifts)
      if (s.square % 10 == 0) {
        EXPECT_LT(s.weight, 0.1) << "a wrong match";
      }
  }
  for (int k = 0; k < 3; ++k) {
    EXPECT_GT(std::sqrt(squares[k]), 0.6) << k;  // robust weights leave the sigma on the safe side
    EXPECT_LT(std::sqrt(squares[k]), 1.3) << k;
  }
}

TEST(ShiftFit, LevelGroundTellsRollAlone) {
  auto shifts = shifts_of(four, {1e-3, 0.0, 0.0}, line_errors, false, 3);
  const ShiftFit3 f = fit_shifts(shifts, line_errors, 2e-3, 6e-3);
  EXPECT_TRUE(f.determined[0]);
  EXPECT_FALSE(f.determined[1] || f.determined[2]);
  EXPECT_EQ(f.error[1], 0.0);
  EXPECT_TRUE(std::isinf(f.sigma[1]));
  EXPECT_NEAR(f.error[0], 1e-3, 4.0 * f.sigma[0]);
}

TEST(ShiftFit, ASingleDirectionLeavesPitch) {
  const std::vector<Line> same{{0.0, 0.0}, {0.0, 150.0}};
  auto shifts = shifts_of(same, {1e-3, 1e-3, 1e-3}, line_errors, true, 3);
  const ShiftFit3 f = fit_shifts(shifts, line_errors, 2e-3, 6e-3);
  EXPECT_FALSE(f.determined[1]);
  EXPECT_TRUE(f.determined[2]);
  EXPECT_NEAR(f.error[2], 1e-3, 4.0 * f.sigma[2]);
}

TEST(ShiftFit, WithoutShiftsNothingIsDetermined) {
  std::vector<ObservedShift> none;
  const ShiftFit3 f = fit_shifts(none, line_errors, 2e-3, 6e-3);
  EXPECT_FALSE(f.determined[0] || f.determined[1] || f.determined[2]);
  EXPECT_EQ(f.error, Vector3d::Zero());
}

}  // namespace
}  // namespace swath::calib
