// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/options.h"

#include <gtest/gtest.h>

#include "core/option_visitors.h"

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

TEST(SimulateOptions, PatternsHaveTheirModels) {
  EXPECT_EQ(model_of(Pattern::sine), core::ScannerModel::mirror);
  EXPECT_EQ(model_of(Pattern::palmer), core::ScannerModel::palmer);
  EXPECT_EQ(model_of(Pattern::beam), core::ScannerModel::beam);
}

}  // namespace
}  // namespace swath::simulate
