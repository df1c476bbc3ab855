// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/line_agreement.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/calib/tie_block.h"

namespace swath::calib {
namespace {

using test::Dice;

struct Block {
  Block() : world(test::make_world(test::full_pattern(), test::block_planes(6, 4, 2))), draw(world, test::tactical_errors) {
    sensor.range = world.noise.range;
    sensor.roll = sensor.pitch = sensor.heading = core::Radians(0);  // the calibration is true
    sensor.lever_arm = core::Metres(0);
  }
  LineAgreement flown(std::uint64_t seed, double errors, const core::Calibration& calibration, const core::SensorSigma& stated) const {
    Dice dice(seed);
    const TieSet ties = test::ties_of(world, &dice, seed);
    core::TrajectoryData data = draw.with_errors(world.exact, dice);
    if (errors != 1.0) data = blown_up(data, errors);
    const trajectory::Trajectory t(data);
    return line_agreement(ties, world.scanner, calibration, stated, t, test::tactical_errors);
  }
  /// The errors times a factor; small angles.
  core::TrajectoryData blown_up(core::TrajectoryData d, double by) const {
    const auto scale = [by](std::vector<double>& v, const std::vector<double>& exact) {
      for (size_t i = 0; i < v.size(); ++i) v[i] = exact[i] + by * core::wrap_pi(v[i] - exact[i]);
    };
    for (const auto c : {&core::TrajectoryData::latitude, &core::TrajectoryData::longitude, &core::TrajectoryData::roll,
                         &core::TrajectoryData::pitch, &core::TrajectoryData::heading})
      scale(d.*c, world.exact.*c);
    for (size_t i = 0; i < d.size(); ++i) d.height[i] = world.exact.height[i] + by * (d.height[i] - world.exact.height[i]);
    return d;
  }
  test::World world;
  test::ErrorDraw draw;
  core::SensorSigma sensor;
};

const Block& block() {
  static const Block b;
  return b;
}

TEST(LineAgreement, LinesWithTheStatedErrorsAgree) {
  double squares = 0, predicted = 0;
  int exceeded = 0;
  constexpr int seeds = 12;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const LineAgreement a = block().flown(seed, 1.0, block().world.truth, block().sensor);
    ASSERT_GT(a.pairs.size(), 10u);
    squares += a.rms * a.rms;
    predicted += a.predicted * a.predicted;
    exceeded += a.exceeded();
  }
  std::printf("measured / predicted: %.2f\n", std::sqrt(squares / predicted));
  EXPECT_NEAR(std::sqrt(squares / predicted), 1.0, 0.15);
  EXPECT_LE(exceeded, 1);
}

TEST(LineAgreement, LinesWithFiveTimesTheErrorsDoNot) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const LineAgreement a = block().flown(seed, 5.0, block().world.truth, block().sensor);
    EXPECT_TRUE(a.exceeded()) << seed;
    EXPECT_GT(a.rms, 2.5 * a.predicted);
  }
}

TEST(LineAgreement, AMisalignmentWithinItsStatedSigmaIsAllowedFor) {
  core::Calibration off = block().world.truth;
  off.roll.value += 0.02 * core::degree;
  core::SensorSigma stated = block().sensor;
  EXPECT_TRUE(block().flown(3, 1.0, off, stated).exceeded());
  stated.roll = core::degrees(0.02);
  EXPECT_FALSE(block().flown(3, 1.0, off, stated).exceeded());
}

TEST(LineAgreement, CorrelationsOfTheCalibrationCount) {
  core::SensorSigma apart = block().sensor;
  apart.roll = apart.pitch = apart.heading = core::degrees(0.02);
  constexpr int n = latency + 1;
  core::SensorSigma together = apart;
  together.correlation.assign(n * n, 0.0);
  for (int i = 0; i < n; ++i) together.correlation[static_cast<size_t>(i * (n + 1))] = 1.0;
  const double none = block().flown(1, 1.0, block().world.truth, together).predicted;
  EXPECT_DOUBLE_EQ(none, block().flown(1, 1.0, block().world.truth, apart).predicted);
  // A roll turns the beam of a scanner that scans across one way and a scan offset the other way: together they cancel.
  apart.scan_offset = apart.roll;
  together.scan_offset = together.roll;
  together.correlation[boresight_roll * n + scan_offset] = together.correlation[scan_offset * n + boresight_roll] = 1.0;
  core::SensorSigma without = apart;
  without.roll = without.scan_offset = core::Radians(0);
  const double cancelled = block().flown(1, 1.0, block().world.truth, without).predicted;
  EXPECT_NEAR(block().flown(1, 1.0, block().world.truth, together).predicted, cancelled, 0.01 * cancelled);
  EXPECT_GT(block().flown(1, 1.0, block().world.truth, apart).predicted, 1.2 * cancelled);
}

TEST(LineAgreement, LinesApartHaveNoPair) {
  TieSet ties = test::ties_of(block().world, nullptr);
  std::erase_if(ties.groups, [](const TieGroup& g) { return g.line != 0; });
  const trajectory::Trajectory t(block().world.exact);
  const LineAgreement a = line_agreement(ties, block().world.scanner, block().world.truth, block().sensor, t, test::tactical_errors);
  EXPECT_TRUE(a.pairs.empty());
  EXPECT_FALSE(a.exceeded());
  EXPECT_EQ(a.planes, 0u);
}

}  // namespace
}  // namespace swath::calib
