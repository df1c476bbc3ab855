// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/smooth_spline.h"

#include <gtest/gtest.h>

#include <cmath>

#include "simulate/random.h"

namespace swath::simulate {
namespace {

using Row = SmoothSpline::Row;

struct Samples {
  std::vector<double> time;
  std::vector<Row> values;
};

/// `function` at about 200 Hz.
template <class F>
Samples sampled(double duration, F function) {
  Samples s;
  Random random(1, 2, 3);
  for (double t = 0; t < duration; t += 0.005) {
    s.time.push_back(t + random.uniform(0, 0.001));
    s.values.push_back(Row::Constant(function(s.time.back())));
  }
  return s;
}

TEST(SmoothSpline, ReproducesPolynomialsThatThePenaltyPasses) {
  const Samples s = sampled(3.0, [](double t) { return 7 + 2 * t - 0.5 * t * t; });
  const SmoothSpline spline(s.time, s.values, 0.1);
  for (double t = s.time.front(); t < s.time.back(); t += 0.013) {
    const SmoothSpline::At at = spline.at(t);
    EXPECT_NEAR(at.value[0], 7 + 2 * t - 0.5 * t * t, 1e-10);
    EXPECT_NEAR(at.rate[3], 2 - t, 1e-8);
    EXPECT_NEAR(at.acceleration[5], -1, 1e-6);
  }
}

TEST(SmoothSpline, FollowsSlowMotionAndSmoothsNoiseAway) {
  const double w = 2 * 3.14159265 * 0.5;  // 0.5 Hz, 20 knots a period
  Random noise(4, 5, 6);
  Samples s = sampled(20.0, [&](double t) { return std::sin(w * t); });
  const SmoothSpline clean(s.time, s.values, 0.1);
  for (Row& row : s.values) row.array() += 0.01 * noise.normal();
  const SmoothSpline spline(s.time, s.values, 0.1);
  double square = 0;
  int n = 0;
  for (double t = 1; t < 19; t += 0.01, ++n) {
    EXPECT_NEAR(clean.at(t).value[0], std::sin(w * t), 2e-6);
    EXPECT_NEAR(clean.at(t).rate[0], w * std::cos(w * t), 1e-4);
    square += std::pow(spline.at(t).value[0] - std::sin(w * t), 2);
  }
  // 20 samples a knot: 1 / 20 of the variance is left.
  EXPECT_NEAR(std::sqrt(square / n), 0.01 / std::sqrt(20.0), 0.0004);
}

TEST(SmoothSpline, DerivativesAreItsOwnAndHaveNoJumps) {
  Random noise(7, 8, 9);
  const Samples s = sampled(5.0, [&](double) { return noise.normal(); });
  const SmoothSpline spline(s.time, s.values, 0.1);
  constexpr double h = 1e-5;
  for (double t = 0.1; t < 4.9; t += 0.0501) {
    const auto before = spline.at(t - h), at = spline.at(t), after = spline.at(t + h);
    EXPECT_NEAR((after.value[1] - before.value[1]) / (2 * h), at.rate[1], 1e-4) << t;
    EXPECT_NEAR((after.rate[1] - before.rate[1]) / (2 * h), at.acceleration[1], 1e-2) << t;
  }
}

TEST(SmoothSpline, BridgesGaps) {
  Samples s = sampled(6.0, [](double t) { return std::sin(t); });
  Samples cut;
  for (size_t i = 0; i < s.time.size(); ++i)
    if (s.time[i] < 2.0 || s.time[i] > 2.8) {
      cut.time.push_back(s.time[i]);
      cut.values.push_back(s.values[i]);
    }
  const SmoothSpline spline(cut.time, cut.values, 0.1);
  for (double t = 2.0; t < 2.8; t += 0.05) EXPECT_NEAR(spline.at(t).value[2], std::sin(t), 0.01);  // eight knots without a sample
}

}  // namespace
}  // namespace swath::simulate
