// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/gnss/rtklib_config.h"

#include <gtest/gtest.h>

#include <map>
#include <sstream>

#include "core/config/option_visitors.h"
#include "core/error.h"

namespace swath::io {
namespace {

/// RTKLIB's reading of a configuration: the last of several lines counts.
std::map<std::string, std::string> values(const std::string& text) {
  std::map<std::string, std::string> out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    const size_t at = line.find('=');
    EXPECT_NE(at, std::string::npos) << line;
    EXPECT_TRUE(out.emplace(line.substr(0, at), line.substr(at + 1)).second) << "twice: " << line;
    EXPECT_FALSE(line.ends_with(' ')) << line;
  }
  return out;
}

RtklibSetup baseline() {
  RtklibSetup s;
  s.base = Eigen::Vector3d(-3978241.958, 3382840.234, 3649900.853);
  return s;
}

TEST(RtklibConfig, DefaultsAreThoseOfAnAircraft) {
  auto v = values(rtklib_config({}, baseline()));
  EXPECT_EQ(v["pos1-posmode"], "kinematic");
  EXPECT_EQ(v["pos1-soltype"], "combined");
  EXPECT_EQ(v["pos1-frequency"], "l1+2");
  EXPECT_EQ(v["pos1-elmask"], "10");
  EXPECT_EQ(v["pos1-dynamics"], "off");
  EXPECT_EQ(v["pos1-ionoopt"], "brdc");
  EXPECT_EQ(v["pos1-tropopt"], "saas");
  EXPECT_EQ(v["pos1-navsys"], "61") << "all but SBAS";
  EXPECT_EQ(v["pos2-armode"], "continuous");
  EXPECT_EQ(v["pos2-arthres"], "3");
  EXPECT_EQ(v["ant2-postype"], "xyz");
  EXPECT_EQ(v["ant2-pos1"], "-3978241.958");
  EXPECT_EQ(v["ant2-pos3"], "3649900.853");
  EXPECT_EQ(v["out-solformat"], "xyz");
  EXPECT_EQ(v["out-timesys"], "gpst");
  EXPECT_EQ(v["out-timeform"], "tow");
  EXPECT_EQ(v["out-timendec"], "6");
  EXPECT_EQ(v["out-height"], "ellipsoidal");
  EXPECT_EQ(v["out-outsingle"], "off");
  EXPECT_FALSE(v.contains("file-rcvantfile"));
}

/// Every option changes the text: none does nothing.
TEST(RtklibConfig, EveryOptionReachesTheFile) {
  const std::map<std::string, core::Value> other = {
      {"mode", "static"},
      {"direction", "forward"},
      {"frequencies", 1},
      {"elevation_mask", "12 deg"},
      {"ambiguities", "fix_and_hold"},
      {"fix_glonass", true},
      {"ratio", 2.5},
      {"ambiguity_elevation_mask", "20 deg"},
      {"lock", 10},
      {"ionosphere", "estimated"},
      {"troposphere", "zenith"},
      {"dynamics", true},
      {"acceleration_horizontal", "5 m/s2"},
      {"acceleration_vertical", "2 m/s2"},
      {"max_age", "10 s"},
      {"interpolate_base", false},
      {"keep_single", true},
      {"coordinates", "geodetic"},
  };
  const std::string plain = rtklib_config({}, baseline());
  RtklibOptions o;
  const core::Describe describe_them = [&](core::Visitor& v) { describe(o, v); };
  for (const auto& option : core::document_options(describe_them)) {
    if (option.path == "systems" || option.path == "exclude" || option.path == "orbits") continue;
    ASSERT_TRUE(other.contains(option.path)) << option.path;
    o = {};
    core::Value given = core::effective_values(describe_them);
    given[option.path] = other.at(option.path);
    std::vector<core::Fault> faults;
    core::read_options(describe_them, given, "", faults);
    ASSERT_TRUE(faults.empty()) << faults.front().text();
    EXPECT_NE(rtklib_config(o, baseline()), plain) << option.path;
  }
  o = {};
  o.systems = {"gps", "galileo"};
  o.exclude = {"G05", "+E11"};
  auto v = values(rtklib_config(o, baseline()));
  EXPECT_EQ(v["pos1-navsys"], "9");
  EXPECT_EQ(v["pos1-exclsats"], "G05 +E11");
}

TEST(RtklibConfig, AntennasAndPreciseOrbits) {
  RtklibSetup s = baseline();
  s.rover_antenna = {"AERAT2775_42    NONE", {0, 0, 0}};
  s.base_antenna = {"TRM29659.00", {0.001, -0.002, 1.532}};
  s.antenna_file = "antennas.atx";
  auto v = values(rtklib_config({}, s));
  EXPECT_EQ(v["ant1-anttype"], "AERAT2775_42    NONE");
  EXPECT_EQ(v["ant2-anttype"], "TRM29659.00");
  EXPECT_EQ(v["ant2-antdele"], "0.001");
  EXPECT_EQ(v["ant2-antdeln"], "-0.002");
  EXPECT_EQ(v["ant2-antdelu"], "1.532");
  EXPECT_EQ(v["file-rcvantfile"], "antennas.atx");
  EXPECT_EQ(v["pos1-posopt1"], "off") << "broadcast orbits are of the phase centres";
  EXPECT_EQ(v["pos1-posopt2"], "on");
  s.precise_orbits = true;
  v = values(rtklib_config({}, s));
  EXPECT_EQ(v["pos1-sateph"], "precise");
  EXPECT_EQ(v["pos1-posopt1"], "on");
  s.base_antenna.type = "ODD#1";
  EXPECT_THROW(rtklib_config({}, s), core::Error);
}

TEST(RtklibConfig, WithoutABaseTheRoverStandsAlone) {
  auto v = values(rtklib_config({}, {}));
  EXPECT_EQ(v["pos1-posmode"], "single");
  EXPECT_EQ(v["out-outsingle"], "on");
  EXPECT_FALSE(v.contains("ant2-postype"));
}

TEST(RtklibConfig, NamesOfSystemsAndSatellites) {
  EXPECT_TRUE(are_gnss_systems({"gps", "beidou"}));
  EXPECT_FALSE(are_gnss_systems({"gps", "GPS"}));
  EXPECT_TRUE(are_satellites({"G05", "+R11", "S133"}));
  for (const char* bad : {"", "G", "5", "X05", "G5x", "+", "G1234"}) EXPECT_FALSE(are_satellites({bad})) << bad;
}

}  // namespace
}  // namespace swath::io
