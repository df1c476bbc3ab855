// SPDX-License-Identifier: GPL-3.0-or-later
// One task of a plan, for schedulers: Dask, job arrays, workflow engines.
#include "pipeline/run.h"
#include "pipeline/task_graph.h"
#include "tools/command.h"

namespace swath::tools {
namespace {

struct TaskArguments {
  std::string id;
  std::filesystem::path plan, output;
  int threads = 1;
  Loudness loudness;
};

int do_task(const TaskArguments& a, const std::string& typed) {
  pipeline::PlannedTask task = pipeline::planned_task(a.plan, a.id);
  if (!a.output.empty()) task.request.output = a.output;
  task.request.threads = a.threads;
  pipeline::Plan plan = pipeline::make_plan(task.request);
  pipeline::Progress progress(a.loudness.voice());
  return print_outcome(pipeline::run_share(plan, progress, typed, task.share, std::move(task.inputs)), plan, a.loudness);
}

}  // namespace

void add_task_command(Commands& commands) {
  const auto a = std::make_shared<TaskArguments>();
  auto* c = commands.add("task",
                         "Examples\n  swath task 1-strips.3 --plan tasks.json\n\nDo one task of a plan that several processes do together; "
                         "harmless when repeated.",
                         [a, &commands] { return do_task(*a, commands.typed()); });
  c->add_option("ID", a->id, "The task, as `swath plan CONFIG --json` names it")->required();
  c->add_option("--plan", a->plan, "The plan, .json")->required();
  c->add_option("--output", a->output, "Folder of the products, in place of the plan's: the same for every task");
  c->add_option("--threads", a->threads, "Threads (0: one per processor)")->capture_default_str();
  c->add_flag("--quiet", a->loudness.quiet, "Nothing but errors");
  c->add_flag("--json-log", a->loudness.json_log, "Progress as one JSON object per line on standard error");
}

}  // namespace swath::tools
