// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/error_state.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "tests/world/navigation.h"

namespace swath::trajectory {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const Layout everything(true, true, true, true, true);

/// Size of each error at which differences are taken.
StateVector sizes(const Layout& l) {
  StateVector s = StateVector::Zero(l.size);
  const auto put = [&s](int row, int rows, double size) {
    if (row >= 0) s.segment(row, rows).setConstant(size);
  };
  put(l.position, 3, 1000.0), put(l.velocity, 3, 10.0), put(l.attitude, 3, 0.01), put(l.gyro_bias, 3, 1e-4), put(l.force_bias, 3, 1e-2);
  put(l.gyro_scale, 3, 0.01), put(l.force_scale, 3, 0.01), put(l.lever, 3, 0.1), put(l.fix, 3, 1.0), put(l.latency, 1, 0.01);
  put(l.track, 2, 0.01);
  return s;
}

/// An estimate somewhere on Earth; `errors`: how large its sensor errors are against those of an industrial MEMS.
Estimate estimate(std::uint64_t seed, double errors) {
  test::Dice dice(seed);
  Estimate e;
  e.nav.time = 100.0;
  e.nav.position = core::ecef_of({1.2 * (dice.uniform() - 0.5), 6 * (dice.uniform() - 0.5), 3000 * dice.uniform()});
  e.nav.velocity = 40 * dice.vector();
  e.nav.ecef_R_body = core::exp_so3(dice.vector());
  e.gyro_bias = errors * 5e-5 * dice.vector();
  e.force_bias = errors * 0.03 * dice.vector();
  e.gyro_scale = errors * 1e-3 * dice.vector();
  e.force_scale = errors * 1e-3 * dice.vector();
  e.lever = dice.vector();
  e.fix = dice.vector();
  e.latency = errors * 0.005 * dice.normal();
  e.track = errors * 0.02 * Eigen::Vector2d(dice.normal(), dice.normal());
  return e;
}

/// A quarter of a second at 200 Hz: turning by 0.3 rad/s, 1 g and gusts; or hardly anything.
std::vector<Increment> motion(std::uint64_t seed, double size, double direction) {
  test::Dice dice(seed + 1000);
  const Vector3d rate = 0.3 * dice.vector(), force = 9.8 * dice.vector().normalized();
  std::vector<Increment> out;
  for (int k = 0; k < 50; ++k) {
    const double step = 0.005 * direction;
    out.push_back({step * size * (rate + 0.05 * dice.vector()), step * size * (force + dice.vector()), step});
  }
  return out;
}

Estimate carried(const Layout& l, Estimate e, const std::vector<Increment>& increments, const ProcessNoise& noise) {
  Propagation p(l, e);
  for (const Increment& i : increments) p.add(i);
  e.nav = p.nav();
  e.fix *= std::exp(-std::abs(p.elapsed()) / noise.fix_time);
  return e;
}

void expect_transition(const Layout& l, const Estimate& e, const std::vector<Increment>& increments, double tolerance,
                       const std::string& what) {
  const ProcessNoise noise;
  Propagation p(l, e);
  for (const Increment& i : increments) p.add(i);
  const StateMatrix phi = p.transition(noise);
  const StateVector size = sizes(l);
  for (int j = 0; j < l.size; ++j) {
    StateVector step = StateVector::Zero(l.size);
    step[j] = size[j];
    Estimate plus = e, minus = e;
    plus.correct(l, step);
    minus.correct(l, -step);
    const StateVector column = carried(l, plus, increments, noise).minus(carried(l, minus, increments, noise), l) / 2;
    // Beside the identity, which would hide the rest; a position of 6e6 m holds 1e-9 m.
    for (int i = 0; i < l.size; ++i) {
      const double itself = i == j ? size[j] : 0.0, expected = phi(i, j) * size[j] - itself;
      const double floor = tolerance * (i < 3 ? 2e-3 : i < 6 ? 1e-3 : i < 9 ? 1e-5 : 1e-6);
      const double relative = j < 3 ? 0.01 : tolerance;  // the gravity gradient itself is good to 0.7 %
      EXPECT_NEAR(column[i] - itself, expected, floor + relative * std::abs(expected)) << what << ": row " << i << ", column " << j;
    }
  }
}

// The terms of second order left out: half of a step's turn (1e-3) of its share, (1 + scale) of the sensors, Earth rate over the interval.
constexpr double by_differences = 2e-3;

TEST(ErrorState, TransitionIsTheDerivative) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed)
    for (const double direction : {1.0, -1.0})
      expect_transition(everything, estimate(seed, 1.0), motion(seed, 1.0, direction), by_differences,
                        "seed " + std::to_string(seed) + (direction > 0 ? " onward" : " back"));
}

TEST(ErrorState, TransitionNearZero) {
  expect_transition(everything, estimate(7, 0.0), motion(7, 1e-6, 1.0), by_differences, "hardly moving");
  expect_transition(everything, estimate(8, 1e-3), motion(8, 1.0, 1.0), by_differences, "hardly an error");
  expect_transition(everything, estimate(8, 0.0), {}, 1e-9, "no time at all");
}

TEST(ErrorState, TransitionWithFewerStates) {
  expect_transition(Layout(), estimate(2, 1.0), motion(2, 1.0, 1.0), by_differences, "fifteen");
  expect_transition(Layout(false, true, false, true, false), estimate(3, 1.0), motion(3, 1.0, 1.0), by_differences, "lever, latency");
}

TEST(ErrorState, LayoutTakesRowsInTurn) {
  EXPECT_EQ(Layout().size, 15);
  EXPECT_EQ(everything.size, most_states);
  const Layout some(false, true, false, true, false);
  EXPECT_EQ(some.gyro_scale, -1);
  EXPECT_EQ(some.lever, 15);
  EXPECT_EQ(some.fix, -1);
  EXPECT_EQ(some.latency, 18);
  EXPECT_EQ(some.track, -1);
  EXPECT_EQ(some.size, 19);
}

TEST(ErrorState, CorrectAndMinusAreInverse) {
  for (const Layout& l : {everything, Layout(), Layout(true, false, true, false, true)})
    for (const double factor : {1.0, 1e-6}) {
      test::Dice dice(5);
      const Estimate from = estimate(4, 1.0);
      StateVector e = sizes(l);
      for (int i = 0; i < l.size; ++i) e[i] *= factor * dice.normal();
      e.segment<3>(Layout::attitude) *= 100;  // up to some rad
      Estimate to = from;
      to.correct(l, e);
      const StateVector back = to.minus(from, l);
      // Positions of 6e6 m round at 1e-9 m.
      for (int i = 0; i < l.size; ++i) EXPECT_NEAR(back[i], e[i], i < 3 ? 4e-9 : 2e-14 + 1e-11 * std::abs(e[i])) << i;
      // What the layout does not hold stays.
      if (l.lever < 0) {
        EXPECT_EQ(to.lever, from.lever);
      }
      if (l.latency < 0) {
        EXPECT_EQ(to.latency, from.latency);
      }
    }
}

TEST(ErrorState, CorrectedTakesOutWhatTheSensorsAdd) {
  const Estimate e = estimate(6, 10.0);
  const Increment truth{Vector3d(0.002, -0.001, 0.003), Vector3d(0.01, 0.02, -0.05), 0.005};
  Increment measured = truth;
  measured.angle = truth.angle.cwiseProduct(Vector3d::Ones() + e.gyro_scale) + truth.step * e.gyro_bias;
  measured.velocity = truth.velocity.cwiseProduct(Vector3d::Ones() + e.force_scale) + truth.step * e.force_bias;
  EXPECT_LT((e.corrected(measured).angle - truth.angle).norm(), 1e-17);
  EXPECT_LT((e.corrected(measured).velocity - truth.velocity).norm(), 1e-16);
  EXPECT_EQ(e.corrected(measured).step, truth.step);
}

TEST(ErrorState, NoiseOfAModelAndOfAnInterval) {
  const core::ImuErrorModel model = core::error_model_of(core::ImuGrade::tactical);
  const ProcessNoise noise = ProcessNoise::of(model, 100.0);
  EXPECT_DOUBLE_EQ(noise.angle, std::pow(0.01 * core::degree / 60, 2));
  // The increments' variance of a Gauss-Markov process over t << tau is 2 sigma^2 t / tau.
  const double t = 1.0, sigma = model.gyro_drift.value;
  EXPECT_NEAR(noise.gyro_drift * t / (2 * sigma * sigma * (1 - std::exp(-t / model.drift_time.value))), 1.0, 1e-3);
  Propagation p(everything, estimate(1, 0.0));
  for (const Increment& i : motion(1, 1.0, -1.0)) p.add(i);
  const StateVector q = p.gained(noise);
  EXPECT_NEAR(q[Layout::attitude], 0.25 * noise.angle, 1e-12 * noise.angle);
  EXPECT_NEAR(q[Layout::velocity + 2], 0.25 * noise.velocity, 1e-12 * noise.velocity);
  EXPECT_NEAR(q[Layout::force_bias + 1], 0.25 * noise.force_drift, 1e-12 * noise.force_drift);
  EXPECT_EQ(q[Layout::position], 0.0);
  EXPECT_EQ(q[everything.lever], 0.0);
  // The correlated part keeps the variance 1: exp(-t/tau)^2 + q = 1.
  const double kept = p.transition(noise)(everything.fix, everything.fix);
  EXPECT_NEAR(kept, std::exp(-0.25 / 100), 1e-12);
  EXPECT_NEAR(kept * kept + q[everything.fix + 2], 1.0, 1e-12);
  // What a bridge adds is not by time.
  const StateVector wide = p.gained(noise, {0.1, 0.04, 36.0});
  EXPECT_NEAR(wide[Layout::attitude] - q[Layout::attitude], 0.04, 1e-9);
  EXPECT_NEAR(wide[Layout::velocity] - q[Layout::velocity], 36.0, 1e-9);
  EXPECT_EQ(wide[Layout::gyro_bias], q[Layout::gyro_bias]);
}

}  // namespace
}  // namespace swath::trajectory
