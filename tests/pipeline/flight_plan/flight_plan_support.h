// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <filesystem>
#include <string>

#include "io/raster/geotiff.h"
#include "pipeline/flight_plan/plan_input.h"
#include "tests/world/support.h"

namespace swath::pipeline {

/// A plan over 2 km by 1 km; `ground`: the keys that say what lies below.
inline std::string plan_toml(const std::string& ground, const std::string& flight = "height = \"600 m\"") {
  return ground + R"(
corner = [
  {east = "601000 m", north = "5301000 m"}, {east = "603000 m", north = "5301000 m"},
  {east = "603000 m", north = "5302000 m"}, {east = "601000 m", north = "5302000 m"}]
[sensor]
prf = "100 kHz"
frequency = "50 Hz"
half_angle = "20 deg"
pulse_energy = "2 uJ"
[flight]
speed = "60 m/s"
)" + flight +
         "\n";
}

/// 4 km by 3 km of waves around that area, cells of 20 m.
inline void write_hills(const std::filesystem::path& file, const std::string& crs = "EPSG:32632") {
  core::Grid g({20.0, 30000, 265000, 200, 150});
  for (int j = 0; j < 150; ++j)
    for (int i = 0; i < 200; ++i) {
      g.height[g.lattice.at(i, j)] = static_cast<float>(500 + 40 * std::sin(0.1 * i) + 30 * std::cos(0.13 * j));
      g.reason[g.lattice.at(i, j)] = core::Void::none;
    }
  io::write_grid(file, g, crs);
}

/// A request for a plan whose text is given, in a folder.
inline PlanRequest request_of(const test::TemporaryFolder& folder, const std::string& toml) {
  test::write_bytes(folder / "plan.toml", toml);
  return {folder / "plan.toml", {}, folder / "out", {}};
}

}  // namespace swath::pipeline
