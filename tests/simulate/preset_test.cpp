// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/preset.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "core/block.h"
#include "core/config/option_visitors.h"
#include "core/error.h"
#include "io/survey/calibration_file.h"
#include "io/survey/read_survey.h"
#include "simulate/simulate.h"
#include "tests/world/npy_columns.h"
#include "tests/world/support.h"

namespace swath::simulate {
namespace {

using Eigen::Vector3d;

TEST(Preset, EveryOneIsAccepted) {
  for (const Scene scene :
       {Scene::flat, Scene::hills, Scene::steep, Scene::forest, Scene::town, Scene::mixed, Scene::airfield, Scene::zoo}) {
    Options o = preset(scene), read;
    EXPECT_EQ(o.world.scene, scene);
    std::vector<core::Fault> faults;
    core::read_options(core::described(read), core::effective_values(core::described(o)), "", faults);
    EXPECT_TRUE(faults.empty());
  }
}

TEST(Preset, WhatAConfigLeavesOutFollowsThePatternOfTheFlight) {
  core::Value given = core::Value::object();
  given["flight"]["height"] = "900 m";
  EXPECT_EQ(read_options(given).noise.range.value, Options{}.noise.range.value);
  given["flight"]["pattern"] = "calibration";
  const Options o = read_options(given);
  EXPECT_EQ(o.flight.height.value, 900.0);
  EXPECT_EQ(o.flight.speed.value, 60.0);
  EXPECT_NEAR(o.flight.upper_height(), 900.0 * 11 / 7, 1e-9);
  EXPECT_EQ(o.world.scene, Scene::airfield);
  EXPECT_EQ(o.mounting.deliver, Deliver::nominal);
  given["flight"]["patern"] = "calibration";
  EXPECT_THROW(read_options(given), core::Error);
}

TEST(Preset, WhatAConfigLeavesOutFollowsTheZoo) {
  core::Value given = core::Value::object();
  given["world"]["scene"] = "zoo";
  given["flight"]["height"] = "400 m";
  Options o = read_options(given);
  EXPECT_EQ(o.world.length.value, 600.0);
  EXPECT_EQ(o.flight.height.value, 400.0);
  EXPECT_GT(o.noise.low_groups, 0.0);
  EXPECT_FALSE(o.imu.file);
  given["flight"]["pattern"] = "calibration";
  o = read_options(given);
  EXPECT_EQ(o.world.scene, Scene::zoo);
  EXPECT_EQ(o.world.length.value, 720.0);
  EXPECT_EQ(o.noise.low_groups, 0.0);
}

/// One row of truth/planes.csv.
struct Plane {
  std::string name, kind;
  Vector3d normal;
  std::vector<Vector3d> corners;
};
std::vector<Plane> planes_of(const std::filesystem::path& file) {
  std::istringstream text(test::read_bytes(file));
  std::vector<Plane> out;
  std::string line, cell;
  std::getline(text, line);
  EXPECT_EQ(line, "name,kind,normal_east,normal_north,normal_up,corners");
  while (std::getline(text, line)) {
    std::istringstream row(line);
    Plane p;
    std::getline(row, p.name, ',');
    std::getline(row, p.kind, ',');
    for (int k = 0; k < 3; ++k) {
      std::getline(row, cell, ',');
      p.normal[k] = std::stod(cell);
    }
    while (std::getline(row, cell, ';')) {
      std::istringstream corner(cell);
      Vector3d c;
      corner >> c.x() >> c.y() >> c.z();
      p.corners.push_back(c);
    }
    out.push_back(p);
  }
  return out;
}

TEST(Preset, ReturnsOfRoofsAndWallsLieOnTheStatedPlanes) {
  const test::TemporaryFolder folder;
  Options o = preset(Scene::airfield);
  o.noise.noise_free = true;
  o.imu.file = o.gnss.file = false;
  run(o, folder.path());
  const std::vector<Plane> planes = planes_of(folder / "truth/planes.csv");
  ASSERT_EQ(planes.size(), 5u + 8u * 6u);
  const auto truth = test::npy_columns(folder / "truth/returns.npy");
  constexpr double on_plane = 2e-6;  // m: eastings and northings to 9 decimals, doubles of northings resolve 1e-9 m, and the map's fit 2e-6
  size_t on_roof = 0, on_wall = 0;
  std::map<double, size_t> roof_by_line;
  for (size_t i = 0; i < truth.at("t").size(); ++i) {
    if (truth.at("cls")[i] != core::point_class::building) continue;
    const Vector3d p(truth.at("e")[i], truth.at("n")[i], truth.at("h")[i]);
    const Plane* nearest = nullptr;
    double least = 1e9;
    for (const Plane& plane : planes) {
      double outside = -1e9;
      for (size_t k = 0; k < plane.corners.size(); ++k) {
        const Vector3d edge = (plane.corners[(k + 1) % plane.corners.size()] - plane.corners[k]).normalized();
        outside = std::max(outside, edge.cross(plane.normal).dot(p - plane.corners[k]));
      }
      const double gap = std::abs(plane.normal.dot(p - plane.corners[0]));
      if (outside < 1e-5 && gap < least) least = gap, nearest = &plane;
    }
    ASSERT_LT(least, on_plane);
    (nearest->kind == "roof" ? on_roof : on_wall)++;
    if (nearest->name == "building roof 1") ++roof_by_line[truth.at("line")[i]];
  }
  EXPECT_GT(on_roof, 2000u);
  EXPECT_GT(on_wall, 50u);
  // The middle roof is seen from every line, those of the swath's edge and those without scan too.
  EXPECT_EQ(roof_by_line.size(), 12u);
  for (const auto& [line, n] : roof_by_line) EXPECT_GT(n, 30u) << line;
}

TEST(Preset, ACalibrationFlightStatesNominalValuesAndItsControl) {
  const test::TemporaryFolder folder;
  const Options o = preset(Scene::airfield);
  run(o, folder.path());
  const io::Survey survey = io::read_survey(folder / "survey.toml");
  EXPECT_EQ(survey.calibration.roll.value, 0.0);
  EXPECT_EQ(survey.calibration.scan_scale, 1.0);
  EXPECT_EQ(survey.calibration.range_offset.value, 0.0);
  EXPECT_NEAR(survey.sigma.roll.value, 0.5 * core::degree / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(survey.sigma.range_offset.value, 0.1, 1e-12);
  EXPECT_NEAR(survey.sigma.scan_scale, 1e-4, 1e-12);
  core::Calibration truth;
  core::SensorSigma sigma;
  io::load_calibration(folder / "truth/calibration.json", truth, sigma);
  EXPECT_NE(truth.roll.value, 0.0);
  EXPECT_LT(std::abs(truth.heading.value), 0.5 * core::degree);
  EXPECT_NE(truth.scan_scale, 1.0);
  ASSERT_EQ(survey.lines.size(), 12u);
  EXPECT_EQ(survey.lines[4].name, "edge right 1");
  ASSERT_EQ(survey.control.size(), 2u);
  EXPECT_EQ(survey.control[0].file, "control.csv");
  EXPECT_EQ(survey.control[0].use, io::ControlUse::control);
  EXPECT_EQ(survey.control[1].use, io::ControlUse::check);
  const std::string control = test::read_bytes(folder / "control.csv"), check = test::read_bytes(folder / "check.csv"),
                    places = test::read_bytes(folder / "truth/control.csv");
  EXPECT_EQ(control.rfind("name,target,x,y,z,sigma_h,sigma_v\nbuilding roof 1 corner 1,building roof 1,", 0), 0u);
  EXPECT_EQ(std::count(control.begin(), control.end(), '\n'), 1 + 4);
  EXPECT_EQ(std::count(check.begin(), check.end(), '\n'), 1 + 20);
  EXPECT_EQ(std::count(places.begin(), places.end(), '\n'), 1 + 24);
  // Records lead to the truth through the drawn calibration, not through the one delivered.
  const auto laser = test::npy_columns(folder / "laser.npy"), returns = test::npy_columns(folder / "truth/returns.npy");
  double sum = 0;
  for (size_t i = 0; i < laser.at("range").size(); ++i)
    if (returns.at("cls")[i] == core::point_class::ground) sum += laser.at("range")[i] + truth.range_offset.value - returns.at("range")[i];
  EXPECT_NEAR(sum / static_cast<double>(laser.at("range").size()), 0.0, 1e-3);
}

TEST(Preset, ACalibrationFlightIsTheSameWhateverTheThreads) {
  Options o = preset(Scene::airfield);
  o.scanner.prf = core::Hertz(1000);
  o.flight.edge_lines = o.flight.profile_lines = false;
  o.control.targets = 5;
  o.noise.line_shift = o.noise.line_drift = core::Metres(0.08);
  const test::TemporaryFolder one, two;
  {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
    run(o, one.path());
  }
  {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 4);
    run(o, two.path());
  }
  for (const char* file : {"laser.npy", "sbet.out", "smrmsg.out", "imu.csv", "gnss.csv", "survey.toml", "control.csv", "check.csv",
                           "truth/control.csv", "truth/planes.csv", "truth/calibration.json", "truth/returns.npy", "truth/sbet.out"})
    EXPECT_EQ(test::read_bytes(one / file), test::read_bytes(two / file)) << file;
}

}  // namespace
}  // namespace swath::simulate
