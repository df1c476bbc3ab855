// SPDX-License-Identifier: GPL-3.0-or-later
// Power lines as files: layers of features, and a sheet per span.
#pragma once

#include <string>
#include <vector>

#include "io/vector/feature_file.h"
#include "report/chart.h"
#include "stages/stage.h"
#include "terrain/corridor/clearance.h"

namespace swath::stages {

/// All that is known of a survey's power lines. Places minus the run's origin, m.
struct PowerLineResult {
  terrain::PowerLines lines;
  std::vector<terrain::ConductorClearances> clearances;  ///< of each conductor
  std::vector<terrain::FallingTree> trees;
};

/// "1.2": the second conductor of the first span.
std::string conductor_name(const terrain::PowerLines& lines, size_t conductor);

/// Layers conductors, spans, pylons, clearances (from wire to the nearest place), infringements and falling_trees.
std::vector<io::SpatialLayer> power_line_layers(const PowerLineResult& result, const Context& context);

/// Profile along the span and plan, with what lies within `beside` metres of its axis. `base`: height of the places' origin, m.
report::Chart span_sheet(const PowerLineResult& result, size_t span, const std::vector<terrain::Obstacle>& obstacles, double beside,
                         double base);

}  // namespace swath::stages
