// SPDX-License-Identifier: GPL-3.0-or-later
// Finds the planes that tie flight lines to one another and collects the raw returns on them.
#pragma once

#include <vector>

#include "calib/terms.h"
#include "calib/ties/control.h"
#include "calib/ties/tie_plane_options.h"
#include "calib/ties/tie_set.h"
#include "core/records/sensor.h"
#include "core/report.h"
#include "georef/shot_stream.h"
#include "trajectory/trajectory.h"

namespace swath::calib {

/// Ground, roof facets and walls that two looks or more have seen, plane for each of them, spread over the block; and the surveyed targets
/// (seen once or more). Two passes over the stream; nothing but moments of cells and bounded samples is held. An empty set (no overlap, no
/// planes) has its reason in the tally. Deterministic; independent of batches.
TieSet find_tie_planes(const ShotStream& stream, const core::Scanner& scanner, const core::Calibration& calibration,
                       const trajectory::Trajectory& trajectory, const trajectory::LocalFrame& frame,
                       const std::vector<SurveyedTarget>& targets, const TiePlaneOptions& options, core::Tally& tally);

/// Throws that no plane was found, with what became of those sought; `what_else` was not found either, `hint` ends what helps.
[[noreturn]] void refuse_without_planes(const core::Tally& tally, const std::string& what_else, const std::string& where,
                                        const std::string& hint);

}  // namespace swath::calib
