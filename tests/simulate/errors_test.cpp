// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/errors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace swath::simulate {
namespace {

TEST(TrajectoryErrors, HaveTheStatedSigmasAndCorrelation) {
  NoiseOptions noise;
  noise.correlation = core::Seconds(20);
  std::array<double, 6> square{}, product{};
  constexpr int seeds = 3000;
  for (int s = 0; s < seeds; ++s) {
    const TrajectoryErrors e(noise, s);
    const auto a = e.at(100.0), b = e.at(120.0);
    for (size_t k = 0; k < 6; ++k) {
      square[k] += a.value[k] * a.value[k] / (e.sigma()[k] * e.sigma()[k]);
      product[k] += a.value[k] * b.value[k] / (e.sigma()[k] * e.sigma()[k]);
    }
  }
  for (size_t k = 0; k < 6; ++k) {
    EXPECT_NEAR(square[k] / seeds, 1.0, 5 * std::sqrt(2.0 / seeds));
    // exp(-1), with 5 sigma of chance and the cut of the spectrum.
    EXPECT_NEAR(product[k] / seeds, std::exp(-1.0), 0.10);
  }
}

TEST(TrajectoryErrors, RatesAreDerivatives) {
  const TrajectoryErrors e({}, 4);
  constexpr double h = 1e-4;
  for (double t = 0; t < 200; t += 17)
    for (size_t k = 0; k < 6; ++k) EXPECT_NEAR((e.at(t + h).value[k] - e.at(t - h).value[k]) / (2 * h), e.at(t).rate[k], 1e-8);
}

TEST(TrajectoryErrors, NoiseFreeHasNone) {
  NoiseOptions noise;
  noise.noise_free = true;
  const TrajectoryErrors e(noise, 4);
  for (const double v : e.at(3.0).value) EXPECT_EQ(v, 0.0);
}

TEST(DeliverCalibration, TruthDrawnNominal) {
  MountingOptions m;
  m.deliver = Deliver::truth;
  const auto truth = deliver_calibration(m, {}, {}, 1);
  EXPECT_EQ(truth.calibration.roll.value, m.truth.roll.value);
  EXPECT_EQ(truth.calibration.lever_arm_scanner, m.truth.lever_arm_scanner);
  EXPECT_EQ(truth.sigma.roll.value, 0.0);

  m.deliver = Deliver::nominal;
  const auto nominal = deliver_calibration(m, {}, {}, 1);
  EXPECT_EQ(nominal.calibration.pitch.value, 0.0);
  EXPECT_EQ(nominal.calibration.scan_scale, 1.0);
  EXPECT_EQ(nominal.sigma.pitch.value, m.nominal_sigma.pitch.value);
  EXPECT_NEAR(nominal.calibration.lever_arm_scanner[0].value, m.truth.lever_arm_scanner[0].value, 5 * m.sigma.lever_arm.value);

  m.deliver = Deliver::drawn;
  double roll = 0, scale = 0, lever = 0;
  constexpr int seeds = 2000;
  for (int s = 0; s < seeds; ++s) {
    const auto d = deliver_calibration(m, {}, {}, s).calibration;
    roll += std::pow((d.roll.value - m.truth.roll.value) / m.sigma.roll.value, 2) / seeds;
    scale += std::pow((d.scan_scale - m.truth.scan_scale) / m.sigma.scan_scale, 2) / seeds;
    lever += std::pow((d.lever_arm_scanner[2].value - m.truth.lever_arm_scanner[2].value) / m.sigma.lever_arm.value, 2) / seeds;
  }
  for (const double v : {roll, scale, lever}) EXPECT_NEAR(v, 1.0, 5 * std::sqrt(2.0 / seeds));
}

TEST(TrueCalibration, IsDrawnAboutTheOptions) {
  MountingOptions m;
  const core::Calibration same = true_calibration(m, 7);
  EXPECT_EQ(same.roll.value, m.truth.roll.value);
  EXPECT_EQ(same.scan_scale, m.truth.scan_scale);
  EXPECT_EQ(same.range_offset.value, m.truth.range_offset.value);
  const double limit = 0.5 * core::degree;
  m.random_boresight = core::Radians(limit);
  m.random_range_offset = core::Metres(0.1);
  m.random_scan_scale = 1e-4;
  std::array<double, 3> mean{}, square{};
  double offset = 0, scale = 0, farthest = 0;
  constexpr int seeds = 3000;
  for (int s = 0; s < seeds; ++s) {
    const core::Calibration c = true_calibration(m, s);
    const std::array off{c.roll.value - m.truth.roll.value, c.pitch.value - m.truth.pitch.value, c.heading.value - m.truth.heading.value};
    for (size_t k = 0; k < 3; ++k) {
      mean[k] += off[k] / limit / seeds;
      square[k] += off[k] * off[k] / (limit * limit) / seeds;
      farthest = std::max(farthest, std::abs(off[k]));
    }
    offset += std::pow((c.range_offset.value - m.truth.range_offset.value) / 0.1, 2) / seeds;
    scale += std::pow((c.scan_scale - m.truth.scan_scale) / 1e-4, 2) / seeds;
  }
  EXPECT_LE(farthest, limit);
  EXPECT_GT(farthest, 0.99 * limit);
  // Of values even within -1 and 1: variance 1/3, variance of the square 4/45.
  for (const double v : mean) EXPECT_NEAR(v, 0.0, 5 * std::sqrt(1.0 / 3 / seeds));
  for (const double v : square) EXPECT_NEAR(v, 1.0 / 3, 5 * std::sqrt(4.0 / 45 / seeds));
  for (const double v : {offset, scale}) EXPECT_NEAR(v, 1.0, 5 * std::sqrt(2.0 / seeds));
}

TEST(DeliverCalibration, NominalStatesTheSigmaOfWhatIsDrawn) {
  MountingOptions m;
  m.deliver = Deliver::nominal;
  m.random_boresight = core::Radians(0.003);
  m.random_scan_scale = 2e-4;
  const auto d = deliver_calibration(m, {}, {}, 1);
  for (const core::Radians v : {d.sigma.roll, d.sigma.pitch, d.sigma.heading}) EXPECT_NEAR(v.value, 0.003 / std::sqrt(3.0), 1e-15);
  EXPECT_EQ(d.sigma.scan_scale, 2e-4);
  EXPECT_EQ(d.sigma.range_offset.value, m.nominal_sigma.range_offset.value);  // not drawn
}

TEST(DeliverCalibration, RecordSigmasHoldTheRounding) {
  ScannerOptions s;
  s.range_resolution = core::Metres(0.12);
  NoiseOptions n;
  n.range = core::Metres(0.0);
  EXPECT_NEAR(deliver_calibration({}, n, s, 1).sigma.range.value, 0.12 / std::sqrt(12.0), 1e-15);
  n.noise_free = true;
  EXPECT_EQ(deliver_calibration({}, n, s, 1).sigma.range.value, 0.0);
}

}  // namespace
}  // namespace swath::simulate
