// SPDX-License-Identifier: GPL-3.0-or-later
// The commands of the program. A command declares its options on the parser and is called with what was given.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/config/units.h"
#include "core/config/value.h"
#include "pipeline/plan.h"
#include "pipeline/progress.h"
#include "pipeline/run.h"
#include "simulate/simulate.h"

namespace swath::tools {

/// The parser with its commands, in the order of the overview.
class Commands {
 public:
  /// `help`: examples, a blank line, and one sentence for the overview. `call` returns the exit code.
  CLI::App* add(const std::string& name, const std::string& help, std::function<int()> call);
  /// Reads the command line and calls its command; throws core::Error on a fault.
  int call(int argc, char** argv);
  /// The command line as it was typed, for the provenance of products.
  const std::string& typed() const { return typed_; }
  const CLI::App& parser() const { return app_; }

  Commands();
  Commands(const Commands&) = delete;
  Commands& operator=(const Commands&) = delete;

 private:
  int parse_and_call(int argc, char** argv, const std::vector<std::string>& words);

  CLI::App app_;
  std::string typed_;
  std::vector<std::pair<CLI::App*, std::function<int()>>> calls_;
};

/// How a command that works for long reports progress.
struct Loudness {
  bool quiet = false, json_log = false;
  pipeline::Voice voice() const { return json_log ? pipeline::Voice::json : quiet ? pipeline::Voice::quiet : pipeline::Voice::bar; }
};

/// Checks of values as they are typed; without a text of their own in the help.
CLI::Validator threads_check();
CLI::Validator name_check();
/// CONFIG, --survey, --output and --set.
void add_request(CLI::App& command, pipeline::Request& request);
/// For a person: texts of files as a terminal can show them.
void print(const std::string& text);
void print_json(const core::Value& value);
/// A number with its unit from the command line, in SI units; `example`: one that would do. Throws core::Error.
double quantity(core::Dimension dimension, const std::string& text, const std::string& option, const std::string& example);

/// Summary and missed limits of a run, where it has come to its report; the exit code.
int print_outcome(const pipeline::Outcome& outcome, const pipeline::Plan& plan, const Loudness& loudness);
/// -o and --output, as every command has them that writes into a folder.
CLI::Option* add_output(CLI::App& command, std::filesystem::path& folder, const std::string& text);
/// --quiet, as every command has it that writes files.
void add_quiet(CLI::App& command, bool& quiet);
/// --threads, --save-config, --quiet and --json-log.
void add_run_options(CLI::App& command, pipeline::Request& request, Loudness& loudness, std::filesystem::path& save);

/// Runs a pipeline and prints its summary; the exit code. `typed`: the command line, for provenance. `save`: file that gets the config;
/// empty: none.
int run_pipeline(const pipeline::Request& request, const Loudness& loudness, const std::string& typed, const std::filesystem::path& save);
/// Simulates a survey into a folder, with progress. `config` may be empty; `sets` as of --set.
simulate::Made make_survey(const std::filesystem::path& config, const std::vector<std::string>& sets, const std::filesystem::path& folder,
                           const Loudness& loudness);

void add_completion_commands(Commands& commands);
void add_init_command(Commands& commands);
void add_demo_command(Commands& commands);
void add_job_commands(Commands& commands);
void add_pipeline_commands(Commands& commands);
void add_list_commands(Commands& commands);
void add_plan_command(Commands& commands);
void add_budget_command(Commands& commands);
void add_block_command(Commands& commands);
void add_block_theory_command(Commands& commands);
void add_block_drift_command(Commands& commands);
void add_undistort_command(Commands& commands);
/// What a config of `block` or `block-theory` describes, in a few words; nothing where the file is neither. Reads no image. Throws
/// core::Error (usage) with all faults.
std::optional<std::string> check_block_config(const std::filesystem::path& config, const std::vector<std::string>& sets);
void add_simulate_command(Commands& commands);
void add_info_command(Commands& commands);
void add_volumes_command(Commands& commands);
void add_profile_command(Commands& commands);
void add_map_terrain_command(Commands& commands);
void add_task_commands(Commands& commands);
void add_view_command(Commands& commands);
void add_docs_command(Commands& commands);

}  // namespace swath::tools
