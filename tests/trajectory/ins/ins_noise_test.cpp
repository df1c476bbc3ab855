// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins/ins_noise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/world/navigation.h"

namespace swath::trajectory {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr size_t fixes = 4000;
constexpr double sigma = 0.02;  // m, of a fix and of an innovation

/// Outcomes of a pass over fixes with one sigma; the filter itself adds nothing.
struct Pass {
  ImuPath path;
  core::GnssData gnss;
  std::vector<Node> nodes;
  std::vector<FixOutcome> outcomes;
  Problem problem{path, gnss, nodes, Layout(), ProcessNoise::of(core::error_model_of(core::ImuGrade::tactical), 120.0), {}};

  /// Innovations of `scale` sigmas, each like the one before by `alike`.
  explicit Pass(double scale, double alike = 0.0) {
    test::Dice dice(5);
    Vector3d z = dice.vector();
    for (size_t k = 0; k < fixes; ++k) {
      z = alike * z + std::sqrt(1 - alike * alike) * dice.vector();
      gnss.time.push_back(1.4e9 + 0.2 * static_cast<double>(k));
      gnss.covariance.push_back(sigma * sigma * Matrix3d::Identity());
      nodes.push_back({gnss.time.back(), static_cast<std::int32_t>(k), false});
      outcomes.push_back({sigma * scale * z, Vector3d::Constant(sigma), scale * scale * z.squaredNorm()});
    }
  }
  Pass(const Pass&) = delete;
  Pass& operator=(const Pass&) = delete;
};

TEST(InsNoise, TheWhiteShareFollowsTheInnovations) {
  // All of the innovations' variance is that of the fixes: 36 % of what is stated, of which 60 % were taken as white.
  Pass small(0.6);
  EXPECT_TRUE(adapt_fixes(small.problem, small.outcomes));
  EXPECT_NEAR(small.problem.variance, 1.0, 1e-9);
  EXPECT_NEAR(small.problem.share, 1 - 0.12, 0.01);  // limited to a fifth of the white part in one round
  Pass large(3.0);
  EXPECT_TRUE(adapt_fixes(large.problem, large.outcomes));
  EXPECT_GT(large.problem.variance, 4.0);
  Pass right(1.0);
  adapt_fixes(right.problem, right.outcomes);
  EXPECT_NEAR(right.problem.share, 0.4, 0.05);  // four sigmas of the mean
}

TEST(InsNoise, FixesOfLessWeightAndFewFixesDetermineNothing) {
  Pass off(3.0);
  for (FixOutcome& o : off.outcomes) o.weight = 0.5;
  EXPECT_FALSE(adapt_fixes(off.problem, off.outcomes));
  Pass few(3.0, 0.9);
  few.nodes.resize(99);
  EXPECT_FALSE(adapt_fixes(few.problem, few.outcomes));
  EXPECT_FALSE(adapt_imu(few.problem, few.outcomes));
}

/// Innovations of 2 cm, and passes whose sigma is that of the problem's whole variance of 4 cm fixes.
TEST(InsNoise, SigmasThatAreTooLargeHaveAFactor) {
  Pass made(1.0);
  int passes = 0;
  const auto pass = [&](const Problem& p) {
    ++passes;
    std::vector<FixOutcome> out = made.outcomes;
    const double of = 2 * sigma * std::sqrt(p.variance);
    for (FixOutcome& o : out) {
      o.innovation_sigma.setConstant(of);
      o.nis = o.innovation.squaredNorm() / (of * of);
    }
    return out;
  };
  made.problem.share = 0.95;
  // Halved twice: 0.29 of the variance; the next would be 0.17 of it, and a quarter is right.
  EXPECT_NEAR(overstatement(made.problem, pass), std::sqrt(1 / (0.05 + 0.95 / 4)), 1e-9);
  EXPECT_EQ(passes, 4);
  made.problem.variance = 0.25;  // right
  EXPECT_EQ(overstatement(made.problem, pass), 1.0);
  // Where little is correlated nothing is asked.
  passes = 0;
  made.problem.share = 0.7;
  made.problem.variance = 1.0;
  EXPECT_EQ(overstatement(made.problem, pass), 1.0);
  EXPECT_EQ(passes, 0);
}

TEST(InsNoise, InnovationsThatAreLargeAndAlikeAreTheImus) {
  Pass rough(3.0, 0.9);
  const ProcessNoise before = rough.problem.noise;
  EXPECT_TRUE(adapt_imu(rough.problem, rough.outcomes));
  EXPECT_EQ(rough.problem.roughness, 2.0);
  EXPECT_EQ(rough.problem.noise.angle, 4 * before.angle);
  EXPECT_EQ(rough.problem.noise.force_drift, 4 * before.force_drift);
  // Large alone: white noise of the fixes. Alike alone: their correlated part.
  Pass white(3.0), correlated(1.0, 0.9);
  EXPECT_FALSE(adapt_imu(white.problem, white.outcomes));
  EXPECT_FALSE(adapt_imu(correlated.problem, correlated.outcomes));
  // It ends.
  int rounds = 1;
  for (; adapt_imu(rough.problem, rough.outcomes); ++rounds) {
  }
  EXPECT_EQ(rough.problem.roughness, 64.0);
  EXPECT_EQ(rounds, 6);
  Pass perfect(3.0, 0.9);
  perfect.problem.noise.angle = perfect.problem.noise.velocity = 0;
  EXPECT_FALSE(adapt_imu(perfect.problem, perfect.outcomes));
}

}  // namespace
}  // namespace swath::trajectory
