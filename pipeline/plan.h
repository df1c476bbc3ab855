// SPDX-License-Identifier: GPL-3.0-or-later
// A config and a survey become a checked plan: every fault is found before the first byte of data is read.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/config/option_visitors.h"
#include "core/config/result.h"
#include "core/parallel.h"
#include "io/survey/survey.h"
#include "io/survey/survey_checks.h"
#include "pipeline/limits.h"
#include "stages/entry.h"
#include "stages/stage.h"

namespace swath::pipeline {

struct RunOptions {
  std::optional<std::filesystem::path> survey;
  std::filesystem::path output = "out";
  core::Bytes memory{2e9};
  core::Metres tile{500.0};
  int threads = 0;
  bool keep_work = false;
  Limits limits;
};

template <class V>
void describe(RunOptions& r, V& v) {
  v.option("survey", r.survey, "The survey.toml, relative to the config; usually given on the command line.");
  v.option("output", r.output, "Folder of the products, relative to the working folder.");
  v.option("memory", r.memory, core::at_least(2e8), "Peak memory of the whole process.");
  v.option("tile", r.tile, core::within(10.0, 1e5), "Side of the tiles in which the survey is worked on and delivered.");
  v.option("threads", r.threads, core::within(0, core::max_threads), "Threads; 0: one per processor.");
  v.option("keep_work", r.keep_work, "Keep the intermediate point store after a finished run, so that changed late stages are done alone.");
  v.table("limits", r.limits, "Limits of quality.");
}

/// What the command line gives.
struct Request {
  std::filesystem::path config;          ///< a file, or the name of a config that comes with the program
  std::vector<std::string> sets;         ///< "ground.cell=50 cm", "run.tile=250 m"
  std::filesystem::path survey, output;  ///< empty: from the config
  int threads = -1;
  std::optional<core::Value> survey_tree{};      ///< a survey that no file holds, in place of one; its files have absolute names
  std::optional<core::Value> tree{};             ///< what the config holds, where it is no file; `config` then names it in messages
  std::vector<stages::Entry> entries{};          ///< stages that the plan may name beside those of the registry
  io::RecordsIn records = io::RecordsIn::files;  ///< memory: some of these stages give points or the trajectory
};

struct PlannedStage {
  std::unique_ptr<stages::Stage> stage;
  core::Value table;  ///< as written, for the origin of values
  std::string path;   ///< "stage[3]"
  core::Describe describe() const {
    return [s = stage.get()](core::Visitor& v) { s->visit(v); };
  }
};

struct Plan {
  std::filesystem::path config;
  RunOptions run;
  core::Value run_table;                          ///< as written
  core::Value run_flags = core::Value::object();  ///< of [run] what flags of the command line set
  std::filesystem::path survey_file;              ///< empty: none was named; "command line" for one that no file holds
  io::Survey survey;
  std::vector<PlannedStage> stages;
  std::optional<core::Value> survey_tree{};  ///< as Request::survey_tree
  std::vector<std::string> runs_as{};        ///< a pipeline of PDAL: what each of its stages is here

  /// Does the stage work on such pieces of this survey?
  bool works_on(size_t number, stages::Grain g) const {
    const stages::Stage& stage = *stages[number].stage;
    return stage.works_on(g) && (g != stages::Grain::tile || stage.has_tile_work(survey));
  }
};

/// Reads config and survey. Throws core::Error (exit code 2) with all faults. A plan without a survey can be checked and
/// explained, not run.
Plan make_plan(const Request& request);

/// Does a stage work with points or surfaces on the map? Plans of survey stages alone (records to trajectory) need no source and no
/// map projection.
bool works_on_the_map(const Plan& plan);

/// Does a stage behind the source work on its strips or tiles? Plans of calibration stream the source's shots through survey stages alone.
bool makes_points(const Plan& plan);

/// Throws core::Error (usage) where the CRS is no map projection.
void require_projected(const core::Crs& crs, const std::filesystem::path& survey);

struct ExplainedStage {
  std::string_view type;
  core::Value options;
};

template <class V>
void describe(const ExplainedStage& s, V& v) {
  v.result("type", s.type, "The stage.");
  v.other("options", s.options, "Every option: its value, and where it was set.");
}

/// The effective options with where each comes from: {"tile": {"value": "500 m", "from": "default"}}.
struct Explanation {
  std::string config, survey;
  core::Value run;
  std::vector<ExplainedStage> stages{};
};

template <class V>
void describe(const Explanation& e, V& v) {
  v.result("config", e.config, "The config.");
  v.result("survey", e.survey, "The survey; empty where none was named.");
  v.other("run", e.run, "Every option of [run]: its value, and where it was set.");
  v.tables("stages", e.stages, "The stages in their order.");
}

Explanation explain(Plan& plan);

}  // namespace swath::pipeline
