// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/shoot.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "core/block.h"
#include "simulate/planned_flight.h"
#include "simulate/scan.h"

namespace swath::simulate {
namespace {

/// A small survey's parts.
struct Parts {
  Options o;
  World world;
  MapPatch map;
  PlannedFlight flight;
  core::GpsTime start = core::from_week(2317, 1000.0);
  explicit Parts(const Options& options)
      : o(options),
        world(o.world, o.seed, o.flight.direction, 600),
        map(core::Crs(o.crs), {o.latitude.value, o.longitude.value, o.world.ground.value}, 600, world.relief().lowest() - 60, 1000),
        flight(o.flight, {o.latitude.value, o.longitude.value, o.world.ground.value}, o.world.ground.value + o.flight.height.value,
               plan_lines(o.flight, o.world, 0.35, map.convergence()), 1.0, o.seed) {}
  Returns shoot(std::int64_t first, std::int64_t last) const {
    Returns r;
    Shooter(o, world, map, flight, start).shoot(flight.lines()[0], first, last, r);
    return r;
  }
};

Options small(Pattern pattern = Pattern::triangle) {
  Options o;
  o.scanner.pattern = pattern;
  o.scanner.prf = core::Hertz(2000);
  o.flight.lines = 1;
  o.flight.cross_lines = 0;
  o.world.length = core::Metres(300);
  return o;
}

TEST(Shoot, AnySplitGivesTheSameReturns) {
  const Parts p(small());
  const Returns whole = p.shoot(0, 3000);
  Returns split = p.shoot(0, 1);
  append(split, p.shoot(1, 1777));
  append(split, p.shoot(1777, 3000));
  for_each_column([&](auto column) { EXPECT_EQ(whole.*column, split.*column); });
  EXPECT_GT(whole.size(), 2900u);
}

TEST(Shoot, ReturnsOfAPulseAreAdjacentAndOrdered) {
  Options o = small();
  o.world.scene = Scene::forest;
  const Returns r = Parts(o).shoot(0, 8000);
  size_t several = 0;
  for (size_t i = 0; i < r.size();) {
    const auto n = static_cast<size_t>(r.count[i]);
    ASSERT_LE(n, 4u);
    for (size_t k = 0; k < n; ++k) {
      ASSERT_EQ(r.number[i + k], static_cast<double>(k + 1));
      ASSERT_EQ(r.count[i + k], r.count[i]);
      ASSERT_EQ(r.time[i + k], r.time[i]);
      if (k > 0) {
        ASSERT_GT(r.true_range[i + k], r.true_range[i + k - 1]);
      }
    }
    several += n > 1;
    i += n;
  }
  EXPECT_GT(several, 800u);
}

TEST(Shoot, NoiseFreeRecordsGiveTheTruthThroughTheCalibration) {
  for (const Pattern pattern : {Pattern::triangle, Pattern::sine, Pattern::polygon, Pattern::profile, Pattern::beam, Pattern::multibeam,
                                Pattern::conical, Pattern::palmer}) {
    Options o = small(pattern);
    o.noise.noise_free = true;
    core::Calibration& c = o.mounting.truth;
    c.scan_offset = core::degrees(0.07);
    c.range_scale = 1.0001;
    c.latency = core::Seconds(0.003);
    const Returns r = Parts(o).shoot(0, 500);
    ASSERT_GE(r.size(), 490u);
    for (size_t i = 0; i < r.size(); ++i) {
      const double angle = pattern == Pattern::profile ? c.scan_offset.value : c.scan_scale * r.angle[i] + c.scan_offset.value;
      EXPECT_NEAR(c.range_scale * r.range[i] + c.range_offset.value, r.true_range[i], 1e-9);
      EXPECT_LT((beam_of(o.scanner, angle, r.forward[i]) - Eigen::Vector3d(r.beam_x[i], r.beam_y[i], r.beam_z[i])).norm(), 1e-12);
      EXPECT_NEAR(r.time[i] + c.latency.value, r.true_time[i], 2.5e-7);  // the resolution of a double of GPS time
    }
  }
}

TEST(Shoot, AMirrorThatStandsStillReadsZeroAndLooksDown) {
  Options o = small();
  o.mounting.truth.scan_offset = core::degrees(0.07);
  const Parts p(o);
  Line parked = p.flight.lines()[0];
  parked.scans = false;
  Returns r;
  Shooter(p.o, p.world, p.map, p.flight, p.start).shoot(parked, 0, 2000, r);
  ASSERT_GT(r.size(), 1900u);
  double square = 0;
  for (size_t i = 0; i < r.size(); ++i) {
    EXPECT_EQ(r.true_angle[i], o.mounting.truth.scan_offset.value);
    EXPECT_EQ(r.edge[i], 0.0);
    square += r.angle[i] * r.angle[i];
  }
  // The encoder's noise alone; returns of one pulse share it.
  const auto n = static_cast<double>(r.size());
  EXPECT_NEAR(std::sqrt(square / n) / o.noise.scan_angle.value, 1.0, 5 * std::sqrt(0.5 / n) * 1.3 + 0.01);
}

TEST(Shoot, RecordErrorsHaveTheirSigmas) {
  Options o = small();
  o.scanner.prf = core::Hertz(5000);
  o.noise.multipath = o.noise.low_points = o.noise.high_points = 0.0;
  const Returns r = Parts(o).shoot(0, 20000);
  const core::Calibration& c = o.mounting.truth;
  double range = 0, angle = 0, pointing = 0, mean = 0;
  for (size_t i = 0; i < r.size(); ++i) {
    const double error = c.range_scale * r.range[i] + c.range_offset.value - r.true_range[i];
    mean += error;
    range += error * error;
    angle += std::pow(c.scan_scale * r.angle[i] + c.scan_offset.value - r.true_angle[i], 2);
    const Eigen::Vector3d off = Eigen::Vector3d(r.beam_x[i], r.beam_y[i], r.beam_z[i]) - beam_of(o.scanner, r.true_angle[i], r.forward[i]);
    pointing += off.squaredNorm() / 2;
  }
  const auto n = static_cast<double>(r.size());
  const double chance = 5 * std::sqrt(0.5 / n) * 1.3;  // returns of one pulse share the angle
  EXPECT_NEAR(mean / n, 0.0, 5 * o.noise.range.value / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(range / n) / o.noise.range.value, 1.0, chance);
  EXPECT_NEAR(std::sqrt(angle / n) / o.noise.scan_angle.value, 1.0, chance + 0.01);
  EXPECT_NEAR(std::sqrt(pointing / n) / (o.scanner.divergence.value / 4), 1.0, chance);
}

TEST(Shoot, OutliersComeAtTheirRates) {
  Options o = small();
  o.world.scene = Scene::flat;
  o.noise.high_points = 0.02;
  o.noise.low_points = 0.01;
  o.noise.multipath = 0.03;
  const Parts p(o);
  const Returns r = p.shoot(0, 10000);
  double high = 0, low = 0;
  for (size_t i = 0; i < r.size(); ++i) {
    const double above = r.height[i] - p.world.relief().height(r.east[i] - p.map.map_origin().x(), r.north[i] - p.map.map_origin().y());
    if (r.kind[i] == core::point_class::high_noise) {
      ++high;
      EXPECT_GT(above, 5.0);
    } else if (r.kind[i] == core::point_class::low_noise) {
      ++low;
      EXPECT_LT(above, -0.3);
    }
  }
  const auto n = static_cast<double>(r.size());
  EXPECT_NEAR(high / n, 0.02, 5 * std::sqrt(0.02 / n));
  EXPECT_NEAR(low / n, 0.04, 5 * std::sqrt(0.04 / n));
}

TEST(Shoot, GroupsOfLowPointsLieTogetherAtOneDepth) {
  Options o = small();
  o.world.scene = Scene::flat;
  o.scanner.prf = core::Hertz(20000);
  o.noise.high_points = o.noise.low_points = o.noise.multipath = 0.0;
  o.noise.low_groups = 20.0;
  const Parts p(o);
  const Returns r = p.shoot(0, 40000);
  // Depths by place: one group in each cell of 22.4 m.
  const double side = std::sqrt(1e4 / o.noise.low_groups);
  std::map<std::pair<int, int>, std::vector<double>> groups;
  std::map<std::pair<int, int>, Eigen::AlignedBox2d> places;
  size_t low = 0;
  for (size_t i = 0; i < r.size(); ++i) {
    const double e = r.east[i] - p.map.map_origin().x(), n = r.north[i] - p.map.map_origin().y();
    const double depth = p.world.relief().height(e, n) - r.height[i];
    if (r.kind[i] != core::point_class::low_noise) {
      ASSERT_LT(depth, 0.01);
      continue;
    }
    ++low;
    // The beam goes on aside below the ground, by up to 2.4 m: near a cell's edge the group may be the neighbour's.
    if (std::min(std::abs(std::remainder(e, side)), std::abs(std::remainder(n, side))) < 2.5) continue;
    const std::pair cell(static_cast<int>(std::floor(e / side)), static_cast<int>(std::floor(n / side)));
    groups[cell].push_back(depth);
    places[cell].extend(Eigen::Vector2d(e, n));
  }
  // 60 % of the discs' share of the ground.
  const double expected = 0.6 * core::pi * 1.5 * 1.5 * o.noise.low_groups / 1e4;
  EXPECT_NEAR(static_cast<double>(low) / static_cast<double>(r.size()), expected, 0.25 * expected);
  ASSERT_GT(groups.size(), 15u);
  for (const auto& [cell, depths] : groups) {
    const auto [least, most] = std::minmax_element(depths.begin(), depths.end());
    EXPECT_GT(*least, 0.4);  // 1 m less scatter of 0.1 m, of a slant of up to 23 degrees
    EXPECT_LT(*most, 6.6);
    EXPECT_LT(*most - *least, 1.0);
    EXPECT_LT(places[cell].sizes().maxCoeff(), 2 * 1.5 + 1.0);
  }
}

}  // namespace
}  // namespace swath::simulate
