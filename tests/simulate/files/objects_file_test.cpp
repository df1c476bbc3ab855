// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/files/objects_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "tests/world/support.h"

namespace swath::simulate {
namespace {

std::vector<std::vector<double>> rows_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line, cell;
  std::getline(in, line);
  std::vector<std::vector<double>> out;
  while (std::getline(in, line)) {
    out.emplace_back();
    std::stringstream cells(line);
    while (std::getline(cells, cell, ',')) out.back().push_back(std::stod(cell));
  }
  return out;
}

MapPatch map_of() { return MapPatch(core::Crs("EPSG:32632"), {48 * core::degree, 10.5 * core::degree, 600.0}, 700.0, 400.0, 900.0); }

TEST(ObjectsFile, WiresAreTheirCatenaries) {
  const test::TemporaryFolder folder;
  WorldOptions w;
  w.scene = Scene::flat;
  w.power_line = true;
  w.trees = 60;
  const World world(w, 3, core::degrees(60), 700);
  write_objects(folder.path(), world, map_of());
  const auto wires = rows_of(folder / "wires.csv"), pylons = rows_of(folder / "pylons.csv"), trees = rows_of(folder / "trees.csv");
  ASSERT_EQ(wires.size(), world.wires().size());
  ASSERT_GT(wires.size(), 0u);
  for (const auto& r : wires) {
    const double length = std::hypot(r[3] - r[0], r[4] - r[1]), a = r[6], s0 = r[7], z0 = r[8];
    constexpr double rounding = 2e-3;  // m: z0 to 0.1 mm, s0 to 1 um times the slope
    EXPECT_NEAR(z0 + a * (std::cosh(s0 / a) - 1.0), r[2], rounding);
    EXPECT_NEAR(z0 + a * (std::cosh((length - s0) / a) - 1.0), r[5], rounding);
    EXPECT_NEAR(r[9], length * length / (8 * a), 0.02 * r[9]);  // the parabola's
  }
  EXPECT_EQ(trees.size(), world.trees().size());
  EXPECT_GE(pylons.size(), 2u);
}

TEST(ObjectsFile, WhatIsNotThereHasNoFile) {
  const test::TemporaryFolder folder;
  WorldOptions w;
  w.scene = Scene::flat;
  w.trees = 0.0;
  write_objects(folder.path(), World(w, 3, core::degrees(60), 700), map_of());
  EXPECT_EQ(test::entries(folder.path()), 0u);
}

}  // namespace
}  // namespace swath::simulate
