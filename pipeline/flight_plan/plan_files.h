// SPDX-License-Identifier: GPL-3.0-or-later
// `swath plan`: the files of a flight plan.
#pragma once

#include <string>

#include "pipeline/flight_plan/plan_input.h"
#include "planning/flight_plan.h"

namespace swath::pipeline {

/// Plans the flight and writes into the request's folder (made where it is not there): plan.json, plan.html, lines.gpkg, lines.kml,
/// lines.csv, density.tif, lines_seen.tif, sigma.tif (bands height and horizontal), simulate.json. Throws core::Error: whatever
/// read_plan_input and make_flight_plan refuse, outputs that are inputs, files that cannot be written.
planning::FlightPlan write_flight_plan(const PlanRequest& request);

/// Is that config a flight plan, and no pipeline? No, too, where there is no such file.
bool is_flight_plan(const std::filesystem::path& config);
/// Does the file hold stages, as configs of `swath run` do?
bool is_pipeline(const std::filesystem::path& config);
/// The same without writing anything.
planning::FlightPlan check_flight_plan(const PlanRequest& request);

/// The plan in a few lines for a terminal.
std::string plan_text(const planning::FlightPlan& plan);

/// Options of `swath simulate` that fly the plan over its own ground; those of [simulate] come before the plan's.
core::Value simulation_of(const planning::FlightPlan& plan, const PlanInput& input);

}  // namespace swath::pipeline
