// SPDX-License-Identifier: GPL-3.0-or-later
// The configuration file of RTKLIB's rnx2rtkp (2.4.2 and 2.4.3).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/config/option.h"

namespace swath::io {

enum class RtklibMode { kinematic, still, code };
enum class RtklibDirection { combined, forward, backward };
enum class RtklibAmbiguities { none, continuous, instantaneous, fix_and_hold };
enum class RtklibIonosphere { none, broadcast, two_frequencies, estimated };
enum class RtklibTroposphere { none, saastamoinen, zenith, zenith_gradient };
enum class RtklibOrbits { automatic, broadcast, precise };
enum class RtklibCoordinates { ecef, geodetic };

struct RtklibOptions {
  RtklibMode mode = RtklibMode::kinematic;
  RtklibDirection direction = RtklibDirection::combined;
  int frequencies = 2;
  std::vector<std::string> systems{"gps", "glonass", "galileo", "qzss", "beidou"};
  std::vector<std::string> exclude;
  core::Radians elevation_mask = core::degrees(10.0);
  RtklibAmbiguities ambiguities = RtklibAmbiguities::continuous;
  bool fix_glonass = false;
  double ratio = 3.0;
  core::Radians ambiguity_elevation_mask = core::degrees(15.0);
  int lock = 0;
  RtklibIonosphere ionosphere = RtklibIonosphere::broadcast;
  RtklibTroposphere troposphere = RtklibTroposphere::saastamoinen;
  RtklibOrbits orbits = RtklibOrbits::automatic;
  bool dynamics = false;
  core::MetresPerSecond2 acceleration_horizontal{10.0}, acceleration_vertical{10.0};
  core::Seconds max_age{30.0};
  bool interpolate_base = true;
  bool keep_single = false;
  RtklibCoordinates coordinates = RtklibCoordinates::ecef;
};

/// Whether every name is one of a GNSS, or of a satellite ("G05", "+G05": used although unhealthy).
bool are_gnss_systems(const std::vector<std::string>& names);
bool are_satellites(const std::vector<std::string>& names);

template <class V>
void describe(RtklibOptions& o, V& v) {
  v.option("mode", o.mode, "kinematic: the rover moves; static: it stands still; dgps: differential code ranges alone.",
           "RTKLIB pos1-posmode");
  v.option("direction", o.direction, "Through the record forward, backward, or both ways combined.", "RTKLIB pos1-soltype");
  v.option("frequencies", o.frequencies, core::within(1, 3), "Frequencies used: 1 L1, 2 L1 and L2, 3 L1, L2 and L5.",
           "RTKLIB pos1-frequency");
  v.option("systems", o.systems, "Satellite systems used: gps, sbas, glonass, galileo, qzss, beidou.", "RTKLIB pos1-navsys");
  v.option("exclude", o.exclude, "Satellites left out, \"G05\"; with a plus: used although they call themselves unhealthy.",
           "RTKLIB pos1-exclsats");
  v.option("elevation_mask", o.elevation_mask, core::within(0, 60 * core::degree),
           "Satellites below are not used. Low, since an aircraft's antenna tilts in turns.", "RTKLIB pos1-elmask");
  v.option("ambiguities", o.ambiguities, "How integer ambiguities are fixed.", "RTKLIB pos2-armode");
  v.option("fix_glonass", o.fix_glonass, "Fix GLONASS ambiguities too: for receivers of one make at both ends.", "RTKLIB pos2-gloarmode");
  v.option("ratio", o.ratio, core::at_least(1), "Ratio of the second best set of integers to the best, from which the best is taken.",
           "RTKLIB pos2-arthres");
  v.option("ambiguity_elevation_mask", o.ambiguity_elevation_mask, core::within(0, 60 * core::degree),
           "Satellites below are not used to fix integers.", "RTKLIB pos2-arelmask");
  v.option("lock", o.lock, core::within(0, 10000), "Epochs that a satellite is tracked before its integer is fixed.",
           "RTKLIB pos2-arlockcnt");
  v.option("ionosphere", o.ionosphere, "broadcast (bases within 20 km), two_frequencies (ionosphere-free) or estimated (long distances).",
           "RTKLIB pos1-ionoopt");
  v.option("troposphere", o.troposphere, "Standard atmosphere, or estimated zenith delays (long distances, large height differences).",
           "RTKLIB pos1-tropopt");
  v.option("orbits", o.orbits, "Orbits and clocks of the satellites; automatic: precise where the survey names SP3 files.",
           "RTKLIB pos1-sateph");
  v.option("dynamics", o.dynamics, "Predict position, velocity and acceleration between epochs; off for an INS/GNSS smoother's fixes.",
           "RTKLIB pos1-dynamics");
  v.option("acceleration_horizontal", o.acceleration_horizontal, core::above(0),
           "Random walk of the acceleration in 1 s, with dynamics: horizontal.", "RTKLIB stats-prnaccelh");
  v.option("acceleration_vertical", o.acceleration_vertical, core::above(0), "The same, vertical.", "RTKLIB stats-prnaccelv");
  v.option("max_age", o.max_age, core::above(0), "Oldest observation of the base that is used for an epoch of the rover.",
           "RTKLIB pos2-maxage");
  v.option("interpolate_base", o.interpolate_base, "Interpolate a base that records less often than the rover.", "RTKLIB misc-timeinterp");
  v.option("keep_single", o.keep_single, "Take the rover's own solution (metres) where no differential one exists; otherwise no fix.",
           "RTKLIB out-outsingle");
  v.option("coordinates", o.coordinates, "Form of the positions in the .pos files; both with their full covariance.",
           "RTKLIB out-solformat");
  v.check(are_gnss_systems(o.systems) && !o.systems.empty(), "systems are one or more of gps, sbas, glonass, galileo, qzss, beidou");
  v.check(are_satellites(o.exclude), "satellites are written as \"G05\": system (G, R, E, C, J, I, S) and two or three digits");
}

/// One end of a baseline.
struct RtklibAntenna {
  std::string type;                                  ///< as in the antenna file; empty: no phase centre is applied
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< east, north, up from the point whose position counts, m
};

/// What a configuration says of the survey.
struct RtklibSetup {
  std::optional<Eigen::Vector3d> base;  ///< ecef, m; none: the rover alone, by code (mode and keep_single do not count)
  RtklibAntenna rover_antenna, base_antenna;
  std::string antenna_file;  ///< name as the program finds it; empty: none
  bool precise_orbits = false;
};

/// The text of the configuration file. What it does not name stays as RTKLIB has it. Positions come out as ECEF, or as latitude, longitude
/// and ellipsoidal height, with GPS week and seconds of week to 1 us.
std::string rtklib_config(const RtklibOptions& options, const RtklibSetup& setup);

}  // namespace swath::io

namespace swath::core {
template <>
struct Choices<io::RtklibMode> {
  static constexpr std::array<std::string_view, 3> names{"kinematic", "static", "dgps"};
};
template <>
struct Choices<io::RtklibDirection> {
  static constexpr std::array<std::string_view, 3> names{"combined", "forward", "backward"};
};
template <>
struct Choices<io::RtklibAmbiguities> {
  static constexpr std::array<std::string_view, 4> names{"none", "continuous", "instantaneous", "fix_and_hold"};
};
template <>
struct Choices<io::RtklibIonosphere> {
  static constexpr std::array<std::string_view, 4> names{"none", "broadcast", "two_frequencies", "estimated"};
};
template <>
struct Choices<io::RtklibTroposphere> {
  static constexpr std::array<std::string_view, 4> names{"none", "saastamoinen", "zenith", "zenith_gradient"};
};
template <>
struct Choices<io::RtklibOrbits> {
  static constexpr std::array<std::string_view, 3> names{"automatic", "broadcast", "precise"};
};
template <>
struct Choices<io::RtklibCoordinates> {
  static constexpr std::array<std::string_view, 2> names{"ecef", "geodetic"};
};
}  // namespace swath::core
