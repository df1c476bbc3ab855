// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/files/computer_clock.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace swath::simulate {
namespace {

ClockOptions quiet() {
  ClockOptions o;
  o.jitter = core::Seconds(0.0);
  o.wander = core::Ratio(0.0);
  return o;
}

TEST(ComputerClock, SettlesInTheStatedTime) {
  const ComputerClock clock(quiet(), 600.0, 1);
  double largest = 0;
  for (double t = -900; t < 100; t += 1) largest = std::max(largest, std::abs(clock.offset(t)));
  EXPECT_EQ(clock.offset(-900.0), -0.9e-3);
  EXPECT_GT(largest, 0.5e-3);
  EXPECT_LT(std::abs(clock.offset(100.0)), 40e-6);  // 1000 s after its start
  EXPECT_LT(std::abs(clock.offset(600.0)), 4e-6);
  // At rest the loop's correction has taken the frequency error in.
  EXPECT_NEAR(clock.updates().back().frequency, -quiet().frequency.value, 0.1e-6);
}

TEST(ComputerClock, LogTellsTheOffsetThatMendsTheClock) {
  ClockOptions o;
  o.jitter = core::Seconds(30e-6);
  double square = 0;
  size_t n = 0;
  for (int seed = 1; seed <= 20; ++seed) {
    const ComputerClock clock(o, 3000.0, seed);
    for (const auto& u : clock.updates()) {
      EXPECT_NEAR(clock.offset(u.t), u.clock, 1e-15);
      square += std::pow(u.clock + u.offset, 2);
      ++n;
    }
    // ntpd's jitter is that of differences: sqrt(2) of a measurement's, averaged over some four.
    double jitter = 0;
    int late = 0;
    for (const auto& u : clock.updates())
      if (u.t > 300.0) {
        jitter += u.jitter;
        ++late;
      }
    jitter /= late;
    EXPECT_NEAR(jitter, std::sqrt(2.0) * 30e-6, 12e-6);
  }
  EXPECT_NEAR(std::sqrt(square / static_cast<double>(n)), 30e-6, 2e-6);
}

TEST(ComputerClock, CoversTheFlightAndIsContinuous) {
  const ComputerClock clock({}, 500.0, 2);
  EXPECT_EQ(clock.updates().front().t, -900.0);
  EXPECT_GT(clock.updates().back().t, 500.0);
  for (double t = -890; t < 500; t += 0.5) EXPECT_LT(std::abs(clock.offset(t + 0.5) - clock.offset(t)), 20e-6);
}

}  // namespace
}  // namespace swath::simulate
