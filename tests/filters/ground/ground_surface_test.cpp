// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/ground/ground_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/world/scene.h"

namespace swath::filters {
namespace {

/// Distances of the surface from the scene's terrain, m, at a lattice of places 10 m within the rim.
std::vector<double> errors_of(const test::Scene& s, const GroundSurface& g) {
  std::vector<double> e;
  for (double y = 10.25; y < test::scene_height - 10; y += 1.7)
    for (double x = 10.25; x < test::scene_width - 10; x += 1.7)
      e.push_back(sample(g.height, g.lattice, s.block.origin.x() + x, s.block.origin.y() + y).height - s.terrain(x, y));
  return e;
}

double rms(const std::vector<double>& e) {
  double sum = 0;
  for (const double v : e) sum += v * v;
  return std::sqrt(sum / static_cast<double>(e.size()));
}

TEST(GroundSurface, LiesInTheMiddleOfTheGroundsReturns) {
  struct Bar {
    const char* scene;
    double rms;  // m; returns of 3 cm, one per m2: the mean of some twenty is good to 1 cm
  };
  for (const Bar& bar : {Bar{"flat", 0.012}, Bar{"slope", 0.02}, Bar{"town", 0.03}, Bar{"forest", 0.05}}) {
    const test::Scene s = test::make_scene(bar.scene);
    const std::vector<double> e = errors_of(s, ground_surface(s.block, s.block.size(), 0.0, {}));
    EXPECT_LT(rms(e), bar.rms) << bar.scene;
  }
}

TEST(GroundSurface, ASheerStepStaysWithinTwoMetresOfItsPlace) {
  const test::Scene s = test::make_scene("scarp");
  const GroundSurface g = ground_surface(s.block, s.block.size(), 0.0, {});
  for (double y = 20.5; y < 140; y += 1.0)
    for (const double x : {86.0, 88.0, 92.0, 94.0})
      EXPECT_NEAR(sample(g.height, g.lattice, s.block.origin.x() + x, s.block.origin.y() + y).height, s.terrain(x, y), 0.3)
          << x << " " << y;
}

TEST(GroundSurface, CropsOfAThirdOpennessDoNotLiftIt) {
  test::Scene s = test::make_scene("flat");
  for (size_t p = 0; p < s.block.size(); ++p)
    if (p % 3 != 0 && s.block.x[p] > 60 && s.block.x[p] < 140)
      s.block.z[p] += 0.1 + 1.5 * std::fmod(0.618034 * static_cast<double>(p), 1.0);
  constexpr double bearable = 0.1;  // m, of crops 0.1 to 1.6 m high
  EXPECT_LT(rms(errors_of(s, ground_surface(s.block, s.block.size(), 0.0, {}))), bearable);
}

TEST(GroundSurface, SpreadIsThatOfTheReturns) {
  const test::Scene s = test::make_scene("flat");
  const GroundSurface g = ground_surface(s.block, s.block.size(), 0.0, {});
  std::vector<float> spread;
  for (int j = 20; j < g.lattice.ny - 20; ++j)
    for (int i = 20; i < g.lattice.nx - 20; ++i)
      if (g.support.value[g.support.at(i, j)] > 5) spread.push_back(g.spread.value[g.spread.at(i, j)]);
  std::ranges::nth_element(spread, spread.begin() + static_cast<std::ptrdiff_t>(spread.size() / 2));
  EXPECT_NEAR(spread[spread.size() / 2], test::scene_noise, 0.25 * test::scene_noise);
}

TEST(GroundSurface, NothingWithoutPoints) { EXPECT_EQ(ground_surface(core::Block{}, 0, 0.0, {}).lattice.size(), 0u); }

}  // namespace
}  // namespace swath::filters
