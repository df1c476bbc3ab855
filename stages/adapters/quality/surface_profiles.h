// SPDX-License-Identifier: GPL-3.0-or-later
// Sections through a terrain model and its reference.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "core/config/result.h"
#include "stages/stage.h"

namespace swath::stages {

/// A line to cut along, m.
struct SectionLine {
  std::string name;
  std::vector<Eigen::Vector2d> vertices;
};

/// Every step along a line; NaN where a model has no height.
struct SurfaceProfile {
  std::string name;
  std::vector<double> along, x, y, model, reference;  ///< m
};

template <class V>
void describe(const SurfaceProfile& r, V& v) {
  v.result("name", r.name, "Name of the line.");
  v.result("along_m", r.along, "Distance from its first point.");
  v.result("model_m", r.model, "Height of the terrain model; null: none.");
  v.result("reference_m", r.reference, "Height of the reference; null: none.");
}

/// The lines of a vector file, brought to the survey's CRS. Throws core::Error: no line, no way from its CRS.
std::vector<SectionLine> section_lines(const Context& context, const std::filesystem::path& file);
/// West to east and south to north across the middle of a box.
std::vector<SectionLine> middle_lines(const Box& box);

/// Heights of both models at points of the map, and the box around them grown by what they need.
using HeightsAt = std::function<std::vector<double>(const std::vector<Eigen::Vector2d>&, const Box&)>;
SurfaceProfile profile_along(const SectionLine& line, double cell, const HeightsAt& model, const HeightsAt& reference);

/// NAME.csv: one row for every place of every profile, in units of the CRS.
void write_profiles(const Context& context, const std::string& name, const std::vector<SurfaceProfile>& profiles);

}  // namespace swath::stages
