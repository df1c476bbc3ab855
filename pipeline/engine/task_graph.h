// SPDX-License-Identifier: GPL-3.0-or-later
// A run as tasks that processes do together: for Dask, job arrays and workflow engines. The tasks of a wave need all of the wave before.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/config/result.h"
#include "pipeline/engine/share.h"
#include "pipeline/plan.h"
#include "pipeline/provenance.h"

namespace swath::pipeline {

/// A file that the run reads, as it was when the tasks were listed.
struct TaskInput {
  std::filesystem::path file;
  std::uint64_t bytes = 0;
  std::int64_t modified = 0;  ///< by the file system's clock: compared, never read as a time
  std::string hash;
};

template <class V>
void describe(const TaskInput& i, V& v) {
  v.result("file", i.file.string(), "The file.");
  v.result("bytes", i.bytes, "Its length.");
  v.result("modified", i.modified, "When it was last written, as the file system counts.");
  v.result("hash", i.hash, "XXH3 of its content.");
}

struct Task {
  std::string id;
  std::uint64_t wave = 0, part = 1, parts = 1;
  std::string grain, stage;
  std::vector<std::string> needs{}, reads{}, writes{};
  double memory = 0.0, seconds = 0.0;
};

template <class V>
void describe(const Task& t, V& v) {
  v.result("id", t.id, "What `swath task` calls it.");
  v.result("wave", t.wave, "Number of its wave, from 0.");
  v.result("part", t.part, "Its part of the wave, from 1.");
  v.result("parts", t.parts, "Parts of the wave.");
  v.result("grain", t.grain, "survey, strip, tile or finish.");
  v.result("stage", t.stage, "The stage; of a survey or strips task all of them.");
  v.result("needs", t.needs, "Tasks that must be done before.");
  v.result("reads", t.reads, "Folders of the work folder that it reads.");
  v.result("writes", t.writes, "Folder of the work folder that it writes; of the last task the output folder.");
  v.result("memory", t.memory, core::Form{"B"}, "Peak memory of its process (run.memory).");
  v.result("seconds", t.seconds, core::seconds(), "Processor time expected; a rough guess.");
}

struct TaskGraph {
  std::string config, survey, output, fingerprint;
  std::vector<std::string> sets{};
  std::uint64_t returns = 0, returns_estimated = 0, bytes_in = 0;
  double seconds = 0.0, critical_seconds = 0.0, memory = 0.0, disk = 0.0;
  std::vector<TaskInput> inputs{};
  std::vector<Task> tasks{};
};

template <class V>
void describe(const TaskGraph& g, V& v) {
  v.result("config", g.config, "The config.");
  v.result("survey", g.survey, "The survey.");
  v.result("output", g.output, "The output folder, which all processes see.");
  v.result("sets", g.sets, "Options set beside the config.");
  v.result("fingerprint", g.fingerprint, "Of config, survey, inputs and program: a task of another is refused.");
  v.result("returns", g.returns, "Returns of the inputs, as their headers state them or estimated.");
  v.result("returns_estimated", g.returns_estimated, core::if_any(),
           "Returns among them that no header states: estimated from the files' length.");
  v.result("bytes_in", g.bytes_in, core::Form{"B"}, "Length of all inputs.");
  v.result("seconds", g.seconds, core::seconds(), "Processor time expected of all tasks; a rough guess.");
  v.result("critical_seconds", g.critical_seconds, core::seconds(), "The same with a processor for every task.");
  v.result("memory", g.memory, core::Form{"B"}, "Peak memory of each process.");
  v.result("disk", g.disk, core::Form{"B"}, "Of the work folder at most, beside the products.");
  v.tables("inputs", g.inputs, "Files that are read, as they were when the tasks were listed.");
  v.tables("tasks", g.tasks, "The tasks, in an order in which they can be done.");
}

/// `parts`: of each wave that can be shared. Reads the inputs once for their hashes; writes nothing. Throws core::Error.
TaskGraph task_graph(const Request& request, int parts);

/// For people: waves, parts, time, memory and disk.
std::string task_text(const TaskGraph& graph);

/// A job array for each wave, for sbatch. `tasks`: the file that the graph was written to.
std::string slurm_script(const TaskGraph& graph, const std::filesystem::path& tasks, const std::filesystem::path& program);

/// One task of a graph that was written to a file: what to run, and what is known of its inputs.
struct PlannedTask {
  Request request;
  Share share;
  std::vector<Input> inputs;
};

/// Reads the file and finds the task. Throws core::Error: no list of tasks, no such task, or an input is not what it was.
PlannedTask planned_task(const std::filesystem::path& tasks, const std::string& id);

}  // namespace swath::pipeline
