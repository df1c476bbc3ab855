// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/corridor/catenary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace swath::terrain {
namespace {

std::vector<OnWire> returns(const Catenary& c, double from, double to, size_t n, double sigma, std::mt19937& random) {
  std::uniform_real_distribution<double> place(from, to);
  std::normal_distribution<double> noise(0.0, sigma);
  std::vector<OnWire> out;
  for (size_t k = 0; k < n; ++k) {
    const double s = place(random);
    out.push_back({s, c.z(s) + noise(random), 1});
  }
  return out;
}

TEST(Catenary, IsTheCurveOfItsLowestPoint) {
  const Catenary c{40.0, 25.0, 0.12, 1.0 / 650.0};
  for (double s = -100.0; s < 200.0; s += 7.0) {
    const double z = c.z0() + c.a() * std::cosh((s - c.s0()) / c.a()) - c.a();
    EXPECT_NEAR(c.z(s), z, 1e-9);
    EXPECT_NEAR(c.dz(s), (c.z(s + 1e-4) - c.z(s - 1e-4)) / 2e-4, 1e-8);
  }
  EXPECT_NEAR(c.dz(c.place_of(0.05)), 0.05, 1e-12);
}

TEST(Catenary, ItsDerivativesAreThoseOfDifferences) {
  for (const double kappa : {0.0, 1e-6, 1e-5, 2e-4, 2e-3})
    for (const double s : {-90.0, 0.0, 3.0, 160.0}) {
      const Catenary c{0.0, 20.0, -0.2, kappa};
      const auto difference = [&](double Catenary::*p, double step) {
        Catenary up = c, down = c;
        up.*p += step, down.*p -= step;
        return (up.z(s) - down.z(s)) / (2 * step);
      };
      const Eigen::Vector3d g = c.gradient(s);
      EXPECT_NEAR(g(0), difference(&Catenary::level, 1e-3), 1e-8);
      EXPECT_NEAR(g(1), difference(&Catenary::slope, 1e-4), 1e-5);
      EXPECT_NEAR(g(2), difference(&Catenary::kappa, 1e-7), 1e-4 * (1.0 + s * s));
    }
}

TEST(Catenary, SigmasAreTrueWithGrossErrorsAmongTheReturns) {
  std::mt19937 random(4);
  const Catenary truth{90.0, 25.0, 0.03, 1.0 / 700.0};
  double kappa = 0.0, middle = 0.0, n = 0.0;
  for (int round = 0; round < 300; ++round) {
    std::vector<OnWire> r = returns(truth, 0.0, 180.0, 200, 0.03, random);
    for (size_t k = 0; k < 10; ++k) r[k * 20].z += 0.4;
    const CatenaryFit fit = fit_catenary(r);
    ASSERT_TRUE(fit.found);
    EXPECT_LE(fit.used, 190u);
    kappa += std::pow(fit.curve.kappa - truth.kappa, 2) / fit.covariance(2, 2);
    middle += std::pow((fit.curve.z(60.0) - truth.z(60.0)) / fit.sigma_z(60.0), 2);
    ++n;
  }
  EXPECT_NEAR(std::sqrt(kappa / n), 1.0, 0.12);  // 3 sigmas of 300 rounds
  EXPECT_NEAR(std::sqrt(middle / n), 1.0, 0.12);
}

TEST(Catenary, AStepBetweenFlightLinesDoesNotBendIt) {
  std::mt19937 random(9);
  const Catenary truth{90.0, 25.0, 0.0, 1.0 / 700.0};
  std::vector<OnWire> r = returns(truth, 0.0, 110.0, 120, 0.02, random);
  for (OnWire other : returns(truth, 70.0, 180.0, 120, 0.02, random)) r.push_back({other.s, other.z + 0.10, 2});
  const CatenaryFit fit = fit_catenary(r);
  ASSERT_TRUE(fit.found);
  EXPECT_NEAR(fit.curve.kappa, truth.kappa, 4 * std::sqrt(fit.covariance(2, 2)));
  EXPECT_NEAR(fit.curve.z(90.0), truth.z(90.0) + 0.05, 0.02);  // the lines' mean
  EXPECT_NEAR(fit.sigma, 0.02, 0.004);
  EXPECT_NEAR(fit.sigma_lines, 0.05, 0.01);  // half the step: sigma of a mean of two
}

TEST(Catenary, TiltsOfFlightLinesThatSeePartOfItDoNotBendIt) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  const Catenary truth{75.0, 25.0, 0.0, 1.0 / 625.0};
  double squares = 0.0;
  constexpr int rounds = 200;
  for (int round = 0; round < rounds; ++round) {
    std::vector<OnWire> r;
    for (std::uint16_t line = 1; line <= 2; ++line) {
      const double shift = 0.03 * normal(random), tilt = 5e-4 * normal(random);
      for (OnWire o : returns(truth, line == 1 ? 0.0 : 50.0, line == 1 ? 100.0 : 150.0, 150, 0.02, random))
        r.push_back({o.s, o.z + shift + tilt * (o.s - 75.0), line});
    }
    const CatenaryFit fit = fit_catenary(r);
    ASSERT_TRUE(fit.found);
    squares += std::pow(fit.curve.kappa - truth.kappa, 2) / fit.covariance(2, 2);
  }
  EXPECT_NEAR(std::sqrt(squares / rounds), 1.0, 0.15);  // 3 sigmas of 200 rounds
}

TEST(Catenary, ShortPiecesOfALineHaveNoTiltOfTheirOwn) {
  std::mt19937 random(12);
  const Catenary truth{75.0, 25.0, 0.0, 1.0 / 625.0};
  std::vector<OnWire> r = returns(truth, 0.0, 150.0, 150, 0.02, random);
  for (OnWire o : returns(truth, 130.0, 150.0, 30, 0.02, random)) r.push_back({o.s, o.z + 0.1, 2});
  const CatenaryFit fit = fit_catenary(r);
  ASSERT_EQ(fit.lines.size(), 2u);
  EXPECT_EQ(fit.lines[0].tilt, 0.0);
  EXPECT_EQ(fit.lines[1].tilt, 0.0);
  EXPECT_NEAR(fit.lines[1].level - fit.lines[0].level, 0.1, 0.02);
  EXPECT_NEAR(fit.lines[0].share, 150.0 / 180.0, 1e-9);
}

TEST(Catenary, TooFewReturnsOrAllAtOnePlaceAreNone) {
  EXPECT_FALSE(fit_catenary({}).found);
  EXPECT_FALSE(fit_catenary({{0, 5, 1}, {1, 5, 1}, {2, 5, 1}, {3, 5, 1}}).found);
  EXPECT_FALSE(fit_catenary(std::vector<OnWire>(20, OnWire{3.0, 5.0, 1})).found);
}

}  // namespace
}  // namespace swath::terrain
