// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/outcome.h"

#include <limits>
#include <set>

#include "core/config/result_visitors.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "pipeline/delivery.h"
#include "pipeline/engine/map_fit.h"
#include "pipeline/engine/run_report.h"
#include "pipeline/input_guard.h"
#include "pipeline/report_docs.h"
#include "pipeline/report_warnings.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;
using core::Value;

Measured measured(const RunState& run) {
  const auto finding = [&](std::string_view limit) -> std::optional<double> {
    for (const LimitedFinding& f : limited_findings())
      for (size_t i = 0; i < run.accounts.size(); ++i)
        if (f.limit == limit && run.stage(i).info().name == f.stage)
          if (const Value* v = value_at(run.accounts[i].findings, f.path))  // null: computed, and not finite
            return v->is_number() ? v->as_number() : std::numeric_limits<double>::quiet_NaN();
    return std::nullopt;
  };
  std::optional<double> outside;
  for (size_t i = 0; i < run.accounts.size(); ++i)
    if (run.stage(i).info().name == "georeference" && run.accounts[i].in > 0)
      outside = static_cast<double>(run.accounts[i].tally.of("outside the trajectory, left out")) / static_cast<double>(run.accounts[i].in);
  return {outside,
          finding("voids"),
          finding("truth_rms"),
          finding("line_difference"),
          finding("contradictions"),
          finding("overlap_difference"),
          finding("void_share"),
          finding("nva"),
          finding("vva"),
          finding("planimetry"),
          finding("surface_difference"),
          finding("quality_level")};
}

/// Control of the survey that no stage reads, with what it is for.
std::vector<std::string> unused_control(const Plan& plan) {
  std::set<fs::path> read;
  for (const PlannedStage& s : plan.stages)
    for (const fs::path& file : s.stage->inputs(plan.survey)) read.insert(file);
  std::vector<std::string> out;
  for (const io::ControlFile& f : plan.survey.control)
    if (!read.contains(io::resolve(plan.survey, f.file)))
      out.push_back(f.file.string() + " (use = \"" + std::string(core::Choices<io::ControlUse>::names[static_cast<size_t>(f.use)]) + "\")");
  return out;
}

StageReport stage_report(const RunState& run, size_t number, const Value& options) {
  const Account& a = run.accounts[number];
  StageReport s{run.stage(number).info().name, run.fingerprints[number]};
  // A source that survey stages alone read has its records.
  if (!run.works_on(number, stages::Grain::survey) && (number != run.source || run.store)) s.counts = {a.in, a.out};
  s.cut = a.cut;
  s.records = a.tally.records();
  if (!a.tally.empty()) s.tally = a.tally.value();
  if (const Value* geometry = a.findings.find("geometry"))
    s.findings = Value(Value::Object{{"verdict", *geometry->find("verdict")}});
  else if (!a.findings.members().empty())
    s.findings = a.findings;
  s.options = options;
  s.time = a.time;
  return s;
}

CrsReport crs_report(const RunState& run) {
  CrsReport r{run.context.crs.name(), run.plan.survey.crs, run.context.heights};
  if (const auto fit = map_fit(run.context)) r.scale = fit->scale, r.outside = fit->outside;
  return r;
}

}  // namespace

core::Value report_of(const RunState& run, const std::string& command, const TimeSpent& time) {
  RunReport r;
  r.program = "swath " + std::string(program_version());
  r.command = command;
  r.survey = run.plan.survey.name;
  if (!run.context.crs.empty()) r.crs = crs_report(run);
  r.inputs = run.inputs;
  const Explanation options = explain(run.plan);
  r.run = options.run;
  for (size_t i = 0; i < run.accounts.size(); ++i) {
    r.stages.push_back(stage_report(run, i, options.stages[i].options));
    if (const Value* geometry = run.accounts[i].findings.find("geometry")) r.geometry = *geometry;
  }
  r.versions = versions();
  r.limits = judged(run.plan.run.limits, measured(run));
  r.control_unused = unused_control(run.plan);
  r.over_memory = run.over_memory;
  r.pieces_resumed = run.resumed;
  r.pieces_damaged = run.damaged;
  r.strips_read_again = run.read_again;
  r.time = time;
  r.threads = run.threads;
  r.warnings = warnings_in(core::reported(r));
  return core::reported(r);
}

void deliver_all(RunState& run, const Value& report, const WorkLock& lock) {
  const fs::path folder = run.folder(run.plan.stages.size() - 1) / "report";
  io::write_text_file(folder / "report.json", io::to_json(report));
  std::vector<fs::path> all = run.context.earlier;
  all.push_back(folder);
  lock.expect_there();
  for (size_t i = 0; i < run.plan.stages.size(); ++i) expect_made(run, i);
  deliver(all, run.output, run.plan.run.keep_work, outside_inputs(run.plan));
  lock.expect_there();
}

void expect_all_delivered(const RunState& run, const Value& report) {
  for (const std::vector<PieceFile>& of_stage : run.made)
    for (const PieceFile& f : of_stage)
      if (f.name.begin()->string() == products_name) expect_delivered(run.output / f.name.lexically_relative(products_name), f.bytes);
  expect_delivered(run.output / "report.json", io::to_json(report).size());
}

const Value* judged_geometry(const RunState& run) {
  for (const Account& a : run.accounts)
    if (const Value* geometry = a.findings.find("geometry")) return geometry;
  return nullptr;
}

[[noreturn]] void keep_finished(const RunState& run, const core::Error& e) {
  std::error_code absent;
  fs::remove(run.output / "report.json", absent);  // of an earlier run: it says nothing of these products
  try {
    deliver(run.context.earlier, run.output, true, outside_inputs(run.plan));
  } catch (const core::Error&) {
    throw e;
  }
  throw core::Error(e.what(), e.where(),
                    (e.hint().empty() ? std::string() : e.hint() + "; ") + "the products of the stages before it are in " +
                        run.output.string() + ", and the same command goes on from there",
                    e.code());
}

}  // namespace swath::pipeline
