// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/network/plane_tests.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/calib/network/plane_crossing.h"

namespace swath::calib {
namespace {

using namespace test;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The planes alone are solved for: the trajectory and the calibration are right and known to be.
struct Known {
  Crossing flight;
  PlaneFactors planes;
  PlaneTests tests;

  /// `one_group`: what the fifth group is displaced by, and each `every` groups further one, m. `rough`: sigma by which each group lies off
  /// its plane, m; `stated`: what the adjustment takes it for.
  Known(std::uint64_t seed, double rough, double stated, double one_group = 0.0, int side = 3, size_t every = 10000)
      : flight(made(seed, rough, one_group, side, every)), planes(flight.factors(stated)) {
    planes.fit(*flight.off, flight.calibration);
    for (int i = 0; i < 3; ++i) step();
  }
  void step(bool weigh = false) {
    planes.linearise(*flight.off, flight.calibration);
    if (weigh) planes.weigh();
    NetworkNormals normals(flight.states->sizes());
    planes.add(*flight.states, normals);
    // A millionth of what the planes could say.
    for (int k = 0; k <= flight.states->common(); ++k) normals.N.add(k, k, 1e18 * MatrixXd::Identity(normals.N.size(k), normals.N.size(k)));
    NodeFactor factor(normals.N);
    const VectorXd x = factor.solve(normals.b);
    planes.follow(x, *flight.states);
    factor.invert();
    tests = test_planes(planes, *flight.states, factor, x);
  }

 private:
  static Crossing made(std::uint64_t seed, double rough, double one_group, int side, size_t every) {
    Dice dice(seed);
    Crossing c(0.0, &dice, side);
    for (size_t g = 0; g < c.ties.groups.size(); ++g) {
      const double off = rough * dice.normal() + (g % every == 4 ? one_group : 0.0);
      const TieGroup& of = c.ties.groups[g];
      // By what the range must be longer for that distance along the normal; beams come from about 700 m above.
      const double incidence = std::abs(c.ties.planes[of.plane].normal.z());
      for (std::uint32_t i = of.begin; i < of.end; ++i) c.ties.returns.range[i] += off / incidence;
    }
    return c;
  }
};

TEST(PlaneTests, ResidualsAreAsLargeAsTheirRedundancySays) {
  KindSums means, returns;
  double squares = 0, n = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Known k(seed, 0.003, 0.003);
    means.redundancy += k.tests.means.redundancy, means.squares += k.tests.means.squares;
    returns.redundancy += k.tests.returns.redundancy, returns.squares += k.tests.returns.squares;
    for (const GroupTest& t : k.tests.group) {
      if (t.redundancy < 0.05) continue;
      squares += t.w * t.w;
      ++n;
    }
    // Nothing but planes is unknown: three each, and what the groups' means do not know of them their returns do.
    const double determined = static_cast<double>(k.tests.means.observations + k.tests.returns.observations) - k.tests.means.redundancy -
                              k.tests.returns.redundancy;
    EXPECT_NEAR(determined, 3.0 * static_cast<double>(k.tests.planes), 0.05);
  }
  std::printf("means %.3f of %.0f, returns %.3f, w %.3f of %.0f\n", std::sqrt(means.squares / means.redundancy), means.redundancy,
              std::sqrt(returns.squares / returns.redundancy), std::sqrt(squares / n), n);
  EXPECT_GT(means.redundancy, 10.0);                                   // few planes lie in both swaths, and their tilt takes a part
  EXPECT_NEAR(std::sqrt(means.squares / means.redundancy), 1.0, 0.4);  // twice 1 / sqrt(2 r)
  EXPECT_NEAR(std::sqrt(returns.squares / returns.redundancy), 1.0, 0.05);
  EXPECT_NEAR(std::sqrt(squares / n), 1.0, 0.2);
}

TEST(PlaneTests, TheSurfacesSigmaIsFound) {
  constexpr double stated = 0.02;
  double variance = 0;
  constexpr int flights = 4, many = 12;
  for (std::uint64_t seed = 1; seed <= flights; ++seed) {
    Known k(seed, 0.008, stated, 0.0, many);
    EXPECT_TRUE(surface_is_known(k.tests));
    for (int i = 0; i < 8; ++i) {
      if (!update_surface(k.planes, k.tests)) break;
      k.step();
    }
    variance += k.planes.surface() * k.planes.surface() / flights;
  }
  std::printf("stated %.3f m: found %.4f m\n", stated, std::sqrt(variance));
  EXPECT_NEAR(std::sqrt(variance), 0.008, 0.0016);
}

TEST(PlaneTests, AFewDegreesOfFreedomLeaveTheSurfacesSigmaAsStated) {
  Known k(1, 0.0, 0.02);
  std::printf("redundancy %.2f\n", k.tests.means.redundancy);
  ASSERT_GT(k.tests.means.redundancy, 0.5);
  ASSERT_LT(k.tests.means.redundancy, 10.0);
  EXPECT_FALSE(surface_is_known(k.tests));
  EXPECT_FALSE(update_surface(k.planes, k.tests));
  EXPECT_EQ(k.planes.surface(), 0.02);
}

TEST(PlaneTests, AnUpdateOfTheSurfacesSigmaIsAFactorOfTwoAtMost) {
  Known large(1, 0.0, 0.05, 0.0, 12);
  EXPECT_TRUE(update_surface(large.planes, large.tests));
  EXPECT_NEAR(large.planes.surface(), 0.025, 1e-9);
}

TEST(PlaneTests, GroupsFarOffSayNothingOfTheSurfaces) {
  Known k(1, 0.0, 0.003, 0.3, 12, 10);
  for (int i = 0; i < 12; ++i) {
    for (int n = 0; n < 2; ++n) k.step(true);
    if (!update_surface(k.planes, k.tests)) break;
  }
  std::printf("surface %.4f m, %llu groups left out\n", k.planes.surface(), static_cast<unsigned long long>(k.planes.left_out()));
  EXPECT_GT(k.planes.left_out(), 2u);
  EXPECT_LT(k.planes.surface(), 0.004);
}

TEST(PlaneTests, ExactSurfacesHaveHardlyAny) {
  Known k(3, 0.0, 0.01, 0.0, 12);
  for (int i = 0; i < 8; ++i) {
    if (!update_surface(k.planes, k.tests)) break;
    k.step();
  }
  EXPECT_LT(k.planes.surface(), 0.004);
}

TEST(PlaneTests, ADisplacedGroupIsLeftOut) {
  Known k(5, 0.0, 0.003, 0.2);
  const std::uint32_t plane = k.flight.ties.groups[4].plane;
  const auto [begin, end] = k.planes.groups_of(plane);
  double largest = 0;
  for (size_t g = begin; g < end; ++g) largest = std::max(largest, std::abs(k.tests.group[g].w));
  EXPECT_GT(largest, 6.0);
  EXPECT_EQ(reject_groups(k.planes, k.tests, 1e-6, 0.0), 0);
  EXPECT_EQ(reject_groups(k.planes, k.tests, 1e-6, 0.1), 1);  // of two lines that disagree one goes
  int out = 0;
  GroupTest shown;  // what the group that went was tested by
  size_t gone = begin;
  for (size_t g = begin; g < end; ++g)
    if (k.planes.weight(g) == 0.0) ++out, gone = g, shown = k.tests.group[g];
  EXPECT_EQ(out, 1);
  k.planes.linearise(*k.flight.off, k.flight.calibration);
  k.planes.weigh();
  EXPECT_EQ(k.planes.left_out(), 1u);  // and stays out
  k.step();
  k.tests.group[gone] = shown;  // a group keeps the test that showed it and does not go twice
  EXPECT_EQ(reject_groups(k.planes, k.tests, 1e-6, 0.1), 0);
}

}  // namespace
}  // namespace swath::calib
