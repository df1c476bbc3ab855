// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/task_graph.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/config/result_visitors.h"
#include "core/error.h"
#include "io/records/record_count.h"
#include "io/store/address.h"
#include "io/survey/tree_kind.h"
#include "io/text/binary_file.h"
#include "io/text/value_file.h"
#include "pipeline/engine/strips.h"
#include "pipeline/engine/survey_stages.h"
#include "pipeline/expected_time.h"
#include "pipeline/progress.h"
#include "pipeline/work/checksum.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;
using core::Value;
using stages::Grain;

constexpr double work_per_input = 2.0;         // the work folder at its largest, docs/memory.md
constexpr double bytes_per_record = 32.0;      // of a laser record whose file does not count them
constexpr double bytes_per_imu_record = 56.0;  // of a file without lines

std::int64_t modified(const fs::path& file) {
  std::error_code ec;
  const auto at = fs::last_write_time(file, ec);
  return ec ? 0 : static_cast<std::int64_t>(at.time_since_epoch().count());
}

/// Records of a file whose header does not count them: by the lengths of its first lines, `otherwise` bytes each where it is no text.
double records_by_length(const fs::path& file, double otherwise) {
  const io::BinaryFile bytes(file);
  std::string start(65536, '\0');
  start.resize(bytes.read_some(0, start.data(), start.size()));
  const auto lines = static_cast<double>(std::count(start.begin(), start.end(), '\n'));
  const bool is_text = lines > 0.0 && start.find('\0') == std::string::npos;
  return static_cast<double>(bytes.size()) / (is_text ? static_cast<double>(start.size()) / lines : otherwise);
}

/// Adds the returns of a file.
void count_returns(const fs::path& file, TaskGraph& graph) {
  if (const auto stated = io::stated_records(file)) {
    graph.returns += *stated;
    return;
  }
  const auto estimated = static_cast<std::uint64_t>(records_by_length(file, bytes_per_record));
  graph.returns += estimated;
  graph.returns_estimated += estimated;
}

/// Records of the IMU, from their headers, else from the lengths of the first lines.
double imu_records(const Plan& plan) {
  double out = 0.0;
  for (const io::ImuFile& f : plan.survey.imu) {
    const fs::path file = plan.survey.folder / f.file;
    const auto stated = io::stated_records(file);
    out += stated ? static_cast<double>(*stated) : records_by_length(file, bytes_per_imu_record);
  }
  return out;
}

/// Processor time of a wave, s.
double seconds_of(const Plan& plan, const Wave& wave, double returns, double records) {
  double out = 0.0;
  for (size_t i = 0; i < plan.stages.size(); ++i) {
    const stages::Stage& stage = *plan.stages[i].stage;
    const std::string_view name = stage.info().name;
    if (wave.kind == WaveKind::survey && stage.works_on(Grain::survey))
      out += returns * expected_seconds(name, Grain::survey) + records * expected_seconds_of_imu_record(name);
    if (wave.kind == WaveKind::strips && stage.works_on(Grain::strip)) out += returns * expected_seconds(name, Grain::strip);
    if (wave.kind == WaveKind::tiles && wave.stage == i) out += returns * expected_seconds(name, Grain::tile);
    if (wave.kind == WaveKind::finish && stage.works_on(Grain::merge)) out += returns * expected_seconds(name, Grain::merge);
  }
  return out;
}

constexpr const char* grain_names[] = {"survey", "strip", "tile", "finish"};

class GraphMaker {
 public:
  GraphMaker(const Request& request, int parts)
      : plan_(make_plan(request)), quiet_(Voice::quiet), run_(plan_, quiet_), parts_(static_cast<std::uint64_t>(parts)) {
    if (plan_.survey_file.empty())
      throw core::usage_error("no survey to list tasks of", plan_.config.string(), "name it with --survey DIR/survey.toml");
    if (plan_.survey_tree)
      throw core::usage_error("a PDAL pipeline cannot be run by several processes", plan_.config.string(),
                              "swath run --save-config NAME.toml writes it as a config with its survey");
    prepare(run_);
    if (makes_points(plan_)) choose_strips(run_);
    graph_.config = fs::absolute(plan_.config).string();
    graph_.survey = fs::absolute(plan_.survey_file).string();
    graph_.output = run_.output.string();
    graph_.sets = request.sets;
    graph_.fingerprint = run_.fingerprints.empty() ? "" : run_.fingerprints.back();
    graph_.memory = plan_.run.memory.value;
  }

  TaskGraph make() {
    for (const Input& i : run_.inputs) {
      graph_.inputs.push_back({io::is_address(i.file) ? i.file : fs::absolute(i.file), i.bytes, modified(i.file), i.hash});
      graph_.bytes_in += i.bytes;
    }
    for (const io::LaserFile& f : plan_.survey.laser) count_returns(plan_.survey.folder / f.file, graph_);
    for (const io::PointFile& f : plan_.survey.points) count_returns(io::resolve(plan_.survey, f.file), graph_);
    graph_.disk = work_per_input * static_cast<double>(graph_.bytes_in);
    records_ = imu_records(plan_);
    const std::vector<Wave> waves = waves_of(plan_);
    for (size_t number = 0; number < waves.size(); ++number) add(waves[number], number);
    return std::move(graph_);
  }

 private:
  void add(const Wave& wave, size_t number) {
    const std::uint64_t parts = wave.is_shared() ? parts_ : 1;
    const double seconds = seconds_of(plan_, wave, static_cast<double>(graph_.returns), records_);
    std::vector<std::string> mine;
    for (std::uint64_t part = 1; part <= parts; ++part) {
      Task t;
      t.id = std::to_string(number) + "-" + name_of(plan_, wave) + (wave.is_shared() ? "." + std::to_string(part) : "");
      t.wave = number, t.part = part, t.parts = parts;
      t.grain = grain_names[static_cast<size_t>(wave.kind)];
      t.stage = wave.kind == WaveKind::tiles ? name_of(plan_, wave) : "";
      t.needs = before_;
      t.reads = folders_;
      t.writes = {folder_of(wave)};
      t.memory = graph_.memory;
      t.seconds = seconds / static_cast<double>(parts);
      mine.push_back(t.id);
      graph_.tasks.push_back(std::move(t));
    }
    graph_.seconds += seconds;
    graph_.critical_seconds += seconds / static_cast<double>(parts);
    before_ = std::move(mine);
    folders_.push_back(folder_of(wave));
  }

  std::string folder_of(const Wave& wave) const {
    switch (wave.kind) {
      case WaveKind::survey:
        return run_.work.filename().string();
      case WaveKind::strips:
        return run_.folder(run_.last_strip_stage).filename().string();
      case WaveKind::tiles:
        return run_.folder(wave.stage).filename().string();
      case WaveKind::finish:
        return run_.output.string();
    }
    return "";
  }

  Plan plan_;
  Progress quiet_;
  RunState run_;
  std::uint64_t parts_;
  double records_ = 0.0;
  TaskGraph graph_;
  std::vector<std::string> before_, folders_;
};

/// The tasks of each wave, in order.
std::vector<std::vector<const Task*>> by_wave(const TaskGraph& graph) {
  std::vector<std::vector<const Task*>> out;
  for (const Task& t : graph.tasks) {
    if (t.wave >= out.size()) out.resize(t.wave + 1);
    out[t.wave].push_back(&t);
  }
  return out;
}

std::string duration(double s) {
  char text[40];
  if (s < 600)
    std::snprintf(text, sizeof text, "%.0f s", s);
  else if (s < 36000)
    std::snprintf(text, sizeof text, "%.0f min", s / 60);
  else
    std::snprintf(text, sizeof text, "%.0f h", s / 3600);
  return text;
}

/// For a shell, whatever the name holds.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

const Value& member(const Value& table, std::string_view key, const fs::path& file) {
  if (const Value* v = table.is_object() ? table.find(key) : nullptr) return *v;
  throw core::Error("it is not a list of tasks: '" + std::string(key) + "' is missing", file.string(),
                    "make one with `swath tasks CONFIG --survey S --save tasks.json`");
}

Input unchanged_input(const Value& given, const fs::path& tasks) {
  Input out{member(given, "file", tasks).as_text(), static_cast<std::uint64_t>(member(given, "bytes", tasks).as_int()),
            member(given, "hash", tasks).as_text()};
  const char* const list_anew = "list them anew with `swath tasks`, for another --output";
  if (io::is_address(out.file)) {
    if (checksum_of_input(out.file) != out.hash)
      throw core::usage_error("it has changed since the tasks were listed", out.file.string(), list_anew);
    return out;
  }
  std::error_code ec;
  const auto bytes = fs::file_size(out.file, ec);
  if (ec) throw core::usage_error("it is not there: " + ec.message(), out.file.string(), "the run reads it; do all machines see it?");
  if (bytes != out.bytes || modified(out.file) != member(given, "modified", tasks).as_int())
    throw core::usage_error("it has changed since the tasks were listed", out.file.string(), list_anew);
  return out;
}

}  // namespace

TaskGraph task_graph(const Request& request, int parts) {
  if (parts < 1 || parts > max_parts)
    throw core::usage_error(std::to_string(parts) + " parts", "--parts", "write a number from 1 to 100000");
  return GraphMaker(request, parts).make();
}

std::string task_text(const TaskGraph& graph) {
  std::string out;
  char line[260];
  for (const auto& wave : by_wave(graph)) {
    const Task& t = *wave.front();
    double seconds = 0.0;
    for (const Task* one : wave) seconds += one->seconds;
    std::snprintf(line, sizeof line, "wave %2llu  %5zu x %-24s %s of processor time\n", static_cast<unsigned long long>(t.wave),
                  wave.size(), t.stage.empty() ? t.grain.c_str() : t.stage.c_str(), duration(seconds).c_str());
    out += line;
  }
  std::snprintf(line, sizeof line,
                "%s returns%s of %.1f GB: about %s of processor time, %s with a processor for every task; %.1f GB of memory for each, "
                "%.1f GB of disk for the work\n",
                count_text(static_cast<double>(graph.returns)).c_str(),
                graph.returns_estimated > 0 ? " (estimated: not every file states its records)" : "",
                1e-9 * static_cast<double>(graph.bytes_in), duration(graph.seconds).c_str(), duration(graph.critical_seconds).c_str(),
                1e-9 * graph.memory, 1e-9 * graph.disk);
  return out + line;
}

std::string slurm_script(const TaskGraph& graph, const fs::path& tasks, const fs::path& program) {
  std::string out =
      "#!/bin/sh\n# Made by `swath tasks`: one job array for each wave, each after the one before. A job that failed is given back with "
      "the\n"
      "# same command: what is done is not done again.\nset -eu\n";
  std::string before;
  for (const auto& wave : by_wave(graph)) {
    const Task& t = *wave.front();
    const std::string number = std::to_string(t.wave), stem = t.id.substr(0, t.id.rfind('.'));
    const std::string id = wave.size() > 1 || t.grain == "strip" || t.grain == "tile" ? stem + ".\"$SLURM_ARRAY_TASK_ID\"" : t.id;
    std::string line = "job" + number + "=$(sbatch --parsable --kill-on-invalid-dep=yes --job-name=swath-" + number +
                       " --cpus-per-task=1 --mem=" + std::to_string(static_cast<long>(std::ceil(1.1e-6 * graph.memory))) + "M";
    if (id != t.id) line += " --array=1-" + std::to_string(wave.size());
    if (!before.empty()) line += " --dependency=afterok:\"$" + before + "\"";
    const std::string command =
        quoted(program.string()) + " task " + id + " --tasks " + quoted(fs::absolute(tasks).string()) + " --threads 1 --quiet";
    out += line + " --wrap " + quoted(command) + ")\n";
    before = "job" + number;
  }
  return out + "echo \"$" + before + "\"\n";
}

PlannedTask planned_task(const fs::path& tasks, const std::string& id) {
  const Value root = io::read_value_file(tasks);
  io::require_kind(root, io::TreeKind::tasks, tasks);
  PlannedTask out;
  out.request.config = member(root, "config", tasks).as_text();
  out.request.survey = member(root, "survey", tasks).as_text();
  out.request.output = member(root, "output", tasks).as_text();
  for (const Value& set : member(root, "sets", tasks).items()) out.request.sets.push_back(set.as_text());
  std::vector<std::string> names;
  bool found = false;
  for (const Value& t : member(root, "tasks", tasks).items()) {
    names.push_back(member(t, "id", tasks).as_text());
    if (names.back() != id) continue;
    found = true;
    out.share = {static_cast<size_t>(member(t, "wave", tasks).as_int()), static_cast<int>(member(t, "part", tasks).as_int()),
                 static_cast<int>(member(t, "parts", tasks).as_int()), member(root, "fingerprint", tasks).as_text()};
  }
  if (!found) {
    const std::string near = core::nearest(id, names);
    throw core::usage_error("there is no task '" + id + "'", tasks.string(), near.empty() ? "" : "did you mean '" + near + "'?");
  }
  for (const Value& given : member(root, "inputs", tasks).items()) out.inputs.push_back(unchanged_input(given, tasks));
  return out;
}

}  // namespace swath::pipeline
