// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/frozen_axes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/config/units.h"

namespace swath::io {
namespace {

using Eigen::Vector3d;

constexpr size_t rate = 200;  // Hz

/// Six axes with noise of 6e-4 rad/s and 0.05 m/s2 about the motion, in steps of `digit` noise sigmas; 0: all digits.
struct Made {
  std::vector<Vector3d> gyro, accelerometer;

  explicit Made(size_t n, double digit = 0.0, double noise = 1.0, std::uint32_t seed = 1) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const auto vector = [&](const Vector3d& mean, double sigma) {
      Vector3d v = mean;
      for (double& x : v) {
        x += noise * sigma * normal(random);
        if (digit > 0.0) x = digit * sigma * std::round(x / (digit * sigma));
      }
      return v;
    };
    for (size_t k = 0; k < n; ++k) {
      // A turn of five seconds in every twenty, as smooth as a flight's; between them nothing changes.
      const double t = std::fmod(static_cast<double>(k) / rate, 20.0), bank = t < 5.0 ? std::pow(std::sin(t * core::pi / 5.0), 2) : 0.0;
      gyro.push_back(vector({0.1 * bank, 0.02 * bank, 0.1 * bank}, 6e-4));
      accelerometer.push_back(vector({0.1 * bank, 0.0, -9.8 - bank}, 0.05));
    }
  }
  void freeze(size_t axis, size_t first, size_t last) {
    std::vector<Vector3d>& v = axis < 3 ? gyro : accelerometer;
    const auto c = static_cast<Eigen::Index>(axis % 3);
    for (size_t k = first; k < last; ++k) v[k][c] = v[first - 1][c];
  }
  std::vector<FrozenAxis> found() const { return frozen_axes(gyro, accelerometer); }
};

TEST(FrozenAxes, AnAxisThatStopsIsFoundToTheRecord) {
  for (size_t axis = 0; axis < 6; ++axis)
    for (const size_t length : {20u, 200u, 2000u})
      for (const double digit : {0.0, 0.1, 1.0}) {
        Made made(8000, digit);
        made.freeze(axis, 3000, 3000 + length);
        const std::vector<FrozenAxis> found = made.found();
        ASSERT_EQ(found.size(), 1u) << "axis " << axis << ", " << length << " records, digits of " << digit << " sigmas";
        EXPECT_EQ(found[0].axis, axis);
        // With coarse digits the records beside it may have its value, too.
        EXPECT_LE(found[0].first, 3000u);
        EXPECT_GE(found[0].first, 2995u);
        EXPECT_GE(found[0].last, 3000u + length);
        EXPECT_LE(found[0].last, 3005u + length);
      }
}

TEST(FrozenAxes, AtBothEndsOfARecordAndSeveralAtOnce) {
  Made made(8000);
  made.freeze(0, 1, 200);
  made.freeze(1, 4000, 4300);
  made.freeze(2, 4000, 4300);
  made.freeze(5, 7800, 8000);
  const std::vector<FrozenAxis> found = made.found();
  ASSERT_EQ(found.size(), 4u);
  EXPECT_EQ(found[0].first, 1u);
  EXPECT_EQ(found[1].last, 4300u);
  EXPECT_EQ(found[2].axis, 2u);
  EXPECT_EQ(found[3].last, 8000u);
}

TEST(FrozenAxes, CoarseDigitsAreNone) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed)
    for (const double digit : {0.5, 1.0, 2.0, 4.0, 8.0})
      EXPECT_TRUE(Made(20000, digit, 1.0, seed).found().empty()) << digit << ", seed " << seed;
}

// Records without noise repeat their values wherever the body goes straight on.
TEST(FrozenAxes, MotionWithoutNoiseIsNone) {
  EXPECT_TRUE(Made(20000, 0.0, 0.0).found().empty());
  Made one(20000, 0.0, 0.0);  // beside an axis that never repeats
  for (size_t k = 0; k < one.gyro.size(); ++k) one.gyro[k].y() += 1e-9 * std::sin(0.01 * static_cast<double>(k));
  EXPECT_TRUE(one.found().empty());
}

TEST(FrozenAxes, ARecordThatStopsAsAWholeOrIsShortIsNone) {
  Made all(8000);
  for (size_t axis = 0; axis < 6; ++axis) all.freeze(axis, 3000, 3200);
  EXPECT_TRUE(all.found().empty());
  EXPECT_TRUE(Made(1).found().empty());
  Made few(150);
  few.freeze(0, 60, 90);
  EXPECT_TRUE(few.found().empty());
  EXPECT_TRUE(frozen_axes({}, {}).empty());
}

TEST(StandingAxes, OneValueThroughoutIsFound) {
  for (size_t axis = 0; axis < 6; ++axis)
    for (const double digit : {0.0, 0.1}) {
      Made made(8000, digit);
      made.freeze(axis, 1, 8000);
      EXPECT_TRUE(made.found().empty());  // no record shows how the axis was before
      EXPECT_EQ(standing_axes(made.gyro, made.accelerometer), std::vector<size_t>{axis}) << digit;
    }
  Made two(8000);
  two.freeze(3, 50, 7950);
  two.freeze(4, 1, 8000);
  EXPECT_EQ(standing_axes(two.gyro, two.accelerometer), (std::vector<size_t>{3, 4}));
}

// Noise below the digits, records without noise, a column of zeros beside another such, a body at rest, a few records.
TEST(StandingAxes, CoarseDigitsAndMotionWithoutNoiseAreNone) {
  const auto none = [](const Made& m) { return standing_axes(m.gyro, m.accelerometer).empty(); };
  for (const double digit : {0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 40.0}) EXPECT_TRUE(none(Made(20000, digit))) << digit;
  Made still(20000, 0.0, 0.0);
  EXPECT_TRUE(none(still));  // gyro_x and accelerometer_y of the plain turns are smooth, the others constant
  for (size_t k = 0; k < still.gyro.size(); ++k)
    still.gyro[k] = {std::sin(0.01 * static_cast<double>(k)), 0.0, std::cos(0.01 * static_cast<double>(k))};
  EXPECT_TRUE(none(still));
  Made coarse(20000, 4.0);
  coarse.freeze(1, 1, 20000);
  EXPECT_TRUE(none(coarse)) << "an axis of so few values may show none of its noise";
  Made all(8000);
  for (size_t axis = 0; axis < 6; ++axis) all.freeze(axis, 1, 8000);
  EXPECT_TRUE(none(all));
  Made half(8000);  // noise of one sensor alone is that of a simple simulation
  for (size_t axis = 0; axis < 5; ++axis) half.freeze(axis, 1, 8000);
  EXPECT_TRUE(none(half));
  Made few(500);
  few.freeze(0, 1, 500);
  EXPECT_TRUE(none(few));
  EXPECT_TRUE(standing_axes({}, {}).empty());
}

}  // namespace
}  // namespace swath::io
