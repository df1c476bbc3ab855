// SPDX-License-Identifier: GPL-3.0-or-later
// Before a flight: its plan, its error budget.
#include <cstdio>

#include "core/config/result_visitors.h"
#include "core/error.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "pipeline/flight_plan/budget.h"
#include "pipeline/flight_plan/plan_files.h"
#include "pipeline/task_graph.h"
#include "tools/command.h"

namespace swath::tools {
namespace {

struct PlanArguments {
  pipeline::PlanRequest request;
  std::filesystem::path survey, tasks, slurm;
  int parts = 8;
  bool quiet = false, json = false;
};

/// The program itself, for scripts that call it from elsewhere.
std::filesystem::path own_program() {
  std::error_code ec;
  const auto file = std::filesystem::read_symlink("/proc/self/exe", ec);
  return ec ? "swath" : file;
}

int plan_tasks(const PlanArguments& a) {
  pipeline::Request request;
  request.config = a.request.config;
  request.sets = a.request.sets;
  request.survey = a.survey;
  request.output = a.request.folder;
  const pipeline::TaskGraph graph = pipeline::task_graph(request, a.parts);
  const std::string json = io::to_json(core::reported(graph));
  if (!a.slurm.empty() && a.tasks.empty())
    throw core::usage_error("the jobs read the plan", "--slurm", "write it to a file as well: --tasks tasks.json");
  if (!a.tasks.empty()) io::write_text_file(a.tasks, json);
  if (!a.slurm.empty()) io::write_text_file(a.slurm, pipeline::slurm_script(graph, a.tasks, own_program()));
  if (a.quiet) return 0;
  a.json ? static_cast<void>(std::fputs(json.c_str(), stdout)) : print(pipeline::task_text(graph));
  return 0;
}

int plan_flight(const PlanArguments& a) {
  if (a.request.folder.empty()) throw core::usage_error("no folder for the plan", "--output", "name one: --output plan");
  const planning::FlightPlan plan = pipeline::write_flight_plan(a.request);
  if (a.quiet) return 0;
  a.json ? print_json(core::reported(plan)) : print(pipeline::plan_text(plan));
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
                   "plan --set flight.speed=\"60 m/s\"\n  swath plan configs/survey.toml --survey demo/survey.toml --output out --parts 4 "
                   "--json\n\nPlan a flight over an area: lines, density, accuracy, time and cost; or a run's tasks for several processes.",
                   [a] { return pipeline::is_pipeline(a->request.config) ? plan_tasks(*a) : plan_flight(*a); });
  c->add_option("PLAN", a->request.config, "What is asked of the flight, or a pipeline, .toml or .json")->required();
  c->add_option("--dem", a->request.dem, "Terrain model, in place of the config's");
  c->add_option("--output", a->request.folder, "Folder to write to; of a pipeline that of the products");
  c->add_option("--survey", a->survey, "Pipeline: survey.toml, in place of the config's");
  c->add_option("--parts", a->parts, "Pipeline: parts of each wave that can be shared")->capture_default_str();
  c->add_option("--tasks", a->tasks, "Pipeline: file to write the tasks to, .json");
  c->add_option("--slurm", a->slurm, "Pipeline: script to write that gives the tasks to Slurm as job arrays");
  c->add_option("--set", a->request.sets, "One option: flight.speed=\"60 m/s\"")->allow_extra_args(false);
  c->add_flag("--quiet", a->quiet, "Nothing but errors");
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
