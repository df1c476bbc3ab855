// SPDX-License-Identifier: GPL-3.0-or-later
// The table of survey.toml.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/config/option.h"

namespace swath::io {

/// What a control file is for.
enum class ControlUse {
  control,  ///< takes part in the adjustment
  check,    ///< is compared with the result only
};

/// Coordinates that are surveyed; others are approximate, to some metres.
enum class ControlKind { xyz, xy, z };

/// One file of surveyed points: delimited text (CSV) with a header, or GeoPackage (points; or polygons with heights, one target each).
struct ControlFile {
  std::filesystem::path file;
  std::string crs;
  ControlUse use = ControlUse::control;
  ControlKind kind = ControlKind::xyz;
  std::string name = "name", target = "target", cover = "cover", x = "x", y = "y", z = "z", sigma_h = "sigma_h", sigma_v = "sigma_v";
  core::Metres sigma_horizontal{0.02}, sigma_vertical{0.02};
};

template <class V>
void describe(ControlFile& f, V& v) {
  v.option("file", f.file, "CSV or GeoPackage, relative to survey.toml.");
  v.option("crs", f.crs, "CRS of its coordinates; empty: that of the survey (GeoPackage: its own).");
  v.option("use", f.use, "control: takes part in the adjustment; check: is compared with its result alone.");
  v.option("kind", f.kind, "Coordinates that are surveyed, others being approximate; files of xy or z serve images alone.");
  v.option("name", f.name, "Column of the points' names; of points on images as the image points have them.");
  v.option("target", f.target, "Column with the plane a point is a corner of, in order around it; empty: a single ground point.");
  v.option("cover", f.cover, "Column with what covers the ground there (open, forest ...), for quality.points.");
  v.option("x", f.x, "Column of eastings.");
  v.option("y", f.y, "Column of northings.");
  v.option("z", f.z, "Column of heights.");
  v.option("sigma_h", f.sigma_h, "Column of sigmas of easting and of northing, m, where the file has it.");
  v.option("sigma_v", f.sigma_v, "Column of sigmas of height, m, where the file has it.");
  v.option("sigma_horizontal", f.sigma_horizontal, core::above(0), "Sigma of easting and of northing, where the file states none.");
  v.option("sigma_vertical", f.sigma_vertical, core::above(0), "Sigma of height, where the file states none.");
}

}  // namespace swath::io

namespace swath::core {
template <>
struct Choices<io::ControlUse> {
  static constexpr std::array<std::string_view, 2> names{"control", "check"};
};
template <>
struct Choices<io::ControlKind> {
  static constexpr std::array<std::string_view, 3> names{"xyz", "xy", "z"};
};
}  // namespace swath::core
