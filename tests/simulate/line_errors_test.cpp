// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/line_errors.h"

#include <gtest/gtest.h>

#include <cmath>

namespace swath::simulate {
namespace {

const std::vector<Line> lines{{1, "a", 10.0, 30.0}, {2, "b", 75.0, 100.0}, {7, "c", 160.0, 190.0}};

NoiseOptions noise() {
  NoiseOptions n;
  n.line_shift = core::Metres(0.08);
  n.line_drift = core::Metres(0.05);
  n.line_attitude = core::degrees(0.01);
  n.line_attitude_drift = core::degrees(0.004);
  return n;
}

TEST(LineErrors, AreStraightWithinALine) {
  const LineErrors e(noise(), lines, 3);
  ASSERT_EQ(e.draws().size(), 3u);
  for (size_t i = 0; i < lines.size(); ++i)
    for (size_t k = 0; k < 6; ++k) {
      const double shift = e.draws()[i].shift[k], drift = e.draws()[i].drift[k], length = lines[i].end - lines[i].start;
      EXPECT_NE(shift, 0.0);
      EXPECT_NEAR(e.at(lines[i].start).value[k], shift - 0.5 * drift, 1e-15);
      EXPECT_NEAR(e.at(0.5 * (lines[i].start + lines[i].end)).value[k], shift, 1e-15);
      EXPECT_NEAR(e.at(lines[i].end).value[k], shift + 0.5 * drift, 1e-15);
      EXPECT_NEAR(e.at(lines[i].start + 0.3 * length).value[k], shift - 0.2 * drift, 1e-15);
      EXPECT_NEAR(e.at(lines[i].start + 0.3 * length).rate[k], drift / length, 1e-15);
    }
}

TEST(LineErrors, RatesAreDerivativesAndNothingJumps) {
  const LineErrors e(noise(), lines, 5);
  constexpr double h = 1e-4;
  for (double t = -20.0; t < 230.0; t += 0.37)
    for (size_t k = 0; k < 6; ++k) EXPECT_NEAR((e.at(t + h).value[k] - e.at(t - h).value[k]) / (2 * h), e.at(t).rate[k], 1e-7) << t;
  // Value, slope and curvature (second differences) meet at both ends of every line.
  for (const Line& l : lines)
    for (const double t : {l.start, l.end})
      for (size_t k = 0; k < 6; ++k) {
        EXPECT_NEAR(e.at(t - 1e-9).value[k], e.at(t + 1e-9).value[k], 1e-10);
        EXPECT_NEAR(e.at(t - 1e-6).rate[k], e.at(t + 1e-6).rate[k], 1e-8);
        const double before = (e.at(t).rate[k] - e.at(t - 1e-3).rate[k]) / 1e-3, after = (e.at(t + 1e-3).rate[k] - e.at(t).rate[k]) / 1e-3;
        EXPECT_NEAR(before, after, 1e-5);
      }
}

TEST(LineErrors, HaveTheSigmasTheyStateEverywhere) {
  constexpr int seeds = 2000;
  for (const double t : {2.0, 10.0, 20.0, 28.0, 40.0, 52.5, 70.0, 87.5, 130.0, 190.0, 200.0}) {
    std::array<double, 6> square{};
    for (int s = 0; s < seeds; ++s) {
      const LineErrors::At at = LineErrors(noise(), lines, s).at(t);
      for (size_t k = 0; k < 6; ++k) square[k] += std::pow(at.value[k] / at.sigma[k], 2) / seeds;
    }
    for (const double v : square) EXPECT_NEAR(v, 1.0, 5 * std::sqrt(2.0 / seeds)) << t;
  }
  const LineErrors::At middle = LineErrors(noise(), lines, 1).at(20.0);
  EXPECT_NEAR(middle.sigma[0], 0.08, 1e-12);
  EXPECT_NEAR(middle.sigma[5], 0.01 * core::degree, 1e-12);
  EXPECT_NEAR(LineErrors(noise(), lines, 1).at(30.0).sigma[2], std::hypot(0.08, 0.025), 1e-12);
}

TEST(LineErrors, DoNotGrowOutsideTheLines) {
  for (int seed = 0; seed < 20; ++seed) {
    const LineErrors e(noise(), lines, seed);
    for (const double t : {-2000.0, 1e4})
      for (size_t k = 0; k < 3; ++k) EXPECT_LT(std::abs(e.at(t).value[k]), 6 * std::hypot(0.08, 0.05));
  }
}

TEST(LineErrors, NoneWithoutOptionsOrNoise) {
  for (const double v : LineErrors({}, lines, 3).at(20.0).value) EXPECT_EQ(v, 0.0);
  NoiseOptions free = noise();
  free.noise_free = true;
  for (const double v : LineErrors(free, lines, 3).at(20.0).value) EXPECT_EQ(v, 0.0);
}

}  // namespace
}  // namespace swath::simulate
