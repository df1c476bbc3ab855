// SPDX-License-Identifier: GPL-3.0-or-later
// A run as tasks, for schedulers: Dask, job arrays, workflow engines.
#include <cstdio>

#include "core/config/result_visitors.h"
#include "core/error.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "pipeline/engine/task_graph.h"
#include "pipeline/flight_plan/plan_files.h"
#include "pipeline/run.h"
#include "tools/command.h"

namespace swath::tools {
namespace {

struct TaskListArguments {
  pipeline::Request request;
  std::filesystem::path save, slurm;
  int parts = 8;
  bool quiet = false, json = false;
};

/// The program itself, for scripts that call it from elsewhere.
std::filesystem::path own_program() {
  std::error_code ec;
  const auto file = std::filesystem::read_symlink("/proc/self/exe", ec);
  return ec ? "swath" : file;
}

int list_tasks(const TaskListArguments& a) {
  if (pipeline::is_flight_plan(a.request.config))
    throw core::usage_error("it is a flight plan, not a pipeline", a.request.config.string(), "`swath plan` plans flights");
  if (!a.slurm.empty() && a.save.empty())
    throw core::usage_error("the jobs read the tasks from a file", "--slurm", "name the file as well: --save tasks.json");
  const pipeline::TaskGraph graph = pipeline::task_graph(a.request, a.parts);
  const std::string json = io::to_json(core::reported(graph));
  if (!a.save.empty()) io::write_text_file(a.save, json);
  if (!a.slurm.empty()) io::write_text_file(a.slurm, pipeline::slurm_script(graph, a.save, own_program()));
  if (a.json)
    std::fputs(json.c_str(), stdout);
  else if (!a.quiet)
    print(pipeline::task_text(graph));
  return 0;
}

struct TaskArguments {
  std::string id;
  std::filesystem::path tasks, output;
  int threads = 1;
  Loudness loudness;
};

int do_task(const TaskArguments& a, const std::string& typed) {
  pipeline::PlannedTask task = pipeline::planned_task(a.tasks, a.id);
  if (!a.output.empty()) task.request.output = a.output;
  task.request.threads = a.threads;
  pipeline::Plan plan = pipeline::make_plan(task.request);
  pipeline::Progress progress(a.loudness.voice());
  return print_outcome(pipeline::run_share(plan, progress, typed, task.share, std::move(task.inputs)), plan, a.loudness);
}

}  // namespace

void add_task_commands(Commands& commands) {
  const auto list = std::make_shared<TaskListArguments>();
  auto* tasks =
      commands.add("tasks",
                   "Examples\n  swath tasks configs/survey_sbet.toml --survey demo/survey.toml --output out --parts 8\n  swath tasks "
                   "configs/survey_sbet.toml --survey demo/survey.toml --output out --save tasks.json --slurm jobs.sh\n\nList a run's "
                   "tasks for several processes or machines, with time, memory and disk.",
                   [list] { return list_tasks(*list); });
  add_request(*tasks, list->request);
  tasks->add_option("--parts", list->parts, "Tasks of each wave that can be shared")->capture_default_str();
  tasks->add_option("--save", list->save, "File to write the tasks to, .json");
  tasks->add_option("--slurm", list->slurm, "Script to write that gives the tasks to Slurm as job arrays");
  add_quiet(*tasks, list->quiet);
  tasks->add_flag("--json", list->json, "The tasks as JSON");

  const auto a = std::make_shared<TaskArguments>();
  auto* c = commands.add("task",
                         "Examples\n  swath task 0-survey --tasks tasks.json\n\nDo one task of a run that several processes do together; "
                         "harmless when repeated.",
                         [a, &commands] { return do_task(*a, commands.typed()); });
  c->add_option("ID", a->id, "The task, as `swath tasks` names it")->required();
  c->add_option("--tasks", a->tasks, "File that `swath tasks --save` wrote")->required();
  add_output(*c, a->output, "Folder of the products, in place of the file's: the same for every task");
  c->add_option("--threads", a->threads, "Threads (0: one per processor)")->capture_default_str()->check(threads_check());
  add_quiet(*c, a->loudness.quiet);
  c->add_flag("--json-log", a->loudness.json_log, "Progress as one JSON object per line on standard error");
}

}  // namespace swath::tools
