// SPDX-License-Identifier: GPL-3.0-or-later
// Baselines from base stations to an aircraft, each solved by a run of RTKLIB's rnx2rtkp.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "core/records/gnss_data.h"
#include "core/report.h"
#include "io/gnss/base_stations.h"
#include "io/gnss/rtklib_run.h"
#include "io/survey/survey.h"

namespace swath::io {

/// What the job of every base shares: navigation, orbits, the rover's antenna. The job has its options.
void share_files(const Survey& survey, const Receiver& rover, RtklibJob& job, core::Tally& tally);

/// The rover's place (ecef, m) by its header, or else by its own first fix; `from` says which.
Eigen::Vector3d approximate_place(const Receiver& rover, const RtklibJob& job, std::string& from);

/// How far a base lies from its position by its own code ranges, m: a slip of the pen is found before hours are computed with it. Nothing
/// where it has no solution; throws core::Error beyond `tolerance` (m).
std::optional<double> distance_by_code(const Base& base, const RtklibJob& shared, double tolerance, core::Tally& tally);

/// The rover's fixes from one base; those that an earlier run has left in the job's folder are taken as they are.
core::GnssData solve(const Base& base, const RtklibJob& shared, core::Tally& tally);

}  // namespace swath::io
