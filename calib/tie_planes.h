// SPDX-License-Identifier: GPL-3.0-or-later
// Finds the planes that tie flight lines to one another and collects the raw returns on them.
#pragma once

#include <optional>
#include <vector>

#include "calib/control.h"
#include "calib/shot_stream.h"
#include "calib/tie_set.h"
#include "core/option.h"
#include "core/report.h"
#include "core/sensor.h"
#include "trajectory/trajectory.h"

namespace swath::calib {

struct TiePlaneOptions {
  std::optional<core::Metres> cell;
  core::Metres piece{12.0}, extent{1.5}, roughness{0.08}, margin{0.4}, mismatch{0.05}, target_search{5.0};
  int planes = 1200, returns = 100, fewest = 12;
};

template <class V>
void describe(TiePlaneOptions& o, V& v) {
  v.option("cell", o.cell, core::above(0.0), "Side of the cubes that are judged plane or not; without it ten returns of a line wide.");
  v.option("piece", o.piece, core::above(0.0), "Largest side of a plane; larger ones are cut into pieces.");
  v.option("extent", o.extent, core::above(0.0), "Least half extent of a plane in both directions.");
  v.option("roughness", o.roughness, core::above(0.0), "Largest rms of one line's returns about their plane.");
  v.option("margin", o.margin, core::at_least(0.0),
           "Returns nearer than this to an edge are left out, for the footprint may hang over it.");
  v.option("mismatch", o.mismatch, core::at_least(0.0), "Rms by which lines miss one another at present.");
  v.option("target_search", o.target_search, core::above(0.0), "Distance from its survey within which a target's plane is looked for.");
  v.option("planes", o.planes, core::within(1, 100000), "Most planes, surveyed targets not counted.");
  v.option("returns", o.returns, core::within(10, 10000), "Most returns of one line on one plane.");
  v.option("fewest", o.fewest, core::within(4, 10000), "Fewest returns of one line on one plane.");
  v.check(o.returns >= o.fewest, "returns must be fewest or more");
  v.check(o.piece.value > 2.0 * o.extent.value, "piece must be wider than twice extent");
}

/// Ground, roof facets and walls that two looks or more have seen, plane for each of them, spread over the block; and the surveyed targets
/// (seen once or more). Two passes over the stream; nothing but moments of cells and bounded samples is held. An empty set (no overlap, no
/// planes) has its reason in the tally. Deterministic; independent of batches.
TieSet find_tie_planes(const ShotStream& stream, const core::Scanner& scanner, const core::Calibration& calibration,
                       const trajectory::Trajectory& trajectory, const trajectory::LocalFrame& frame,
                       const std::vector<SurveyedTarget>& targets, const TiePlaneOptions& options, core::Tally& tally);

}  // namespace swath::calib
