// SPDX-License-Identifier: GPL-3.0-or-later
// The report of a flight plan.
#pragma once

#include <string>

#include "pipeline/flight_plan/plan_input.h"
#include "planning/flight_plan.h"

namespace swath::pipeline {

/// One HTML file: figures of the swath, maps with the lines, table of lines, errors by source, eye safety, photogrammetry, cost.
std::string plan_page(const planning::FlightPlan& plan, const PlanInput& input);

}  // namespace swath::pipeline
