// SPDX-License-Identifier: GPL-3.0-or-later
// Which planes say most of the trajectory: a bounded number of each line and second.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "calib/ties/facets.h"
#include "calib/ties/local_points.h"
#include "core/report.h"

namespace swath::calib {

struct ChoiceOptions {
  std::optional<double> per_second;  ///< planes of one line in one second of flight; without it all are taken
  int returns = 100;                 ///< of one line on one plane that are used
};

/// Place of the scanner at a recorded time, local frame, m; nothing where the trajectory has none.
using ScannerAt = std::function<std::optional<Eigen::Vector3d>(double recorded)>;
ScannerAt scanner_of(LocalPoints& points);  ///< which must outlive it

/// Takes the facet that adds most to what is known of the pose of its lines (log of the determinant of position and attitude, second by
/// second), then the next beside those taken, until each second of each line has its number or no facet is left. A second without slopes
/// has level facets in every part of the swath; where there are slopes they come first. The order of `facets` stays. Deterministic.
std::vector<Facet> choose_facets(std::vector<Facet> facets, const ScannerAt& scanner_at, const ChoiceOptions& options, core::Tally& tally);

}  // namespace swath::calib
