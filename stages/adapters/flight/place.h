// SPDX-License-Identifier: GPL-3.0-or-later
// Where a run lies on the map.
#pragma once

#include <Eigen/Core>

#include "stages/stage.h"

namespace swath::stages {

/// The origin of every Block of a run, so that coordinates keep their last bits: a position of the survey, in units of the CRS, rounded to
/// whole kilometres; height 0.
Eigen::Vector3d origin_near(const Context& context, const Eigen::Vector3d& position);

/// Throws core::Error where the median of the GNSS fixes lies far outside the CRS's area of use, before anything is computed from the
/// fixes.
void check_place_of_fixes(const Context& context, const core::GnssData& fixes);

/// For every trajectory that is given: sets context.origin by its first record, and context.area. A survey beside the CRS's area
/// of use is reported; one far outside is refused (scale and convergence would be absurd): core::Error. A run without a map (no projected
/// CRS) is left as it is.
void place_on_map(Context& context, const trajectory::Trajectory& trajectory, core::Tally& tally);

}  // namespace swath::stages
