// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/imu_walk.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "tests/world/navigation.h"

namespace swath::trajectory {
namespace {

using Eigen::Vector3d;

/// Records of random motion about 1 g; `start` at 1.4e9 s as in a survey.
core::ImuData made(size_t n, double step, double start = test::motion_start) {
  test::Dice dice(1);
  core::ImuData imu;
  for (size_t k = 0; k < n; ++k) {
    imu.time.push_back(start + static_cast<double>(k + 1) * step);
    imu.step.push_back(step);
    imu.angle.push_back(0.1 * step * dice.vector());
    imu.velocity.push_back(step * (Vector3d(0, 0, -9.8) + dice.vector()));
  }
  return imu;
}

/// Leaves out records [first, last).
core::ImuData cut(core::ImuData imu, size_t first, size_t last) {
  const auto erase = [&](auto& v) { v.erase(v.begin() + static_cast<long>(first), v.begin() + static_cast<long>(last)); };
  erase(imu.time), erase(imu.step), erase(imu.angle), erase(imu.velocity);
  return imu;
}

struct Sum {
  Vector3d angle = Vector3d::Zero(), velocity = Vector3d::Zero();
  double time = 0;
  size_t pieces = 0;

  void walk(ImuWalk& w, double until) {
    Increment piece;
    while (w.next(until, piece)) {
      angle += piece.angle;
      velocity += piece.velocity;
      time += piece.step;
      ASSERT_LT(++pieces, 1000000u) << "the walk hangs";
    }
  }
};

TEST(ImuWalk, CutAnywhereItComposesToTheWhole) {
  const ImuPath path = make_path(made(400, 0.005), 1.0);
  Sum whole;
  for (size_t k = 0; k < path.imu.size(); ++k) {
    const Increment i = increment_of(path.imu, k);
    whole.angle += i.angle;
    whole.velocity += i.velocity;
    whole.time += i.step;
  }
  test::Dice dice(2);
  std::vector<double> instants;
  for (int i = 0; i < 300; ++i) instants.push_back(path.begin() + dice.uniform() * (path.end() - path.begin()));
  for (int i = 0; i < 50; ++i) instants.push_back(path.imu.time[static_cast<size_t>(8 * i)]);
  std::sort(instants.begin(), instants.end());
  // The times' last place of 2.4e-7 s at 0.2 rad/s and 12 m/s^2.
  constexpr double last_place = 2.4e-7;
  ImuWalk onward(path, path.begin());
  Sum there;
  for (const double t : instants) {
    there.walk(onward, t);
    EXPECT_NEAR(onward.time(), t, 1e-6);
  }
  there.walk(onward, path.end());
  EXPECT_GT(there.pieces, 650u);
  EXPECT_LT((there.angle - whole.angle).norm(), 0.2 * last_place);
  EXPECT_LT((there.velocity - whole.velocity).norm(), 12 * last_place);
  EXPECT_NEAR(there.time, whole.time, last_place);
  constexpr double rounding = 1e-12;
  Sum back;
  for (auto t = instants.rbegin(); t != instants.rend(); ++t) back.walk(onward, *t);
  back.walk(onward, path.begin());
  EXPECT_LT((back.angle + there.angle).norm(), rounding);
  EXPECT_LT((back.velocity + there.velocity).norm(), rounding);
  EXPECT_NEAR(back.time, -there.time, rounding);
}

TEST(ImuWalk, BeginsAnywhereAndStaysWithinTheRecord) {
  const ImuPath path = make_path(made(100, 0.01), 1.0);
  for (const double at : {-5.0, 0.0, 0.0049, 0.333, 0.5, 1.0, 7.0}) {
    ImuWalk walk(path, path.begin() + at);
    EXPECT_NEAR(walk.time(), path.begin() + std::clamp(at, 0.0, 1.0), 1e-9);
    Sum sum;
    sum.walk(walk, path.end() + 100);
    EXPECT_NEAR(sum.time, 1.0 - std::clamp(at, 0.0, 1.0), 1.01e-6) << at;
    sum = {};
    sum.walk(walk, path.begin() - 100);
    EXPECT_NEAR(sum.time, -1.0, 1.01e-6) << at;
  }
}

TEST(ImuWalk, TimesAtTheResolutionOfGpsSecondsNeverHang) {
  // 1 kHz, stamps that jitter by the last place of the double, goals that lie one place beside a stamp.
  core::ImuData imu = made(3000, 0.001);
  for (size_t k = 0; k < imu.size(); ++k)
    for (size_t i = 0; i < k % 5; ++i) imu.time[k] = std::nextafter(imu.time[k], k % 2 ? 0.0 : 2e9);
  const ImuPath path = make_path(imu, 1.0);
  for (const int direction : {1, -1})
    for (int places = -6; places <= 6; ++places) {
      ImuWalk walk(path, direction > 0 ? path.begin() : path.end());
      Sum sum;
      for (size_t i = 0; i < path.imu.size(); i += 7) {
        double goal = path.imu.time[direction > 0 ? i : path.imu.size() - 1 - i];
        for (int p = 0; p < std::abs(places); ++p) goal = std::nextafter(goal, places > 0 ? 2e9 : 0.0);
        sum.walk(walk, goal);
        ASSERT_NEAR(walk.time(), std::clamp(goal, path.begin(), path.end()), 1.01e-6);
      }
      EXPECT_LT(sum.pieces, 2 * path.imu.size());
      EXPECT_GT(std::abs(sum.time), 2.98);
    }
}

TEST(ImuWalk, StepsBecomeTheDifferencesOfTimes) {
  core::ImuData imu = made(50, 0.005);
  imu.time[20] += 0.0005;  // jitter is no gap
  const ImuPath path = make_path(imu, 1.0);
  EXPECT_TRUE(path.gaps.empty());
  EXPECT_TRUE(path.bridged.empty());
  EXPECT_EQ(path.bridged_within(path.begin(), path.end()).seconds, 0.0);
  for (size_t k = 1; k < path.imu.size(); ++k) {
    EXPECT_EQ(path.imu.step[k], path.imu.time[k] - path.imu.time[k - 1]);
    EXPECT_EQ(path.edge(k), path.imu.time[k - 1]);
    EXPECT_FALSE(path.is_bridged(k));
  }
  EXPECT_EQ(path.edge(0), path.begin());
}

TEST(ImuWalk, GapsFromAMillisecondToTenSecondsAreBridged) {
  struct Case {
    double rate, gap;
  };
  for (const Case c : {Case{1000, 0.001}, Case{200, 0.005}, Case{200, 0.05}, Case{200, 1.0}, Case{200, 10.0}, Case{100, 9.99}}) {
    const auto missing = static_cast<size_t>(std::lround(c.gap * c.rate));
    const size_t first = 1500;
    core::ImuData imu = cut(made(first + missing + 1500, 1 / c.rate), first, first + missing);
    // Both neighbours turn by 0.2 and 0.4 rad/s about down: the bridge lies between.
    imu.angle[first - 1] = Vector3d(0, 0, 0.2 / c.rate);
    imu.angle[first] = Vector3d(0, 0, 0.4 / c.rate);
    const ImuPath path = make_path(imu, 10.0);
    ASSERT_EQ(path.gaps.size(), 1u) << c.gap;
    EXPECT_NEAR(path.gaps[0].length, c.gap, 1e-6);
    EXPECT_NEAR(path.gaps[0].start, imu.time[first - 1], 1e-6);
    double bridged = 0, turned = 0;
    for (size_t k = 0; k < path.imu.size(); ++k) {
      if (k > 0) {
        EXPECT_NEAR(path.imu.time[k] - path.imu.time[k - 1], path.imu.step[k], 1e-6);
      }
      if (!path.is_bridged(k)) continue;
      bridged += path.imu.step[k];
      turned += path.imu.angle[k].z();
      EXPECT_LE(path.imu.step[k], 0.01 + 1e-9);
    }
    EXPECT_NEAR(bridged, c.gap, 1e-6) << c.gap;
    EXPECT_NEAR(turned, 0.3 * c.gap, 1e-6 * (1 + c.gap)) << c.gap;
    EXPECT_EQ(path.imu.size() - static_cast<size_t>(std::count(path.bridged.begin(), path.bridged.end(), 1)), imu.size());
    const double start = path.gaps[0].start;
    const BridgedGap& g = path.gaps[0];
    const Bridging whole = path.bridged_within(start - 1, start + 20), half = path.bridged_within(start - 1, start + 0.5 * g.length);
    EXPECT_NEAR(whole.seconds, c.gap, 1e-6);
    EXPECT_NEAR(std::sqrt(whole.turn), g.rate_sigma * g.length, 1e-9);
    EXPECT_NEAR(std::sqrt(whole.push), g.force_sigma * g.length, 1e-9);
    EXPECT_NEAR(half.turn / whole.turn, 0.5, 1e-3);
    EXPECT_EQ(path.bridged_within(start - 2, start).turn, 0.0);
    EXPECT_LT(path.bridged_within(start + c.gap, start + c.gap + 1).seconds, 1e-6);
    ImuWalk walk(path, path.begin());
    Sum sum;
    sum.walk(walk, path.end());
    EXPECT_NEAR(sum.time, path.end() - path.begin(), 1e-6);
  }
}

TEST(ImuWalk, ABridgesSigmaIsItsError) {
  // Turbulence of a flight: what bridges over many gaps really miss, against what they say. The lengths span a wave of the motion.
  const test::Records flown = test::exact_records(test::motion_of(test::survey_flight(2)), {.from = 0, .until = 80});
  for (const size_t n : {1u, 10u, 100u, 400u}) {
    double missed = 0, stated = 0, missed_force = 0, stated_force = 0;
    for (size_t at = 2500; at + n < 14000; at += 977) {
      const ImuPath path = make_path(cut(flown.imu, at, at + n), 10.0);
      Vector3d turn = Vector3d::Zero(), push = Vector3d::Zero();
      for (size_t k = 0; k < path.imu.size(); ++k)
        if (path.is_bridged(k)) {
          turn += path.imu.angle[k];
          push += path.imu.velocity[k];
        }
      for (size_t k = at; k < at + n; ++k) {
        turn -= flown.imu.angle[k];
        push -= flown.imu.velocity[k];
      }
      const BridgedGap& g = path.gaps.at(0);
      missed += turn.squaredNorm() / 3;
      stated += std::pow(g.rate_sigma * g.length, 2);
      missed_force += push.squaredNorm() / 3;
      stated_force += std::pow(g.force_sigma * g.length, 2);
    }
    // The worst axis stands for all, with a floor: on the safe side, and not without bounds where the gap is long.
    std::printf("gap of %zu ms: sigma of turn %.2e rad (missed %.2e), of velocity %.2e m/s (%.2e)\n", 5 * static_cast<size_t>(n),
                std::sqrt(stated / 12), std::sqrt(missed / 12), std::sqrt(stated_force / 12), std::sqrt(missed_force / 12));
    EXPECT_LT(missed, 1.5 * stated) << n;
    EXPECT_LT(missed_force, 1.5 * stated_force) << n;
    if (n < 100) continue;
    EXPECT_GT(missed, stated / 36) << n;
    EXPECT_GT(missed_force, stated_force / 36) << n;
  }
}

TEST(ImuWalk, SeveralGapsKeepTheirPlaces) {
  const ImuPath path = make_path(cut(cut(made(1000, 0.005), 700, 900), 100, 104), 10.0);
  ASSERT_EQ(path.gaps.size(), 2u);
  EXPECT_NEAR(path.gaps[0].length, 0.02, 1e-6);
  EXPECT_NEAR(path.gaps[1].length, 1.0, 1e-6);
  EXPECT_NEAR(path.bridged_within(path.begin(), path.end()).seconds, 1.02, 1e-6);
  EXPECT_NEAR(path.bridged_within(path.begin(), path.gaps[1].start).seconds, 0.02, 1e-6);
  EXPECT_NEAR(path.bridged_within(path.gaps[1].start + 0.4, path.end()).seconds, 0.6, 1e-6);
}

TEST(ImuWalk, ALongerGapIsAnErrorWithItsRecord) {
  const core::ImuData imu = cut(made(4000, 0.005), 1000, 3002);
  try {
    make_path(imu, 10.0);
    FAIL() << "a gap of 10.01 s was bridged";
  } catch (const core::Error& e) {
    EXPECT_NE(std::string(e.what()).find("10.01 s"), std::string::npos) << e.what();
    EXPECT_NE(e.where().find("record 1001"), std::string::npos) << e.where();
    EXPECT_NE(e.hint().find("max_gap"), std::string::npos) << e.hint();
  }
  EXPECT_NO_THROW(make_path(imu, 11.0));
}

}  // namespace
}  // namespace swath::trajectory
