// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/plan_options.h"

#include <gtest/gtest.h>

#include "core/config/option_visitors.h"
#include "io/text/value_file.h"

namespace swath::planning {
namespace {

std::string faults_of(const std::string& toml) {
  PlanOptions o;
  std::vector<core::Fault> faults;
  core::read_options(core::described(o), io::parse_toml(toml, "plan.toml"), "", faults);
  std::string out;
  for (const core::Fault& f : faults) out += f.text() + "\n";
  return out;
}

const std::string corners =
    "corner = [{east = \"0 m\", north = \"0 m\"}, {east = \"900 m\", north = \"0 m\"}, {east = \"900 m\", north = \"900 m\"}]\n";
const std::string sensor = "[sensor]\nprf = \"100 kHz\"\nfrequency = \"50 Hz\"\nhalf_angle = \"20 deg\"\npulse_energy = \"20 uJ\"\n";

TEST(PlanOptions, WhatMustBeGivenIsNamed) {
  EXPECT_EQ(faults_of(corners + sensor + "[flight]\nheight = \"600 m\"\nspeed = \"60 m/s\"\n"), "");
  EXPECT_NE(faults_of(sensor + "[flight]\nheight = \"600 m\"\nspeed = \"60 m/s\"\n").find("area must be given"), std::string::npos);
  EXPECT_NE(faults_of(corners + sensor + "[flight]\nheight = \"600 m\"\n").find("ground speed must be given"), std::string::npos);
  EXPECT_NE(faults_of(corners + sensor + "[flight]\nheight = \"600 m\"\ndensity = 4\nspeed = \"60 m/s\"\n").find("not both"),
            std::string::npos);
  EXPECT_NE(faults_of(corners + "[flight]\nheight = \"600 m\"\nspeed = \"60 m/s\"\n").find("pulse rate must be given"), std::string::npos);
}

TEST(PlanOptions, AnEnergyHasItsUnit) {
  EXPECT_NE(faults_of(corners + "[sensor]\nprf = \"100 kHz\"\nfrequency = \"50 Hz\"\nhalf_angle = \"20 deg\"\npulse_energy = 20\n" +
                      "[flight]\nheight = \"600 m\"\nspeed = \"60 m/s\"\n")
                .find("uJ, mJ, J"),
            std::string::npos);
}

}  // namespace
}  // namespace swath::planning
