// SPDX-License-Identifier: GPL-3.0-or-later
// Hall, bridge, fields, woodland and cover of the zoo.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/block.h"
#include "simulate/world/world.h"

namespace swath::simulate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
namespace cls = core::point_class;

constexpr double half = 750.0;
constexpr double on_surface = 5e-5;  // m

WorldOptions zoo() {
  WorldOptions w;
  w.scene = Scene::zoo;
  w.length = core::Metres(600);
  w.width = core::Metres(400);
  return w;
}
World zoo_of(std::int64_t seed, const WorldOptions& w = zoo()) { return World(w, seed, core::degrees(60), half); }

/// A ray to `foot`, `off` from the vertical, coming from the bearing `way`.
Ray ray_to(const Vector3d& foot, double off, double way) {
  const Vector3d d(std::sin(off) * std::cos(way), std::sin(off) * std::sin(way), -std::cos(off));
  return {foot - 350 * d, d, Vector3d::Zero()};
}

const Building& bridge_of(const World& world) {
  const auto found =
      std::find_if(world.buildings().begin(), world.buildings().end(), [](const Building& b) { return b.kind == cls::bridge_deck; });
  EXPECT_NE(found, world.buildings().end());
  return *found;
}

TEST(Structures, ABridgeSpansTheDitchFromBankToBank) {
  for (int seed = 1; seed < 10; ++seed) {
    const World world = zoo_of(seed);
    const Building& deck = bridge_of(world);
    ASSERT_EQ(deck.planes.size(), 6u);
    const Relief::Ditch& ditch = *world.relief().ditch();
    const Eigen::Vector4d& top = deck.planes[4];
    const auto above_ground = [&](const Vector2d& p) {
      return (top[3] - top.head<2>().dot(p)) / top.z() - world.relief().height(p.x(), p.y());
    };
    EXPECT_NEAR(ditch.normal.dot(deck.centre), ditch.offset, 1e-9);
    EXPECT_NEAR(above_ground(deck.centre - ditch.half_width * ditch.normal), 0.0, 1e-9);
    EXPECT_NEAR(above_ground(deck.centre + ditch.half_width * ditch.normal), 0.0, 1e-9);
    EXPECT_GT(above_ground(deck.centre), 3.0);
    for (const Tree& t : world.trees()) EXPECT_GT((t.centre.head<2>() - deck.centre).norm(), deck.radius);
  }
}

TEST(Structures, BeamsMeetTheDeckAndFromAsideTheGroundBelowIt) {
  const World world = zoo_of(1);
  const Building& deck = bridge_of(world);
  Echoes echoes;
  Random place(7, 7, 7);
  int on_deck = 0, on_side = 0, below = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vector2d p = deck.centre + Vector2d(place.uniform(-8, 8), place.uniform(-8, 8));
    const Ray ray = ray_to({p.x(), p.y(), world.relief().height(p.x(), p.y())}, place.uniform(0, 0.4), place.uniform(0, 2 * core::pi));
    Random own(1, 1, static_cast<std::uint64_t>(i));
    world.trace(ray, 3000, 0.0, own, echoes);
    ASSERT_GT(echoes.count, 0);
    const Echo& e = echoes.echo[static_cast<size_t>(echoes.count - 1)];
    const Vector3d q = ray.at(e.s);
    double outside = -1e9;
    bool within_outline = true;
    for (const Eigen::Vector4d& plane : deck.planes) {
      const double d = plane.head<3>().dot(q) - plane[3];
      outside = std::max(outside, d);
      within_outline = within_outline && (std::abs(plane.z()) > 0.5 || d < 0.0);
    }
    if (e.kind == cls::bridge_deck) {
      EXPECT_NEAR(outside, 0.0, on_surface);
      (std::abs(deck.planes[4].head<3>().dot(q) - deck.planes[4][3]) < on_surface ? on_deck : on_side)++;
    } else {
      EXPECT_GT(outside, -on_surface);
      if (e.kind == cls::ground && within_outline && q.z() < deck.top - 2.0) {
        ++below;
        EXPECT_EQ(world.cover_at(q.x(), q.y()), Cover::bridge);
      }
    }
  }
  EXPECT_GT(on_deck, 8000);
  EXPECT_GT(on_side, 50);
  EXPECT_GT(below, 50);
}

TEST(Structures, AHallOfAnySizeIsWithinTheArea) {
  WorldOptions wide = zoo();
  wide.hall_length = core::Metres(150), wide.hall_width = core::Metres(90);
  for (int seed = 1; seed < 10; ++seed) {
    const World world = zoo_of(seed, wide);
    const Building& hall = world.buildings().front();
    EXPECT_NEAR(hall.planes[0][3] + hall.planes[1][3], 150.0, 1e-9);
    EXPECT_NEAR(hall.planes[2][3] + hall.planes[3][3], 90.0, 1e-9);
    const Vector2d across(std::cos(core::pi / 3), -std::sin(core::pi / 3));
    EXPECT_LT(std::abs(across.dot(hall.centre)) + hall.radius, 0.5 * wide.width.value + 1e-9);
  }
}

TEST(Structures, TheHallIsOfItsSizeAndWithinTheArea) {
  WorldOptions town;
  town.scene = Scene::town;
  town.length = town.width = core::Metres(300);
  EXPECT_LT(World(town, 1, core::degrees(60), half).buildings().front().radius, 30.0);
  town.hall = true;
  for (int seed = 1; seed < 10; ++seed)
    for (const WorldOptions& w : {zoo(), town}) {
      const World world = zoo_of(seed, w);
      const Building& hall = world.buildings().front();
      ASSERT_EQ(hall.planes.size(), 5u);
      EXPECT_NEAR(hall.planes[0][3] + hall.planes[1][3], 80.0, 1e-9);
      EXPECT_NEAR(hall.planes[2][3] + hall.planes[3][3], 40.0, 1e-9);
      EXPECT_GE(hall.top - world.relief().height(hall.centre.x(), hall.centre.y()), 12.0 - 1e-9);
      const Vector2d along(std::sin(core::pi / 3), std::cos(core::pi / 3)), across(along.y(), -along.x());
      EXPECT_LT(std::abs(along.dot(hall.centre)), 0.5 * w.length.value - 39.0);
      EXPECT_LT(std::abs(across.dot(hall.centre)), 0.5 * w.width.value - 39.0);
      EXPECT_EQ(world.cover_at(hall.centre.x(), hall.centre.y()), Cover::building);
      for (size_t i = 1; i < world.buildings().size(); ++i) {
        const Building& b = world.buildings()[i];
        if (b.kind == cls::building) {
          EXPECT_GT((b.centre - hall.centre).norm(), b.radius + hall.radius);
        }
      }
    }
}

TEST(Structures, CropsStandAtTheirFieldsHeight) {
  WorldOptions w = zoo();
  w.low_vegetation = 0.0;
  w.crop_height = core::Metres(1.2);
  w.slope = 0.0;
  w.relief = core::Metres(0);
  const World world = zoo_of(3, w);
  ASSERT_FALSE(world.fields().empty());
  size_t planted = 0;
  for (const Field& f : world.fields()) {
    if (f.height == 0.0) continue;
    ++planted;
    EXPECT_GE(f.height, 0.1);
    EXPECT_LE(f.height, 1.2);
  }
  EXPECT_GT(planted, 20u);
  // Vertical pulses on fields, by the height of their tallest echo; and elsewhere on open ground.
  Echoes echoes;
  Random place(8, 8, 8);
  int on_fields = 0, stopped = 0;
  for (int i = 0; i < 60000; ++i) {
    const Vector2d p(place.uniform(-250, 250), place.uniform(-250, 250));
    const Cover cover = world.cover_at(p.x(), p.y());
    if (cover != Cover::low_vegetation && cover != Cover::open) continue;
    const double ground = world.relief().height(p.x(), p.y());
    Random own(2, 2, static_cast<std::uint64_t>(i));
    const Ray ray = ray_to({p.x(), p.y(), ground}, 0.0, 0.0);
    world.trace(ray, 3000, 0.0, own, echoes);
    on_fields += cover == Cover::low_vegetation;
    for (int k = 0; k < echoes.count; ++k) {
      const Echo& e = echoes.echo[static_cast<size_t>(k)];
      if (e.kind != cls::low_vegetation) continue;
      EXPECT_EQ(cover, Cover::low_vegetation);
      const double height = ray.at(e.s).z() - ground;
      EXPECT_GT(height, 0.6 * 0.1 - on_surface);
      EXPECT_LT(height, 1.2 + on_surface);
      ++stopped;
    }
  }
  ASSERT_GT(on_fields, 2000);
  // Each field draws its share evenly from 0.4 to 0.8.
  EXPECT_NEAR(stopped / static_cast<double>(on_fields), 0.6, 0.08);
}

TEST(Structures, LowVegetationReachesItsHeight) {
  for (const double tallest : {0.3, 0.8, 1.5}) {
    WorldOptions w;
    w.scene = Scene::flat;
    w.low_vegetation = 1.0;
    w.low_vegetation_height = core::Metres(tallest);
    const World world = zoo_of(1, w);
    double highest = 0.0;
    Echoes echoes;
    for (int i = 0; i < 3000; ++i) {
      Random own(3, 3, static_cast<std::uint64_t>(i));
      const Vector3d foot(0.1 * i, 5.0, world.relief().height(0.1 * i, 5.0));
      const Ray ray = ray_to(foot, 0.0, 0.0);
      world.trace(ray, 3000, 0.0, own, echoes);
      for (int k = 0; k < echoes.count; ++k) {
        const Echo& e = echoes.echo[static_cast<size_t>(k)];
        if (e.kind == cls::low_vegetation) highest = std::max(highest, ray.at(e.s).z() - foot.z());
      }
    }
    EXPECT_LE(highest, tallest + on_surface);
    EXPECT_GT(highest, 0.95 * tallest);
  }
}

TEST(Structures, TheZoosForestLetsHalfToTwoThirdsOfThePulsesThrough) {
  for (int seed = 1; seed <= 4; ++seed) {
    const World world = zoo_of(seed);
    Echoes echoes;
    Random place(9, 9, static_cast<std::uint64_t>(seed));
    int pulses = 0, through = 0;
    for (int i = 0; i < 40000; ++i) {
      const Vector2d p(place.uniform(-250, 250), place.uniform(-250, 250));
      if (world.cover_at(p.x(), p.y()) != Cover::forest) continue;
      const Ray ray = ray_to({p.x(), p.y(), world.relief().height(p.x(), p.y())}, place.uniform(0, 0.35), place.uniform(0, 2 * core::pi));
      Random own(4, 4, static_cast<std::uint64_t>(i));
      world.trace(ray, 3000, 0.15, own, echoes);
      detect(echoes, 1.2, 4);
      ++pulses;
      through += echoes.count > 0 && echoes.echo[static_cast<size_t>(echoes.count - 1)].kind == cls::ground;
    }
    ASSERT_GT(pulses, 3000);
    const double penetration = through / static_cast<double>(pulses);
    EXPECT_GT(penetration, 0.50) << seed;
    EXPECT_LT(penetration, 0.65) << seed;
  }
}

TEST(Structures, CoverTellsWhatBeamsMeet) {
  const World world = zoo_of(2);
  std::map<Cover, int> seen;
  Echoes echoes;
  Random place(10, 10, 10);
  for (int i = 0; i < 30000; ++i) {
    const Vector2d p(place.uniform(-250, 250), place.uniform(-250, 250));
    const Relief::Sample ground = world.relief().at(p.x(), p.y());
    const Cover cover = world.cover_at(p.x(), p.y());
    ++seen[cover];
    EXPECT_EQ(cover == Cover::water, ground.water);
    Random own(5, 5, static_cast<std::uint64_t>(i));
    const Ray ray = ray_to({p.x(), p.y(), ground.height}, 0.0, 0.0);
    world.trace(ray, 3000, 0.0, own, echoes);
    if (echoes.count == 0) continue;
    const std::uint8_t kind = echoes.echo[static_cast<size_t>(echoes.count - 1)].kind;
    EXPECT_EQ(kind == cls::building, cover == Cover::building);
    EXPECT_EQ(kind == cls::bridge_deck, cover == Cover::bridge);
    if (cover == Cover::open) {
      EXPECT_TRUE(kind == cls::ground || kind == 15) << int(kind);
    }
    if (cover == Cover::steep) {
      EXPECT_GT(ground.gradient.norm(), 0.577);
    }
  }
  for (const Cover c : {Cover::open, Cover::forest, Cover::steep, Cover::building, Cover::low_vegetation, Cover::water, Cover::bridge})
    EXPECT_GT(seen[c], 5) << static_cast<int>(c);
}

}  // namespace
}  // namespace swath::simulate
