// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/records/gnss_data.h"
#include "core/report.h"
#include "io/survey/navigation.h"

namespace swath::io {

/// How a solution file of RTKLIB is written, as its header says.
struct PosHeader {
  enum class Place { geodetic, ecef, baseline };
  enum class Scale { gpst, utc, jst };
  Place place = Place::geodetic;
  Scale scale = Scale::gpst;
  bool degrees_minutes = false;  ///< latitude and longitude in degrees, minutes, seconds
  bool stated = false;           ///< there is a line that names the columns
  bool above_geoid = false;      ///< heights are not ellipsoidal
  std::string datum = "WGS84";
  std::vector<std::string> columns;     ///< after the coordinates, without units: "Q", "ns", "sdn" ...
  std::optional<Eigen::Vector3d> base;  ///< ecef of the reference station, m
};

/// True where the file starts like a solution of RTKLIB: its comment lines name GPST, UTC or JST and coordinates.
bool looks_like_pos(const std::filesystem::path& file);

/// The header of a solution file; without one that of RTKLIB's standard form (GPST, latitude, longitude in degrees, ellipsoidal height).
PosHeader read_pos_header(const std::filesystem::path& file);

/// Reads a solution file of RTKLIB: latitude/longitude/height (degrees, or degrees, minutes, seconds), ECEF, or baselines east/north/up;
/// time as date or as week and seconds, in GPST, UTC or JST; fields parted by blanks, tabs, commas or semicolons; sd's with signed square
/// roots of covariances; velocities where they are there. Solutions without one (Q 0) and lines that are no solution are left out and
/// counted. Throws Error: heights above the geoid, a datum other than WGS84, baselines without their base, over 5 % of the lines no
/// solution, and what FixList throws.
core::GnssData read_pos(const std::filesystem::path& path, const GnssFile& file, double latency, core::Tally& tally);

}  // namespace swath::io
