// SPDX-License-Identifier: GPL-3.0-or-later
// Halls by their walls, and an understorey, through the whole of filters.ground.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>
#include <utility>
#include <vector>

#include "filters/ground/ground.h"
#include "tests/filters/ground_truth.h"

namespace swath::filters {
namespace {

/// A hall on level ground, 60 m from all sides of the cloud, of which the part east of `rim` (m) is missing; a pulse per square metre.
test::Scene hall_of(double length, double width, double rim = 1e9) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  std::normal_distribution<double> noise(0.0, test::scene_noise);
  constexpr double beside = 60.0;
  test::Scene s;
  s.block.origin = {500000.0, 5400000.0, 0.0};
  for (double x = 0.5; x < length + 2 * beside; x += 1.0)
    for (double y = 0.5; y < width + 2 * beside; y += 1.0) {
      const double px = x + part(random) - 0.5, py = y + part(random) - 0.5;
      if (px > rim) continue;
      const bool roof = px > beside && px < beside + length && py > beside && py < beside + width;
      s.block.x.push_back(px), s.block.y.push_back(py), s.block.z.push_back(100.0 + (roof ? 9.0 : 0.0) + noise(random));
      s.truth.push_back(roof ? core::point_class::building : core::point_class::ground);
    }
  core::resize(s.block, s.block.x.size());
  return s;
}

TEST(GroundHalls, HallsOfAnySizeUpToLongestAreTakenOffThoughTheRimCutsThem) {
  for (const auto& [length, width] : {std::pair(80.0, 40.0), std::pair(40.0, 80.0), std::pair(150.0, 90.0), std::pair(90.0, 150.0)})
    for (const double left : {0.25, 0.5, 0.75, 2.0}) {
      test::Scene s = hall_of(length, width, 60.0 + left * length);
      const GroundChances n = classify_ground(s.block, s.block.size(), {});
      const test::GroundErrors e = test::ground_errors(s.block, s.truth);
      EXPECT_LT(e.type_2(), 0.1) << length << " x " << width << ", " << left;
      EXPECT_LT(e.type_1(), 0.5) << length << " x " << width << ", " << left;
      EXPECT_TRUE(n.raised.empty());
    }
}

TEST(GroundHalls, AHallTooLongToBeTakenOffIsReportedOnceWithPlaceAndSize) {
  test::Scene s = hall_of(300.0, 200.0);
  const GroundChances n = classify_ground(s.block, s.block.size(), {});
  EXPECT_GT(test::ground_errors(s.block, s.truth).type_2(), 50.0);
  ASSERT_EQ(n.raised.size(), 1u);
  EXPECT_NEAR(n.raised[0].east, 500210.0, 1.0);
  EXPECT_NEAR(n.raised[0].north, 5400160.0, 1.0);
  EXPECT_NEAR(n.raised[0].length, 300.0, 3.0);
  EXPECT_NEAR(n.raised[0].width, 200.0, 3.0);
  EXPECT_NEAR(n.raised[0].rise, 9.0, 0.2);
  // Of four tiles one has its place, and they all see it the same way.
  size_t reported = 0;
  for (const double x0 : {0.0, 210.0})
    for (const double y0 : {0.0, 160.0}) {
      std::vector<std::uint32_t> own, others;
      for (std::uint32_t p = 0; p < s.block.size(); ++p)
        (s.block.x[p] >= x0 && s.block.x[p] < x0 + 210.0 && s.block.y[p] >= y0 && s.block.y[p] < y0 + 160.0 ? own : others).push_back(p);
      const size_t count = own.size();
      own.insert(own.end(), others.begin(), others.end());
      core::Block tile = core::select(s.block, own);
      for (const RaisedSurface& r : classify_ground(tile, count, {}).raised) {
        const double x = r.x - 500000.0, y = r.y - 5400000.0;
        if (x < x0 || x >= x0 + 210.0 || y < y0 || y >= y0 + 160.0) continue;
        ++reported;
        EXPECT_EQ(r.east, n.raised[0].east);
        EXPECT_EQ(r.length, n.raised[0].length);
      }
    }
  EXPECT_EQ(reported, 1u);
  GroundOptions o;
  o.longest = core::Metres(310.0);
  EXPECT_TRUE(classify_ground(s.block, s.block.size(), o).raised.empty());
  EXPECT_LT(test::ground_errors(s.block, s.truth).type_2(), 0.1);
}

TEST(GroundUnderstorey, IsNotTakenForGround) {
  // 3 pulses per square metre, of which 30 % reach the ground under a canopy; 40 % end in plants of 0.5 to 2 m, in strips of 12 m.
  std::mt19937 random(11);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  std::normal_distribution<double> noise(0.0, test::scene_noise);
  test::Scene s;
  s.block.origin = {500000.0, 5400000.0, 0.0};
  const auto add = [&](double x, double y, double above, int number, int of, std::uint8_t truth) {
    s.block.x.push_back(x), s.block.y.push_back(y);
    s.block.z.push_back(300.0 + 0.1 * x + 1.5 * std::sin(0.05 * y) + above + noise(random));
    s.block.return_number.push_back(static_cast<std::uint8_t>(number)), s.block.return_count.push_back(static_cast<std::uint8_t>(of));
    s.truth.push_back(truth);
  };
  constexpr double side = 120.0;
  for (int k = 0; k < 3 * side * side; ++k) {
    const double x = side * part(random), y = side * part(random), share = part(random), crown = 6.0 + 12.0 * part(random);
    const bool grows = std::fmod(x, 24.0) < 18.0, split = part(random) < 0.6;
    const bool low = share > 0.3 && share < 0.7 && grows;
    if (share >= 0.7) {
      add(x, y, crown, 1, 1, core::point_class::high_vegetation);
      continue;
    }
    if (split) add(x, y, crown, 1, 2, core::point_class::high_vegetation);
    const double top = 1.25 + 0.75 * std::sin(0.4 * x) * std::cos(0.3 * y);
    add(x, y, low ? 0.5 + (top - 0.5) * part(random) : 0.0, split ? 2 : 1, split ? 2 : 1,
        low ? core::point_class::low_vegetation : core::point_class::ground);
  }
  core::resize(s.block, s.block.x.size());
  classify_ground(s.block, s.block.size(), {});
  double plants = 0, taken = 0;
  for (size_t p = 0; p < s.block.size(); ++p) {
    plants += s.truth[p] == core::point_class::low_vegetation;
    taken += s.truth[p] == core::point_class::low_vegetation && s.block.classification[p] == core::point_class::ground;
  }
  std::printf("understorey taken for ground: %.2f %%\n", 100.0 * taken / plants);
  EXPECT_LT(taken, 0.05 * plants);
  EXPECT_LT(test::ground_errors(s.block, s.truth).type_1(), 1.0);
}

}  // namespace
}  // namespace swath::filters
