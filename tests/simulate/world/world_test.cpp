// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/world/world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/block.h"

namespace swath::simulate {
namespace {

using Eigen::Vector3d;
constexpr double half = 700.0;
constexpr double on_surface = 5e-5;  // m

Ray ray_from(const Vector3d& from, const Vector3d& d) { return {from, d.normalized(), Vector3d(0, 0, 1e-7)}; }

Ray random_ray(Random& random, double steepest) {
  const double off = random.uniform(0, steepest), way = random.uniform(0, 2 * core::pi);
  const Vector3d d(std::sin(off) * std::cos(way), std::sin(off) * std::sin(way), -std::cos(off));
  const Vector3d foot(random.uniform(-400, 400), random.uniform(-400, 400), 600);
  return ray_from(foot - 350 * d, d);
}

TEST(World, GroundHitIsTheFirstAndLiesOnTheGround) {
  const World world({.scene = Scene::steep}, 1, core::degrees(60), half);
  Random random(5, 5, 5);
  for (int i = 0; i < 3000; ++i) {
    const Ray ray = random_ray(random, 0.9);
    double s = 0;
    ASSERT_TRUE(world.ground_hit(ray, 3000, s));
    const Vector3d q = ray.at(s);
    EXPECT_NEAR(q.z(), world.relief().height(q.x(), q.y()), 1e-6);
    for (double before = 1.0; before < 150; before += 1.0) {
      const Vector3d p = ray.at(s - before);
      ASSERT_GT(p.z(), world.relief().height(p.x(), p.y())) << "the ground was met " << before << " m earlier";
    }
  }
}

TEST(World, EchoesComeInOrderAndLieOnWhatTheyName) {
  const World world({.scene = Scene::mixed}, 2, core::degrees(60), half);
  Random random(6, 6, 6);
  int roofs = 0, walls = 0, crowns = 0, wires = 0, ground = 0, water = 0;
  Echoes echoes;
  for (int i = 0; i < 60000; ++i) {
    const Ray ray = random_ray(random, 0.5);
    Random own(1, 1, static_cast<std::uint64_t>(i));
    world.trace(ray, 3000, 0.15, own, echoes);
    ASSERT_GT(echoes.count, 0);
    for (int k = 0; k < echoes.count; ++k) {
      const Echo& e = echoes.echo[static_cast<size_t>(k)];
      if (k > 0) {
        ASSERT_LE(echoes.echo[static_cast<size_t>(k - 1)].s, e.s);
      }
      const Vector3d q = ray.at(e.s);
      const double above = q.z() - world.relief().height(q.x(), q.y());
      ASSERT_GT(above, -on_surface);
      switch (e.kind) {
        case core::point_class::ground:
          ++ground;
          [[fallthrough]];
        case core::point_class::water:
          water += e.kind == core::point_class::water;
          EXPECT_LT(above, on_surface);
          EXPECT_EQ(world.relief().is_water(q.x(), q.y()), e.kind == core::point_class::water);
          break;
        case core::point_class::building: {
          double gap = 1e9;
          bool roof = false;
          for (const Building& b : world.buildings()) {
            double outside = -1e9;
            Vector3d n = Vector3d::Zero();
            for (const Eigen::Vector4d& p : b.planes)
              if (p.head<3>().dot(q) - p[3] > outside) outside = p.head<3>().dot(q) - p[3], n = p.head<3>();
            if (std::abs(outside) < gap) gap = std::abs(outside), roof = n.z() > 0.1;
          }
          EXPECT_LT(gap, on_surface);
          (roof ? roofs : walls)++;
          break;
        }
        case core::point_class::medium_vegetation:
        case core::point_class::high_vegetation: {
          ++crowns;
          const bool inside = std::any_of(world.trees().begin(), world.trees().end(), [&](const Tree& t) {
            const Vector3d r = (q - t.centre).cwiseQuotient(Vector3d(t.radius, t.radius, t.half_height));
            return r.squaredNorm() < 1.001;
          });
          EXPECT_TRUE(inside);
          break;
        }
        case core::point_class::wire: {
          ++wires;
          const bool near = std::any_of(world.wires().begin(), world.wires().end(), [&](const Wire& w) {
            const double u = w.along.dot(q.head<2>() - w.from);
            const double v = w.along.x() * (q - Vector3d(w.from.x(), w.from.y(), 0)).y() - w.along.y() * (q.x() - w.from.x());
            const double z = w.low + w.a * (std::cosh((u - w.middle) / w.a) - 1);
            return u > -0.1 && u < w.length + 0.1 && std::abs(v) < 0.12 && std::abs(z - q.z()) < 0.02;
          });
          EXPECT_TRUE(near);
          break;
        }
        default:
          break;
      }
    }
  }
  EXPECT_GT(ground, 30000);
  EXPECT_GT(roofs, 500);
  EXPECT_GT(walls, 50);
  EXPECT_GT(crowns, 2000);
  EXPECT_GT(wires, 5);
  EXPECT_GT(water, 200);
}

TEST(World, CrownsTransmitAsBeerAndLambert) {
  const World world({.scene = Scene::forest}, 2, core::degrees(60), half);
  const auto lonely = std::find_if(world.trees().begin(), world.trees().end(), [&](const Tree& t) {
    return std::none_of(world.trees().begin(), world.trees().end(),
                        [&](const Tree& o) { return &o != &t && (o.centre - t.centre).head<2>().norm() < o.radius + 0.2; });
  });
  ASSERT_NE(lonely, world.trees().end());
  const Ray ray = ray_from(lonely->centre + Vector3d(0, 0, 300), Vector3d(0, 0, -1));
  constexpr int pulses = 20000;
  double left = 0;
  Echoes echoes;
  const Vector3d foot = lonely->centre;
  const double cosine = 1 / std::sqrt(1 + world.relief().at(foot.x(), foot.y()).gradient.squaredNorm());
  for (int i = 0; i < pulses; ++i) {
    Random random(3, 3, static_cast<std::uint64_t>(i));
    world.trace(ray, 3000, 0.1, random, echoes);
    double vegetation = 0;
    for (int k = 0; k < echoes.count; ++k)
      if (echoes.echo[static_cast<size_t>(k)].kind != core::point_class::ground) vegetation += echoes.echo[static_cast<size_t>(k)].energy;
    // What reaches the ground is what no leaf sent back: 0.45 is the leaves' reflectance.
    const Echo& last = echoes.echo[static_cast<size_t>(echoes.count - 1)];
    left += last.kind == core::point_class::ground ? last.energy / 0.35 / cosine : 0.0;
  }
  const double expected = std::exp(-lonely->extinction * 2 * lonely->half_height);
  // Low vegetation may stand below (mean loss 0.35 x 0.6); the energy's floor cuts under 3 %.
  EXPECT_GT(left / pulses, 0.75 * expected - 0.02);
  EXPECT_LT(left / pulses, expected + 0.02);
}

TEST(World, WiresHangBetweenMasts) {
  const World world({.scene = Scene::town}, 2, core::degrees(60), half);
  ASSERT_FALSE(world.wires().empty());
  for (const Wire& w : world.wires()) {
    const auto z = [&](double u) { return w.low + w.a * (std::cosh((u - w.middle) / w.a) - 1); };
    const Eigen::Vector2d across(-w.along.y(), w.along.x());
    for (const double u : {0.0, w.length}) {
      // A mast of 22 m stands within 3 m across.
      double nearest = 1e9;
      for (const double o : {-3.0, 0.0, 3.0}) {
        const Eigen::Vector2d p = w.from + u * w.along + o * across;
        nearest = std::min(nearest, std::abs(z(u) - 22.0 - world.relief().height(p.x(), p.y())));
      }
      EXPECT_LT(nearest, 1e-6);
    }
    EXPECT_LT(z(w.length / 2), 0.5 * (z(0) + z(w.length)) - 2.0);
  }
}

WorldOptions airfield() {
  WorldOptions w;
  w.scene = Scene::airfield;
  w.length = w.width = core::Metres(720);
  return w;
}

TEST(World, AirfieldHasAFlatRoofInTheMiddleAlongTheFlight) {
  for (int seed = 1; seed < 20; ++seed) {
    const core::Radians direction = core::degrees(37);
    const World world(airfield(), seed, direction, 900);
    const Building& b = world.buildings().front();
    EXPECT_EQ(b.name, "building");
    EXPECT_EQ(b.centre.norm(), 0.0);
    ASSERT_EQ(b.planes.size(), 5u);
    // Its long walls look across the flight, 20 m from its middle.
    const Eigen::Vector4d& wall = b.planes[2];
    EXPECT_NEAR(wall.head<2>().dot(Eigen::Vector2d(std::sin(direction.value), std::cos(direction.value))), 0.0, 1e-12);
    EXPECT_NEAR(wall[3], 20.0, 1e-12);
    EXPECT_NEAR(b.planes[0][3], 40.0, 1e-12);
    const Eigen::Vector4d& roof = b.planes[4];
    EXPECT_GT(roof.z(), std::cos(std::atan(0.02)));
    EXPECT_NEAR(roof[3] / roof.z() - world.relief().height(0, 0), 12.0, 0.5);
    EXPECT_LT(world.relief().highest() - world.relief().lowest(), 10.0);
  }
}

TEST(World, AirfieldsHallsAreApartAndSpreadOverAreaCompassAndSlopes) {
  for (int seed = 1; seed < 20; ++seed) {
    const World world(airfield(), seed, core::degrees(60), 900);
    const std::vector<Building>& all = world.buildings();
    ASSERT_EQ(all.size(), 17u) << seed;
    std::vector<double> bearings, slopes;
    std::array<int, 16> cells{};
    double farthest = 0;
    for (size_t i = 1; i < all.size(); ++i) {
      for (size_t k = 0; k < i; ++k) EXPECT_GT((all[i].centre - all[k].centre).norm(), all[i].radius + all[k].radius + 5.0);
      const Eigen::Vector4d& end = all[i].planes[0];
      bearings.push_back(std::fmod(std::atan2(end.x(), end.y()) + 2 * core::pi, core::pi));
      slopes.push_back(std::acos(all[i].planes[4].z()) / core::degree);
      const Eigen::Vector2d along(std::sin(core::pi / 3), std::cos(core::pi / 3)), across(along.y(), -along.x());
      const double l = along.dot(all[i].centre), w = across.dot(all[i].centre);
      ASSERT_LT(std::max(std::abs(l), std::abs(w)), 360.0);
      farthest = std::max(farthest, std::abs(w));
      ++cells[static_cast<size_t>(std::floor((l + 360) / 180)) * 4 + static_cast<size_t>(std::floor((w + 360) / 180))];
    }
    std::sort(bearings.begin(), bearings.end());
    for (size_t i = 1; i < bearings.size(); ++i) EXPECT_LT(bearings[i] - bearings[i - 1], 2.001 * core::pi / 16);
    EXPECT_GE(*std::min_element(slopes.begin(), slopes.end()), 20.0);
    EXPECT_LE(*std::max_element(slopes.begin(), slopes.end()), 45.0);
    EXPECT_GT(*std::max_element(slopes.begin(), slopes.end()), 40.0);
    EXPECT_GT(farthest, 240.0);
    // One in each cell of the lattice.
    EXPECT_EQ(*std::min_element(cells.begin(), cells.end()), 1) << seed;
  }
}

TEST(World, AirfieldFollowsTheSeedAndItsOptions) {
  const World one(airfield(), 1, core::degrees(60), 900), same(airfield(), 1, core::degrees(60), 900),
      two(airfield(), 2, core::degrees(60), 900);
  EXPECT_EQ(one.buildings()[3].centre, same.buildings()[3].centre);
  EXPECT_NE(one.buildings()[3].centre, two.buildings()[3].centre);
  EXPECT_GT(one.trees().size(), 5u);
  WorldOptions w = airfield();
  w.buildings = 0.0;
  w.trees = 0.0;
  const World bare(w, 1, core::degrees(60), 900);
  EXPECT_TRUE(bare.buildings().empty());
  EXPECT_TRUE(bare.trees().empty());
  // Areas of any shape hold their halls.
  for (const auto& [length, width] : {std::pair{300.0, 300.0}, {150.0, 900.0}, {2000.0, 400.0}, {60.0, 60.0}}) {
    w = airfield();
    w.length = core::Metres(length);
    w.width = core::Metres(width);
    w.buildings = 0.9;
    const World world(w, 1, core::degrees(60), 1500);
    EXPECT_NEAR(static_cast<double>(world.buildings().size()), 1 + 0.9 * length * width / 1e4, 0.3 * 0.9 * length * width / 1e4 + 1.0)
        << length << " x " << width;
  }
}

TEST(Detect, KeepsStrongSeparateFirstAndLast) {
  const auto made = [](std::initializer_list<std::pair<double, double>> list) {
    Echoes e;
    for (const auto& [s, energy] : list) e.add({s, energy, 1, 5});
    return e;
  };
  Echoes e = made({{10, 0.5}, {10.5, 0.5}, {12, 0.01}, {14, 0.1}, {15.5, 0.1}, {18, 0.2}, {20, 0.3}});
  detect(e, 1.2, 4);
  ASSERT_EQ(e.count, 4);
  EXPECT_EQ(e.echo[0].s, 10);
  EXPECT_EQ(e.echo[1].s, 14);
  EXPECT_EQ(e.echo[2].s, 15.5);
  EXPECT_EQ(e.echo[3].s, 20);
  Echoes one = made({{10, 0.5}, {14, 0.4}});
  detect(one, 1.2, 1);
  EXPECT_EQ(one.count, 1);
  Echoes none = made({{10, 0.001}});
  detect(none, 1.2, 4);
  EXPECT_EQ(none.count, 0);
}

}  // namespace
}  // namespace swath::simulate
