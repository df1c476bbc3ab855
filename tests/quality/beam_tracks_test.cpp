// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/beam_tracks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace swath::quality {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A scanner that flies 600 m above trees of 5 to 15 m; every pulse returns from one and from the ground, places off by `noise`.
struct Flight {
  Vector3d start{500.0, 100.0, 610.0};
  Vector2d speed{20.0, 55.0};
  double noise = 0.03;
  Vector3d at(double t) const { return start + Vector3d(speed.x() * t, speed.y() * t, 0.0); }
  core::Block block(size_t pulses, unsigned seed, size_t wrong = 0) const {
    core::Block b;
    b.origin = {100.0, 200.0, 10.0};
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> even(-1.0, 1.0);
    std::normal_distribution<double> off(0.0, noise);
    for (size_t k = 0; k < pulses; ++k) {
      const double t = 2.0 * even(random);
      const Vector3d s = at(t), ground(s.x() + 250.0 * even(random), s.y() + 10.0 * even(random), 10.0);
      const Vector3d ray = (ground - s) / (s.z() - ground.z());
      const double height = 10.0 + 5.0 * even(random);
      for (int r = 0; r < 2; ++r) {
        Vector3d p = r == 0 ? Vector3d(ground - height * ray) : ground;
        if (r == 1 && k < wrong) p.x() += 4.0;
        b.x.push_back(p.x() - 100.0 + off(random)), b.y.push_back(p.y() - 200.0 + off(random)), b.z.push_back(p.z() - 10.0 + off(random));
        b.time.push_back(1000.0 + t), b.strip.push_back(4), b.flags.push_back(0), b.classification.push_back(1);
        b.return_number.push_back(static_cast<std::uint8_t>(r + 1)), b.return_count.push_back(2);
      }
    }
    return b;
  }
};
const core::Box everywhere{-1e6, -1e6, 1e6, 1e6};

std::vector<PulseSpan> spans_in(const core::Block& b, size_t own, const core::Box& box) {
  return spans_of(pulse_returns_in(b, own, {box}));
}

TEST(BeamTracks, TheRunOfABeamIsFoundWithinItsSigma) {
  const Flight flight;
  double chi = 0.0;
  constexpr int runs = 40;
  for (unsigned seed = 1; seed <= runs; ++seed) {
    const core::Block b = flight.block(200, seed);
    const auto track = ScannerTrack::around(1000.0, spans_in(b, b.size(), everywhere));
    ASSERT_TRUE(track);
    const Vector3d p(580.0, 130.0, 20.0), s = flight.at(0.5);
    const Vector2d error = track->run(1000.5, p) - (p - s).head<2>() / (s.z() - p.z());
    EXPECT_LT(error.norm(), 0.004);
    chi += error.squaredNorm() / (2.0 * track->run_sigma() * track->run_sigma() * runs);
  }
  EXPECT_LT(std::sqrt(chi), 1.15);  // its sigma has an allowance for motion that is not even, which this flight has not
}

TEST(BeamTracks, WrongPairsAreLeftOut) {
  const Flight flight;
  const core::Block b = flight.block(200, 3, 20);
  const auto track = ScannerTrack::around(1000.0, spans_in(b, b.size(), everywhere));
  ASSERT_TRUE(track);
  const Vector3d p(500.0, 100.0, 10.0), s = flight.at(0.0);
  EXPECT_LT((track->run(1000.0, p) - (p - s).head<2>() / (s.z() - p.z())).norm(), 0.004);
}

TEST(BeamTracks, FewPulsesGiveNone) {
  const core::Block b = Flight().block(29, 3);
  const auto spans = spans_in(b, b.size(), everywhere);
  EXPECT_EQ(spans.size(), 29u);
  EXPECT_FALSE(ScannerTrack::around(1000.0, spans));
  EXPECT_FALSE(ScannerTrack::around(1010.0, spans));
}

TEST(BeamTracks, SpansAreOfOwnPulsesOfSomeHeightInTheBox) {
  core::Block b = Flight().block(10, 3);
  EXPECT_EQ(spans_in(b, 10, everywhere).size(), 5u);
  EXPECT_TRUE(spans_in(b, b.size(), {0.0, 0.0, 1.0, 1.0}).empty());
  for (double& z : b.z) z *= 0.1;
  EXPECT_TRUE(spans_in(b, b.size(), everywhere).empty());
  b.return_count.clear();
  EXPECT_TRUE(spans_in(b, b.size(), everywhere).empty());
}

}  // namespace
}  // namespace swath::quality
