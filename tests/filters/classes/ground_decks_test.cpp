// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/classes/ground_decks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>
#include <random>

#include "tests/world/scene.h"

namespace swath::filters {
namespace {

namespace cls = core::point_class;

/// A point's height and class; nothing where no beam comes back.
struct Return {
  double z;
  std::uint8_t kind = cls::ground;
};
using Scene = std::function<std::optional<Return>(double, double)>;

/// One return per 1 / density m2 over 120 x 100 m.
core::Block returns(const Scene& scene, double density = 5.0) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  core::Block b;
  std::vector<std::uint8_t> kinds;
  for (int k = 0; k < 120 * 100 * density; ++k) {
    const double x = 120.0 * uniform(random), y = 100.0 * uniform(random);
    const std::optional<Return> r = scene(x, y);
    if (!r) continue;
    test::add_point(b, x, y, r->z + 0.04 * (uniform(random) - 0.5));
    kinds.push_back(r->kind);
  }
  b.classification = kinds;
  return b;
}

std::vector<std::uint8_t> decks(const core::Block& b) { return ground_decks(b, districts(b), 60.0, b.size()); }
size_t count(const std::vector<std::uint8_t>& found) {
  size_t n = 0;
  for (const std::uint8_t d : found) n += d;
  return n;
}

bool in_canal(double x) { return std::abs(x - 60.0) < 7.0; }

/// A canal along y between quays, with a road bridge across it, `wide` m, and its water as wanted.
Scene bridge(double wide, std::optional<Return> water) {
  return [=](double x, double y) -> std::optional<Return> {
    if (std::abs(y - 50.0) < 0.5 * wide) return Return{in_canal(x) ? 0.6 * std::cos((x - 60.0) / 7.0 * 1.57) : 0.0};
    if (in_canal(x)) return water;
    return Return{0.0};
  };
}

/// Share of the bridge's returns that are found, and how many others are.
std::pair<double, size_t> found_of(const core::Block& b, double wide) {
  const std::vector<std::uint8_t> found = decks(b);
  double on = 0, all = 0;
  size_t others = 0;
  for (size_t p = 0; p < b.size(); ++p) {
    const bool is = in_canal(b.x[p]) && std::abs(b.y[p] - 50.0) < 0.5 * wide;
    all += is, on += is && found[p];
    others += !is && found[p] && std::abs(b.x[p] - 60.0) > 9.5;
  }
  return {on / all, others};
}

TEST(GroundDecks, BridgesOverACanalWithAndWithoutReturnsOfItsWater) {
  for (const double wide : {3.0, 10.0})
    for (const std::optional<Return>& water :
         {std::optional<Return>{}, std::optional<Return>{{-1.6, cls::water}}, std::optional<Return>{{-1.6}}}) {
      const auto [share, others] = found_of(returns(bridge(wide, water)), wide);
      EXPECT_GE(share, 0.9) << wide << (water ? " with" : " without") << " water";
      EXPECT_EQ(others, 0u) << wide;
    }
}

TEST(GroundDecks, RailingsOverTheWaterAreOfTheDeckAndBushesOnTheBankAreNot) {
  constexpr double half = 3.0;
  const auto rail = [](double x, double y) { return std::abs(std::abs(y - 50.0) - half - 0.3) < 0.2 && std::abs(x - 60.0) < 6.0; };
  const auto bush = [](double x, double y) { return std::abs(y - 50.0) < half && x > 75.0 && x < 77.0; };
  const auto crown = [](double x, double y) { return std::abs(x - 60.0) < 7.0 && y > 55.0 && y < 58.0; };
  const Scene deck = bridge(2.0 * half, std::nullopt);
  const core::Block b = returns(
      [&](double x, double y) -> std::optional<Return> {
        if (rail(x, y)) return Return{1.4, cls::unassigned};
        if (bush(x, y)) return Return{0.8, cls::unassigned};
        if (crown(x, y)) return Return{4.0, cls::unassigned};
        return deck(x, y);
      },
      14.0);
  const std::vector<std::uint8_t> found = decks(b);
  double rails = 0, all = 0, on = 0, deck_points = 0;
  for (size_t p = 0; p < b.size(); ++p) {
    if (rail(b.x[p], b.y[p])) {
      ++all, rails += found[p];
    } else if (b.classification[p] != cls::ground) {
      EXPECT_FALSE(found[p]) << b.x[p] << " " << b.y[p];
    } else if (in_canal(b.x[p])) {
      ++deck_points, on += found[p];
    }
  }
  EXPECT_GE(rails, 0.9 * all);
  EXPECT_GE(on, 0.9 * deck_points);
}

TEST(GroundDecks, LandBetweenAScarpAndACornerOfTheDataIsNone) {
  const Scene corner = [](double x, double y) -> std::optional<Return> {
    if (y < 50.0 - std::abs(x - 60.0) / 1.5) return std::nullopt;  // beyond the rim, which opens by 113 degrees
    return y > 58.0 ? Return{std::max(-8.0, 3.0 * (58.0 - y))} : Return{0.0};
  };
  EXPECT_EQ(count(decks(returns(corner))), 0u);
}

TEST(GroundDecks, LandBetweenAScarpAndANotchInTheRimOfTheDataIsNone) {
  const Scene notch = [](double x, double y) -> std::optional<Return> {
    if (y < 50.0 - std::abs(x - 60.0) / 0.6 || y < 36.0) return std::nullopt;  // opens by 62 degrees, and ends after 14 m
    return y > 58.0 ? Return{std::max(-8.0, 3.0 * (58.0 - y))} : Return{0.0};
  };
  EXPECT_EQ(count(decks(returns(notch))), 0u);
}

TEST(GroundDecks, ABridgeOfThinReturns) {
  const auto [share, others] = found_of(returns(bridge(14.0, std::nullopt), 1.2), 14.0);
  EXPECT_GE(share, 0.4);
  EXPECT_EQ(others, 0u);
}

TEST(GroundDecks, DamsEmbankmentsAndCausewaysWithBanksStayGround) {
  for (const double slope : {0.25, 0.5, 0.66, 1.0}) {
    const auto bank = [slope](double y) { return -slope * std::max(std::abs(y - 50.0) - 4.0, 0.0); };
    for (const double freeboard : {0.3, 0.5, 0.8, 1.2, 1.5}) {
      if (freeboard < 0.5 && slope >= 0.5) continue;  // half a metre of bank, which few beams meet
      const Scene causeway = [=](double x, double y) -> std::optional<Return> {
        if (std::abs(x - 60.0) > 20.0) return Return{0.0};
        return bank(y) > -freeboard ? std::optional<Return>{{bank(y)}} : std::nullopt;
      };
      EXPECT_EQ(count(decks(returns(causeway))), 0u) << slope << " " << freeboard;
    }
    if (slope > 0.66) continue;  // sheer
    const Scene dike = [=](double x, double y) {
      return std::optional<Return>{{std::abs(x - 60.0) > 20.0 ? 0.0 : std::max(bank(y), -5.0)}};
    };
    EXPECT_EQ(count(decks(returns(dike))), 0u) << slope;
  }
}

TEST(GroundDecks, TerracesQuaysAndPiersStayGround) {
  const Scene terrace = [](double x, double) { return std::optional<Return>{{x < 60.0 ? 3.0 : 0.0}}; };
  EXPECT_EQ(count(decks(returns(terrace))), 0u);
  const Scene quay = [](double x, double) { return in_canal(x) ? std::nullopt : std::optional<Return>{{0.0}}; };
  EXPECT_EQ(count(decks(returns(quay))), 0u);
  const Scene pier = [](double x, double y) {
    return x > 40.0 && (x > 70.0 || std::abs(y - 50.0) > 3.0) ? std::nullopt : std::optional<Return>{{0.0}};
  };
  EXPECT_EQ(count(decks(returns(pier))), 0u);
}

TEST(GroundDecks, ATerraceAtTheRimOfTheDataStaysGround) {
  const Scene rim = [](double x, double y) {
    return y > 20.0 + 0.3 * x ? std::optional<Return>{{x > 20.0 + 0.5 * y ? 3.0 : 0.0}} : std::nullopt;
  };
  EXPECT_EQ(count(decks(returns(rim))), 0u);
  const Scene strip = [](double x, double y) {  // the data of one flight line
    return std::abs(y - 50.0 - 0.3 * (x - 60.0)) < 8.0 ? std::optional<Return>{{0.0}} : std::nullopt;
  };
  EXPECT_EQ(count(decks(returns(strip))), 0u);
}

TEST(GroundDecks, GroundThatBuildingsOrCrownsHideOnBothSidesStays) {
  const auto alley = [](double high, double crown) {
    return [=](double x, double y) -> std::optional<Return> {
      const double off = std::abs(y - 50.0);
      if (std::abs(x - 60.0) > 15.0 || off < 3.0 || off > 25.0) return Return{0.0};
      if (off < 5.0) return std::nullopt;  // the beam's shadow
      return Return{high + crown * std::sin(40.0 * x * y), cls::unassigned};
    };
  };
  EXPECT_EQ(count(decks(returns(alley(8.0, 0.0)))), 0u);
  EXPECT_EQ(count(decks(returns(alley(8.0, 3.0)))), 0u);
}

TEST(GroundDecks, DoNotDependOnTheOrderOrOnTiles) {
  core::Block b = returns(bridge(10.0, std::nullopt));
  const std::vector<std::uint8_t> whole = decks(b);
  ASSERT_GT(count(whole), 100u);
  std::vector<std::uint32_t> rows;
  const std::vector<std::uint8_t> again = decks(test::shuffled(b, 5, rows));
  for (size_t k = 0; k < rows.size(); ++k) EXPECT_EQ(again[k], whole[rows[k]]);
  const auto filter = [](core::Block& tile, size_t own) {
    const std::vector<std::uint8_t> found = ground_decks(tile, districts(tile), 30.0, own);
    for (size_t p = 0; p < own; ++p)
      if (found[p]) tile.classification[p] = cls::bridge_deck;
  };
  core::Block at_once = b;
  filter(at_once, at_once.size());
  core::add_columns(b, {core::Column::flags});
  EXPECT_EQ(test::run_tiled(b, 37.0, ground_decks_halo(30.0), filter).classification, at_once.classification);
}

}  // namespace
}  // namespace swath::filters
