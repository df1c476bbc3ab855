// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/vector/control.h"
#include "simulate/options.h"
#include "simulate/world/facets.h"

namespace swath::simulate {

/// A surveyed point and its true place. Coordinates as World.
struct SurveyedPoint {
  std::string name, target;         ///< target: the facet it is a corner of; empty: a point on the ground
  Eigen::Vector3d truth, surveyed;  ///< surveyed: with its drawn errors and the options' shift
};

/// Targets (corners in their order around the facet), then ground points: on open ground all over the area, away from buildings, trees
/// and water. The same seed gives the same roof whatever else is surveyed. Throws Error (usage) where there are fewer facets than asked.
std::vector<SurveyedPoint> survey_points(const Options& options, const World& world, const std::vector<Facet>& facets);

/// Writes control.csv (targets), check.csv (ground points), both with their sigmas, and truth/control.csv (all, exact); a file without
/// points is left out. Returns what survey.toml says of them.
std::vector<io::ControlFile> write_control(const std::filesystem::path& folder, const std::vector<SurveyedPoint>& points,
                                           const ControlOptions& options, const MapPatch& map);

}  // namespace swath::simulate
