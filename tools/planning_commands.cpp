// SPDX-License-Identifier: GPL-3.0-or-later
// Before a flight: its plan, its error budget.
#include <cstdio>

#include "core/config/result_visitors.h"
#include "core/error.h"
#include "pipeline/flight_plan/budget.h"
#include "pipeline/flight_plan/plan_files.h"
#include "tools/command.h"

namespace swath::tools {
namespace {

struct PlanArguments {
  pipeline::PlanRequest request;
  bool quiet = false, json = false;
};

int plan_flight(const PlanArguments& a) {
  if (pipeline::is_pipeline(a.request.config))
    throw core::usage_error("it is a pipeline, not a flight plan", a.request.config.string(), "`swath tasks` lists the tasks of its run");
  const planning::FlightPlan plan = pipeline::write_flight_plan(a.request);
  if (a.json)
    print_json(core::reported(plan));
  else if (!a.quiet)
    print(pipeline::plan_text(plan));
  return 0;
}

struct BudgetArguments {
  pipeline::BudgetRequest request;
  std::string height, speed = "60 m/s";
  std::vector<std::string> angles{"0 deg", "20 deg"};
  bool json = false;
};

int budget(BudgetArguments& a) {
  a.request.height = quantity(core::Dimension::length, a.height, "--height", "600 m");
  a.request.speed = quantity(core::Dimension::speed, a.speed, "--speed", "60 m/s");
  a.request.angles.clear();
  for (const std::string& angle : a.angles) a.request.angles.push_back(quantity(core::Dimension::angle, angle, "--angle", "20 deg"));
  const pipeline::BudgetTable table = pipeline::budget_of(a.request);
  a.json ? print_json(core::reported(table)) : print(pipeline::budget_text(table));
  return 0;
}

}  // namespace

void add_plan_command(Commands& commands) {
  const auto a = std::make_shared<PlanArguments>();
  auto* c =
      commands.add("plan",
                   "Examples\n  swath plan configs/flight/plan.toml --output plan\n  swath plan flight.toml --dem terrain.tif --output "
                   "plan --set flight.speed=\"60 m/s\"\n\nPlan a flight over an area: lines, density, accuracy, time and cost.",
                   [a] { return plan_flight(*a); });
  c->add_option("PLAN", a->request.config, "What is asked of the flight, .toml or .json")->required();
  c->add_option("--dem", a->request.dem, "Terrain model, in place of the config's");
  add_output(*c, a->request.folder, "Folder to write to")->required();
  c->add_option("--set", a->request.sets, "One option of the plan: flight.speed=\"60 m/s\"")->allow_extra_args(false);
  add_quiet(*c, a->quiet);
  c->add_flag("--json", a->json, "The plan as JSON");
}

void add_budget_command(Commands& commands) {
  const auto a = std::make_shared<BudgetArguments>();
  auto* c = commands.add("budget",
                         "Examples\n  swath budget demo/survey.toml --height \"600 m\" --angle \"0 deg\" --angle \"20 deg\" --slope "
                         "0.1\n\nShow the errors of a survey's points by source, from its own sigmas.",
                         [a] { return budget(*a); });
  c->add_option("SURVEY", a->request.survey, "survey.toml")->required();
  c->add_option("--height", a->height, "Above the ground")->required();
  c->add_option("--angle", a->angles, "Scan angle; may be given more than once")->allow_extra_args(false)->capture_default_str();
  c->add_option("--speed", a->speed, "Over the ground: errors of time move a point along the track")->capture_default_str();
  c->add_option("--slope", a->request.slope, "Of the ground across the track, rise / run")->capture_default_str();
  c->add_option("--penetration", a->request.penetration, "Share of the pulses that reach the ground under trees")
      ->check(CLI::Range(0.0, 1.0));
  c->add_flag("--json", a->json, "As JSON");
}

}  // namespace swath::tools
