// SPDX-License-Identifier: GPL-3.0-or-later
// `swath profile`: sections through a point cloud and a terrain model along lines.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "core/config/result.h"
#include "core/geo/crs.h"

namespace swath::pipeline {

/// A line to cut along, in units of the data's CRS.
struct ProfileLine {
  std::string name;
  std::vector<Eigen::Vector2d> vertices;
  std::size_t left_out = 0;  ///< vertices that were not finite or beyond every map
};

struct ProfileRequest {
  std::filesystem::path dtm;                  ///< raster, or empty
  std::vector<std::filesystem::path> points;  ///< LAS or LAZ files and folders of them
  std::filesystem::path lines;                ///< GeoPackage, GeoJSON, DXF ..., or text with the columns profile, x, y
  std::string from, to;                       ///< "x,y" of one straight line in place of a file
  double half_width = 1.0;                    ///< m
  std::filesystem::path folder;               ///< of the results
};

/// What was found along one line.
struct ProfileFound {
  std::string name;
  double length = 0.0;
  std::size_t vertices_left_out = 0, points = 0, terrain_samples = 0;
  std::string warning{};
};

template <class V>
void describe(const ProfileFound& f, V& v) {
  v.result("name", f.name, "Name of the line and of its files.");
  v.result("length", f.length, "Its length, in units of the data's CRS.");
  v.result("vertices_left_out", f.vertices_left_out, core::if_any(), "Vertices that are not finite or beyond every map.");
  v.result("points", f.points, "Points within the half width.");
  v.result("terrain_samples", f.terrain_samples, "Places where the terrain model has a height.");
  v.result("warning", f.warning, core::plain().only_if(!f.warning.empty()), "What is wrong with the section.");
}

/// The lines that a request names, those of a file as profile_1, profile_2 ... where they bear no name. Those of a vector file that states
/// a CRS are brought to `crs`, that of the data. Throws core::Error.
std::vector<ProfileLine> profile_lines(const ProfileRequest& request, const core::Crs& crs = {});

/// For each line FOLDER/NAME.csv, NAME.svg and NAME.png: every usable point within the half width by its class, and the terrain model every
/// half cell with its sigma. Reports what it found on each. Throws core::Error; a line that meets neither points nor terrain is one.
std::vector<ProfileFound> write_profiles(const ProfileRequest& request);

}  // namespace swath::pipeline
