// SPDX-License-Identifier: GPL-3.0-or-later
// Options of the ground, of what stands on it and of what a surveyor measured of it.
#pragma once

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>

#include "core/config/option.h"

namespace swath::simulate {

enum class Scene { flat, hills, steep, forest, town, mixed, airfield, zoo };

/// The ground and what stands on it. Options without a value take the scene's own.
struct WorldOptions {
  Scene scene = Scene::mixed;
  core::Metres length{1000.0}, width{400.0};
  core::Metres ground{600.0};
  std::optional<std::filesystem::path> dem{};
  std::optional<double> slope{};
  std::optional<core::Metres> relief{}, scarp{}, embankment{}, ditch{};
  std::optional<double> scarp_slope{};
  std::optional<double> buildings{}, trees{}, woodland{}, foliage{}, low_vegetation{}, crops{};
  core::Metres low_vegetation_height{0.8}, crop_height{1.6}, hall_length{80.0}, hall_width{40.0};
  std::optional<bool> water{}, power_line{}, hall{}, bridge{};
};

/// The scene's numbers with the given options put in.
struct Features {
  double slope = 0, relief = 0, scarp = 0, embankment = 0, ditch = 0, buildings = 0, trees = 0, low_vegetation = 0, crops = 0;
  bool water = false, power_line = false, hall = false, bridge = false;
  double woodland = 0.3;  ///< share of the area under trees
  double built_up = 0.3;  ///< share of the area with buildings
  double foliage = 1.0;
  double scarp_slope = 1.7;
  double embankment_at = -0.3;  ///< where it crosses the area's axis, share of the length from the middle
};
Features features_of(const WorldOptions& w);

/// m: the shortest side of an area that has room for its hall, however that lies.
double least_side_with_hall(const WorldOptions& w);

template <class V>
void describe(WorldOptions& w, V& v) {
  v.option(
      "scene", w.scene,
      "Kind of scene; it fills the options below that are not given. airfield: nearly level ground, one large flat-roofed building in "
      "the middle along the flight lines, gable halls of all directions over the whole area, a few trees at its rim. zoo: everything that "
      "a ground filter can stumble over, in one area.");
  v.option("length", w.length, core::within(50, 1e4), "Length of the area along the flight lines.");
  v.option("width", w.width, core::within(50, 1e4), "Width of the area across the flight lines.");
  v.option("ground", w.ground, core::within(-500, 8000), "Ellipsoidal height of the ground in the middle.");
  v.option("dem", w.dem, "Terrain model in place of the scene's ground: a raster in the survey's CRS.");
  v.option("slope", w.slope, core::within(0, 1), "Slope of the whole area (rise / run), down to grid north-east.");
  v.option("relief", w.relief, core::within(0, 500), "Amplitude of hills.");
  v.option("scarp", w.scarp, core::within(0, 100), "Height of a steep scarp through the area (0: none).");
  v.option("scarp_slope", w.scarp_slope, core::within(0.1, 5), "Slope of the scarp's steepest part (rise / run).");
  v.option("embankment", w.embankment, core::within(0, 50), "Height of an embankment through the area (0: none).");
  v.option("ditch", w.ditch, core::within(0, 50), "Depth of a ditch through the area (0: none).");
  v.option("buildings", w.buildings, core::within(0, 30),
           "Buildings per hectare of built-up ground (airfield: halls per hectare of the area; 0: none).");
  v.option("trees", w.trees, core::within(0, 1000), "Trees per hectare of woodland (airfield: of the area, all at its rim).");
  v.option("woodland", w.woodland, core::within(0, 1), "Share of the area that is woodland.");
  v.option("foliage", w.foliage, core::within(0.05, 5), "Density of the crowns: 1 in leaf, less where more pulses shall come through.");
  v.option("low_vegetation", w.low_vegetation, core::within(0, 1),
           "Share of open ground under low vegetation, a third of whose pulses it stops.");
  v.option("low_vegetation_height", w.low_vegetation_height, core::within(0.1, 2), "Height of the tallest low vegetation (from 0.1 m).");
  v.option("crops", w.crops, core::within(0, 1),
           "Share of open fields under crops, which have one height each and stop 40 to 80 % of the pulses.");
  v.option("crop_height", w.crop_height, core::within(0.1, 2), "Height of the tallest crops (from 0.1 m).");
  v.option("water", w.water, "A lake.");
  v.option("power_line", w.power_line, "A power line.");
  v.option("hall", w.hall, "A flat-roofed hall, 12 m high, in the built-up part (airfield: has its own).");
  v.option("hall_length", w.hall_length, core::within(10, 1000), "Length of the hall, nearly along the flight lines.");
  v.option("hall_width", w.hall_width, core::within(10, 1000), "Width of the hall.");
  v.option("bridge", w.bridge, "A bridge over the ditch (class 17); the ground below it is seen from the sides.");
  v.check(!w.dem || !(w.slope || w.relief || w.scarp || w.embankment || w.ditch || w.water || w.bridge),
          "a terrain model is the whole ground: leave slope, relief, scarp, embankment, ditch, water and bridge out");
  v.check(!w.hall.value_or(false) || std::min(w.length.value, w.width.value) >= least_side_with_hall(w),
          "a hall needs an area whose sides are 10 m longer than the hall's diagonal");
  v.check(!w.bridge.value_or(false) || features_of(w).ditch > 0.0, "a bridge needs a ditch to cross: set `ditch`");
}

/// Ground plan and height of the airfield's flat-roofed building: 80 m by 40 m by 12 m, smaller on a small area.
struct BuildingSize {
  double half_length, half_width, height;  ///< m
};
BuildingSize airfield_building(const WorldOptions& w);

/// Points and targets surveyed on the ground.
struct ControlOptions {
  bool roof = false;
  int targets = 0, points = 0;
  core::Metres sigma{0.02};
  std::array<core::Metres, 3> shift{};
};

template <class V>
void describe(ControlOptions& c, V& v) {
  v.option("roof", c.roof, "Survey the corners of the flat roof in the middle as a target of control.csv (scene airfield).");
  v.option("targets", c.targets, core::within(0, 1000),
           "Further roof facets whose corners are surveyed, spread over the area, targets of control.csv.");
  v.option("points", c.points, core::within(0, 1e5), "Points surveyed on open ground, for comparison alone: check.csv.");
  v.option("sigma", c.sigma, core::above_to(0, 1), "Sigma of each surveyed coordinate; the files state it.");
  v.option("shift", c.shift, core::within(-1e4, 1e4), "East, north, up added to all surveyed coordinates: control in a wrong datum.");
}

}  // namespace swath::simulate

namespace swath::core {
template <>
struct Choices<simulate::Scene> {
  static constexpr std::array<std::string_view, 8> names{"flat", "hills", "steep", "forest", "town", "mixed", "airfield", "zoo"};
};
}  // namespace swath::core
