// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/dtm.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/config/option_visitors.h"
#include "core/error.h"
#include "tests/terrain/made.h"

namespace swath::terrain {
namespace {

using core::Void;
constexpr double float_step = 1e-5;  // half the spacing of floats near 100 m, rounded up

double hills(double x, double y) { return 40.0 + 5.0 * std::sin(x / 15.0) * std::cos(y / 12.0); }

// A hole and a ragged edge, so that all void reasons occur.
core::Block pierced(const core::Block& b) {
  std::vector<std::uint32_t> rows;
  for (size_t i = 0; i < b.size(); ++i)
    if (std::hypot(b.x[i] - 40.0, b.y[i] - 45.0) > 12.0) rows.push_back(static_cast<std::uint32_t>(i));
  return core::select(b, rows);
}

TEST(Dtm, PlaneAndItsSigma) {
  const auto plane = [](double x, double y) { return 50.0 + 0.2 * x - 0.1 * y; };
  core::Block b = test::random_points(4000, 60.0, plane, 1);
  for (float& s : b.sigma_v) s = 0.04f;
  const core::Lattice window{1.0, 500005, 4600005, 50, 50};
  const DtmOptions o;
  const core::Grid g = dtm(b, window, o);
  // Equal sigmas with full correlation: the points' own, horizontal error through the slope included; no bend on a plane.
  const double expected = std::sqrt(0.04 * 0.04 + 0.5 * (0.2 * 0.2 + 0.1 * 0.1) * 0.1 * 0.1);
  std::uint32_t n = 0;
  for (int j = 0; j < window.ny; ++j)
    for (int i = 0; i < window.nx; ++i) {
      const size_t at = window.at(i, j);
      ASSERT_EQ(g.reason[at], Void::none);
      ASSERT_NEAR(static_cast<double>(g.height[at]), plane(window.centre_x(i) - b.origin.x(), window.centre_y(j) - b.origin.y()),
                  float_step);
      ASSERT_NEAR(static_cast<double>(g.sigma[at]), expected, 1e-5);
      n += g.count[at];
    }
  std::uint32_t inside = 0;
  for (size_t i = 0; i < b.size(); ++i) inside += b.x[i] >= 5 && b.x[i] < 55 && b.y[i] >= 5 && b.y[i] < 55;
  EXPECT_EQ(n, inside);
}

/// Root mean square of error over sigma where the points' errors have a part in common and a part of their own.
double error_over_sigma(const test::Surface& surface, size_t n, double common, double own, const DtmOptions& o) {
  double sum = 0.0, cells = 0.0;
  for (unsigned draw = 0; draw < 12; ++draw) {
    std::mt19937 random(100 + draw);
    std::normal_distribution<double> gauss;
    core::Block b = test::random_points(n, 100.0, surface, 40 + draw);
    const double shift = common * (draw % 2 ? 1.0 : -1.0);
    for (double& z : b.z) z += shift + own * gauss(random);
    for (float& s : b.sigma_v) s = static_cast<float>(std::hypot(common, own));
    for (float& s : b.sigma_h) s = 0.0f;
    const core::Lattice window{1.0, 500010, 4600010, 80, 80};
    const core::Grid g = dtm(b, window, o);
    for (int j = 0; j < window.ny; ++j)
      for (int i = 0; i < window.nx; ++i) {
        const size_t at = window.at(i, j);
        if (g.reason[at] != Void::none) continue;
        const double e = static_cast<double>(g.height[at]) - surface(window.centre_x(i) - b.origin.x(), window.centre_y(j) - b.origin.y());
        sum += e * e / (static_cast<double>(g.sigma[at]) * static_cast<double>(g.sigma[at]));
        cells += 1.0;
      }
  }
  return std::sqrt(sum / cells);
}

TEST(Dtm, SigmaIsTrue) {
  // The bounds that a sigma is asked to keep, dense and sparse, whichever part of the error governs.
  constexpr double low = 0.8, high = 1.25;
  struct Case {
    const char* name;
    size_t n;
    double common, own;
  };
  for (const Case& c : {Case{"dense, common", 20000, 0.05, 0.01}, Case{"dense, noise", 20000, 0.01, 0.05}, Case{"both", 20000, 0.04, 0.04},
                        Case{"sparse", 2500, 0.02, 0.02}, Case{"sparser", 800, 0.02, 0.02}, Case{"exact and sparse", 800, 0.0, 0.0}}) {
    const double ratio = error_over_sigma(hills, c.n, c.common, c.own, {});
    EXPECT_GT(ratio, low) << c.name;
    EXPECT_LT(ratio, high) << c.name;
  }
}

TEST(Dtm, NaturalNeighboursAreSmootherAndTheSameForEveryTiling) {
  DtmOptions o;
  o.max_edge = core::Metres(12.0);
  o.cell = core::Metres(0.25);
  const core::Block b = test::random_points(2500, 80.0, hills, 3);
  const core::Lattice window{0.25, 2000120, 18400120, 160, 160};
  // Creases: change of slope from cell to cell beyond that of the terrain.
  const auto creases = [&](const core::Grid& g) {
    double sum = 0;
    for (int j = 0; j < window.ny; ++j)
      for (int i = 1; i + 1 < window.nx; ++i) {
        const auto error = [&](int k) {
          return static_cast<double>(g.height[window.at(k, j)]) -
                 hills(window.centre_x(k) - b.origin.x(), window.centre_y(j) - b.origin.y());
        };
        sum += std::pow(error(i - 1) - 2.0 * error(i) + error(i + 1), 2);
      }
    return std::sqrt(sum / static_cast<double>(window.size()));
  };
  const double linear = creases(dtm(b, window, o));
  o.interpolation = Interpolation::natural_neighbour;
  const core::Grid whole = dtm(b, window, o);
  EXPECT_LT(creases(whole), 0.7 * linear);
  for (const int cells : {50, 121}) {
    const core::Grid t = test::tiled(b, window, cells, halo(o), [&](const core::Block& p, const core::Lattice& w) { return dtm(p, w, o); });
    EXPECT_TRUE(test::same_bits(t.height, whole.height)) << cells;
    EXPECT_TRUE(test::same_bits(t.sigma, whole.sigma)) << cells;
  }
}

TEST(Dtm, SigmaCoversTheErrorBetweenSparsePoints) {
  // Exact points on hills: all error is interpolation. Two sigma should hold for most cells, and sigma be no larger than the error.
  core::Block b = test::random_points(2500, 100.0, hills, 2);
  for (float& s : b.sigma_v) s = 0.0f;
  for (float& s : b.sigma_h) s = 0.0f;
  const core::Lattice window{1.0, 500010, 4600010, 80, 80};
  const core::Grid g = dtm(b, window, {});
  double held = 0.0, error2 = 0.0, sigma2 = 0.0;
  for (int j = 0; j < window.ny; ++j)
    for (int i = 0; i < window.nx; ++i) {
      const size_t at = window.at(i, j);
      const double e = static_cast<double>(g.height[at]) - hills(window.centre_x(i) - b.origin.x(), window.centre_y(j) - b.origin.y());
      held += std::abs(e) <= 2.0 * static_cast<double>(g.sigma[at]) + float_step;
      error2 += e * e;
      sigma2 += static_cast<double>(g.sigma[at]) * static_cast<double>(g.sigma[at]);
    }
  EXPECT_GT(held / static_cast<double>(window.size()), 0.92);
  EXPECT_LT(std::sqrt(sigma2 / error2), 1.25);
  RecordProperty("rms_error_mm", static_cast<int>(1e3 * std::sqrt(error2 / static_cast<double>(window.size()))));
}

TEST(Dtm, SameBitsForEveryTiling) {
  DtmOptions o;
  o.max_edge = core::Metres(8.0);
  const auto random = test::random_points(9000, 80.0, hills, 3);
  for (const core::Block& all : {random, test::lattice_points(80, hills), test::quantised(random, 0.001), test::quantised(random, 0.25),
                                 test::random_points(700, 80.0, hills, 6)}) {
    const core::Block b = pierced(all);
    const core::Lattice window{1.0, 499996, 4599996, 88, 88};
    const core::Grid whole = dtm(b, window, o);
    for (const Void r : {Void::none, Void::long_edge, Void::no_data})
      EXPECT_GT(std::count(whole.reason.begin(), whole.reason.end(), r), 20) << static_cast<int>(r);
    for (const int cells : {11, 29, 64}) {
      const core::Grid t =
          test::tiled(b, window, cells, halo(o), [&](const core::Block& p, const core::Lattice& w) { return dtm(p, w, o); });
      EXPECT_TRUE(test::same_bits(t.height, whole.height)) << cells;
      EXPECT_TRUE(test::same_bits(t.sigma, whole.sigma)) << cells;
      EXPECT_EQ(t.count, whole.count) << cells;
      EXPECT_EQ(t.reason, whole.reason) << cells;
    }
  }
}

TEST(Dtm, OnlyUsableTerrainPointsCount) {
  test::Made m;
  for (int j = 0; j <= 10; ++j)
    for (int i = 0; i <= 10; ++i) {
      m.add(i, j, 7.0);
      m.add(i + 0.3, j + 0.3, 20.0, 0.03f, core::point_class::building);
      m.add(i + 0.6, j + 0.6, -20.0);
      m.block.flags.resize(m.block.size(), 0);
      m.block.flags.back() = core::flag::withheld;
    }
  const core::Lattice window{1.0, 500000, 4600000, 10, 10};
  for (const float h : dtm(m.block, window, {}).height) EXPECT_EQ(h, 7.0f);
  DtmOptions roofs;
  roofs.classes = {core::point_class::building};
  const core::Grid g = dtm(m.block, window, roofs);
  EXPECT_EQ(g.height[window.at(5, 5)], 20.0f);
}

TEST(Dtm, UnknownSigmaIsNotANumber) {
  core::Block b = test::random_points(500, 20.0, hills, 5);
  const core::Lattice window{1.0, 500005, 4600005, 10, 10};
  b.sigma_v.assign(b.size(), std::nanf(""));
  for (const float s : dtm(b, window, {}).sigma) EXPECT_TRUE(std::isnan(s));
}

TEST(Dtm, PointsWithoutASigmaGiveTheirScatters) {
  // White noise alone: the model's sigma follows from how the points scatter.
  const core::Lattice window{1.0, 500020, 4600020, 60, 60};
  for (const double noise : {0.02, 0.10}) {
    double sum = 0.0;
    for (unsigned seed = 1; seed <= 4; ++seed) {
      core::Block b = test::random_points(20000, 100.0, hills, seed);
      b.sigma_v.clear();
      b.sigma_h.clear();
      std::mt19937 random(seed);
      std::normal_distribution<double> error(0.0, noise);
      for (double& z : b.z) z += error(random);
      const core::Grid g = dtm(b, window, {});
      for (int j = 0; j < window.ny; ++j)
        for (int i = 0; i < window.nx; ++i) {
          const size_t at = window.at(i, j);
          const double e = static_cast<double>(g.height[at]) - hills(window.centre_x(i) - b.origin.x(), window.centre_y(j) - b.origin.y());
          sum += std::pow(e / static_cast<double>(g.sigma[at]), 2);
        }
    }
    const double ratio = std::sqrt(sum / (4.0 * static_cast<double>(window.size())));
    EXPECT_GT(ratio, 0.8) << noise;
    EXPECT_LT(ratio, 1.25) << noise;
  }
}

TEST(Dtm, SigmaCoversScatterThatOnlyAdds) {
  // Echoes of low plants merged with the ground's, in a patch of 20 m: the mean of what they add is in the model, however many there are.
  constexpr double noise = 0.02, added = 0.10;
  const core::Lattice inside{1.0, 500043, 4600043, 14, 14}, outside{1.0, 500010, 4600010, 14, 14};
  double in = 0.0, out = 0.0;
  constexpr int seeds = 3;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    core::Block b = test::random_points(40000, 100.0, hills, seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> error(0.0, noise);
    std::exponential_distribution<double> plants(1.0 / added);
    for (size_t p = 0; p < b.size(); ++p) {
      b.z[p] += error(random) + (std::abs(b.x[p] - 50.0) < 10.0 && std::abs(b.y[p] - 50.0) < 10.0 ? plants(random) : 0.0);
      b.sigma_v[p] = static_cast<float>(noise);
      b.sigma_h[p] = 0.0F;
    }
    for (const core::Lattice& window : {inside, outside}) {
      const core::Grid g = dtm(b, window, {});
      for (int j = 0; j < window.ny; ++j)
        for (int i = 0; i < window.nx; ++i) {
          const size_t at = window.at(i, j);
          const double e = static_cast<double>(g.height[at]) - hills(window.centre_x(i) - b.origin.x(), window.centre_y(j) - b.origin.y());
          (window == inside ? in : out) += std::pow(e / static_cast<double>(g.sigma[at]), 2) / (seeds * static_cast<double>(window.size()));
        }
    }
  }
  EXPECT_GT(std::sqrt(in), 0.8);
  EXPECT_LT(std::sqrt(in), 1.25);
  EXPECT_GT(std::sqrt(out), 0.5);  // 30 m away the plants do not count
  EXPECT_LT(std::sqrt(out), 1.25);
}

TEST(Dtm, EmptyAndDegenerateInput) {
  test::Made m;
  const core::Lattice window{1.0, 500000, 4600000, 4, 4};
  for (int n = 0; n < 4; ++n) {
    const core::Grid g = dtm(m.block, window, {});
    for (const Void r : g.reason) EXPECT_EQ(r, Void::no_data);
    for (const float h : g.height) EXPECT_TRUE(std::isnan(h));
    m.add(n, n, 0.0);
  }
  EXPECT_THROW(dtm(m.block, core::Lattice{2.0, 0, 0, 1, 1}, {}), core::Error);
}

TEST(Dtm, OptionsAreChecked) {
  DtmOptions o;
  std::vector<core::Fault> faults;
  core::Value bad = core::Value::object();
  bad["cell"] = "5 m";
  bad["max_edge"] = "2 m";
  core::read_options(core::described(o), bad, "", faults);
  EXPECT_EQ(faults.size(), 1u);
  bad["correlation"] = 1.5;
  faults.clear();
  core::read_options(core::described(o), bad, "", faults);
  EXPECT_EQ(faults.size(), 1u);
}

}  // namespace
}  // namespace swath::terrain
