// SPDX-License-Identifier: GPL-3.0-or-later
// `swath plan`: plan.toml, its area and its terrain model.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/config/value.h"
#include "core/geo/crs.h"
#include "core/height_field.h"
#include "planning/layout.h"
#include "planning/plan_options.h"

namespace swath::pipeline {

struct PlanRequest {
  std::filesystem::path config;   ///< plan.toml or .json
  std::filesystem::path dem;      ///< in place of the config's; may be empty
  std::filesystem::path folder;   ///< of the results
  std::vector<std::string> sets;  ///< options set from outside: flight.speed="60 m/s"
};

/// What a flight is planned from; every path is as the program can open it.
struct PlanInput {
  planning::PlanOptions options;  ///< `crs` is resolved
  core::Value simulation;         ///< table [simulate] of the config: options of `swath simulate` beside the plan's own
  core::Crs crs;
  std::vector<planning::Ring> area;  ///< map metres
  core::HeightField ground;
  double mean_ground = 0.0;  ///< m, over the area
};

/// Throws core::Error: faults of the config, files that cannot be read, no CRS, CRSs that differ or are not in metres.
PlanInput read_plan_input(const PlanRequest& request);

}  // namespace swath::pipeline
