// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/options.h"

#include <gtest/gtest.h>

#include "core/config/option_visitors.h"

namespace swath::simulate {
namespace {

std::vector<core::Fault> faults_of(Options o) {
  std::vector<core::Fault> faults;
  Options read;
  core::read_options(core::described(read), core::effective_values(core::described(o)), "", faults);
  return faults;
}

TEST(SimulateOptions, DefaultsPassTheirOwnChecks) { EXPECT_TRUE(faults_of(Options{}).empty()); }

TEST(SimulateOptions, GivenFeaturesReplaceTheScenes) {
  WorldOptions w;
  w.scene = Scene::flat;
  EXPECT_EQ(features_of(w).buildings, 0.0);
  w.buildings = 3.0;
  w.scarp = core::Metres(7.0);
  w.water = true;
  const Features f = features_of(w);
  EXPECT_EQ(f.buildings, 3.0);
  EXPECT_EQ(f.scarp, 7.0);
  EXPECT_TRUE(f.water);
  EXPECT_TRUE(features_of({.scene = Scene::mixed}).power_line);
}

TEST(SimulateOptions, ABridgeNeedsADitchAndAHallNeedsRoom) {
  Options o;
  o.world.bridge = true;
  EXPECT_EQ(faults_of(o).size(), 1u);
  o.world.ditch = core::Metres(4);
  EXPECT_TRUE(faults_of(o).empty());
  o.world.hall = true;
  EXPECT_TRUE(faults_of(o).empty());
  o.world.width = core::Metres(90);
  EXPECT_EQ(faults_of(o).size(), 1u);
  o.world.width = core::Metres(250);
  EXPECT_TRUE(faults_of(o).empty());
  o.world.hall_length = core::Metres(240);
  EXPECT_EQ(faults_of(o).size(), 1u);
  // What the scene alone would have, it goes without.
  WorldOptions zoo{.scene = Scene::zoo};
  EXPECT_TRUE(features_of(zoo).hall);
  EXPECT_TRUE(features_of(zoo).bridge);
  zoo.width = core::Metres(90);
  zoo.ditch = core::Metres(0);
  EXPECT_FALSE(features_of(zoo).hall);
  EXPECT_FALSE(features_of(zoo).bridge);
}

TEST(SimulateOptions, RefusesWhatCannotBeMade) {
  Options o;
  o.scanner.pattern = Pattern::palmer;
  o.output.formats = {Format::npy, Format::laz};
  EXPECT_EQ(faults_of(o).size(), 1u);
  o = {};
  o.output.time = core::TimeScale::unstated;
  EXPECT_EQ(faults_of(o).size(), 1u);
  o = {};
  o.output.formats.clear();
  EXPECT_EQ(faults_of(o).size(), 1u);
  o = {};
  o.flight.wind = core::MetresPerSecond(39);
  o.flight.speed = core::MetresPerSecond(40);
  EXPECT_EQ(faults_of(o).size(), 1u);
  o = {};
  o.scanner.max_returns = 5;
  EXPECT_EQ(faults_of(o).size(), 1u);
}

TEST(SimulateOptions, RefusesNavigationThatCannotBeMade) {
  const auto faults = [](auto change) {
    Options o;
    change(o);
    return faults_of(o).size();
  };
  EXPECT_EQ(faults([](Options& o) { o.imu.spec.grade = core::ImuGrade::unstated; }), 1u);
  EXPECT_EQ(faults([](Options& o) { o.imu.rate.value = 20.0; }), 1u);
  EXPECT_EQ(faults([](Options& o) { o.imu.kind = io::ImuKind::unstated; }), 1u);
  EXPECT_EQ(faults([](Options& o) { o.imu.axes = {"x", "y", "-z"}; }), 1u);
  EXPECT_EQ(faults([](Options& o) { o.gnss.correlated_share = 1.5; }), 1u);
  EXPECT_EQ(faults([](Options& o) { o.events.clock.poll = 7; }), 1u);
  EXPECT_EQ(faults([](Options& o) { o.flight.along.resize(1); }), 2u);  // without a file, and with laser
  const auto without_trajectory = [](Options& o) {
    o.output.trajectory = TrajectoryOutput::none;
    o.gnss.file = false;
  };
  EXPECT_EQ(faults(without_trajectory), 1u);
}

TEST(SimulateOptions, RefusesCalibrationFlightsThatCannotBeFlown) {
  Options o;
  o.flight.pattern = FlightPattern::calibration;
  EXPECT_TRUE(faults_of(o).empty());
  o.scanner.pattern = Pattern::polygon;  // cannot stand still
  EXPECT_EQ(faults_of(o).size(), 1u);
  o.flight.profile_lines = false;
  EXPECT_TRUE(faults_of(o).empty());
  o.flight.second_height = core::Metres(5);
  EXPECT_EQ(faults_of(o).size(), 1u);
}

TEST(SimulateOptions, AxesAreRotations) {
  EXPECT_TRUE(is_axes_rotation({"x", "y", "z"}));
  EXPECT_TRUE(is_axes_rotation({"y", "x", "-z"}));
  EXPECT_TRUE(is_axes_rotation({"y", "z", "x"}));
  EXPECT_TRUE(is_axes_rotation({"-x", "-y", "z"}));
  EXPECT_FALSE(is_axes_rotation({"y", "x", "z"}));  // left-handed
  EXPECT_FALSE(is_axes_rotation({"x", "x", "z"}));
  EXPECT_FALSE(is_axes_rotation({"x", "+y", "z"}));
  EXPECT_FALSE(is_axes_rotation({"x", "", "z"}));
}

TEST(SimulateOptions, PatternsHaveTheirModels) {
  EXPECT_EQ(model_of(Pattern::sine), core::ScannerModel::mirror);
  EXPECT_EQ(model_of(Pattern::palmer), core::ScannerModel::palmer);
  EXPECT_EQ(model_of(Pattern::beam), core::ScannerModel::beam);
}

}  // namespace
}  // namespace swath::simulate
