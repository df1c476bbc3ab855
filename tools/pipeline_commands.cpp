// SPDX-License-Identifier: GPL-3.0-or-later
// Pipelines: run, check, explain.
#include <cstdio>

#include "core/config/result_visitors.h"
#include "core/error.h"
#include "core/printable.h"
#include "io/store/address.h"
#include "io/store/input_file.h"
#include "pipeline/describe.h"
#include "pipeline/flight_plan/plan_files.h"
#include "pipeline/input_guard.h"
#include "pipeline/jobs/config_folder.h"
#include "pipeline/jobs/saved_config.h"
#include "pipeline/jobs/store_delivery.h"
#include "pipeline/limits.h"
#include "pipeline/run.h"
#include "pipeline/summary.h"
#include "tools/command.h"

namespace swath::tools {

namespace {

/// How the stages of a PDAL pipeline are run, line by line.
void print_runs_as(const pipeline::Plan& plan) {
  if (!plan.runs_as.empty()) print(plan.config.string() + " is a PDAL pipeline; it runs as\n");
  for (const std::string& one : plan.runs_as) print("  " + one + "\n");
}

}  // namespace

int print_outcome(const pipeline::Outcome& outcome, const pipeline::Plan& plan, const Loudness& loudness) {
  if (!outcome.report.is_object()) return static_cast<int>(outcome.code);
  if (!loudness.quiet && !loudness.json_log) print(pipeline::summary(outcome.report, plan.run.output));
  if (outcome.code == core::Exit::quality_missed)
    for (const pipeline::Warning& w : pipeline::missed_limits(*outcome.report.find("limits"), outcome.report.find("stages")))
      std::fprintf(stderr, "swath: done, but a quality limit was missed: %s\n", core::printable(w.text).c_str());
  return static_cast<int>(outcome.code);
}

int run_pipeline(const pipeline::Request& request, const Loudness& loudness, const std::string& typed, const std::filesystem::path& save) {
  pipeline::Plan plan = pipeline::make_plan(request);
  if (!save.empty()) pipeline::save_config(plan, save, typed);
  if (!loudness.quiet && !loudness.json_log) print_runs_as(plan);
  pipeline::Progress progress(loudness.voice());
  return print_outcome(pipeline::run(plan, progress, typed), plan, loudness);
}

namespace {

struct Given {
  pipeline::Request request;
  std::filesystem::path save, deliver;
  Loudness loudness;
  bool json = false;
  std::optional<size_t> wave;
  std::string part = "1/1";
};

/// A run whose products go to a store, too.
int run_and_store(const Given& a, const std::string& typed) {
  pipeline::check_store(a.deliver);
  pipeline::Plan plan = pipeline::make_plan(a.request);
  if (!a.save.empty()) pipeline::save_config(plan, a.save, typed);
  const bool speaks = !a.loudness.quiet && !a.loudness.json_log;
  if (speaks) print_runs_as(plan);
  pipeline::Progress progress(a.loudness.voice());
  pipeline::Copied copied;
  const int code = print_outcome(pipeline::run_to_store(plan, progress, typed, a.deliver, copied), plan, a.loudness);
  if (speaks)
    print(std::string(copied.is_earlier ? "products of the run before copied: " : "copied: ") + core::counted(copied.files, "file") + ", " +
          core::format_number(static_cast<double>(copied.bytes) / 1e6, 4) + " MB, to " + io::shown_name(a.deliver) + "\n");
  return code;
}

int run(const Given& a, const std::string& typed) {
  if (!a.deliver.empty() && a.wave)
    throw core::usage_error("a wave is a part of a run", "--deliver", "run the whole, or copy the products when the last wave is done");
  if (!a.deliver.empty()) return run_and_store(a, typed);
  if (!a.wave) return run_pipeline(a.request, a.loudness, typed, a.save);
  if (!a.save.empty()) throw core::usage_error("a wave is a part of a run", "--save-config", "save the config of the whole run");
  pipeline::Plan plan = pipeline::make_plan(a.request);
  pipeline::Progress progress(a.loudness.voice());
  return print_outcome(pipeline::run_share(plan, progress, typed, pipeline::read_share(*a.wave, a.part)), plan, a.loudness);
}

int check(const Given& a) {
  const std::filesystem::path config = pipeline::find_config(a.request.config);
  if (pipeline::is_flight_plan(config)) {
    const planning::FlightPlan plan = pipeline::check_flight_plan({config, {}, {}, a.request.sets});
    if (!a.loudness.quiet) std::printf("%s: a flight of %s\n", a.request.config.c_str(), core::counted(plan.lines.size(), "line").c_str());
    return 0;
  }
  if (const auto block = check_block_config(config, a.request.sets)) {
    if (!a.loudness.quiet) std::printf("%s: %s\n", a.request.config.c_str(), block->c_str());
    return 0;
  }
  const pipeline::Plan plan = pipeline::make_plan(a.request);
  if (!plan.survey_file.empty()) pipeline::check_output(plan);
  for (const io::PointFile& f : plan.survey.points)
    if (io::is_address(f.file)) io::InputFile{f.file};  // opens it
  if (a.loudness.quiet) return 0;
  std::printf(
      "%s: %s\n", a.request.config.c_str(),
      plan.stages.size() == 1 ? "its only stage is complete" : (core::counted(plan.stages.size(), "stage") + " fit one another").c_str());
  if (plan.survey_file.empty())
    std::printf("no survey was named: its files are not checked\n");
  else
    std::printf("%s: complete; %zu laser, %zu trajectory, %zu IMU, %zu GNSS, %zu point files\n", plan.survey_file.c_str(),
                plan.survey.laser.size(), plan.survey.trajectory.size(), plan.survey.imu.size(), plan.survey.gnss.size(),
                plan.survey.points.size());
  return 0;
}

int explain(const Given& a) {
  pipeline::Plan plan = pipeline::make_plan(a.request);
  const pipeline::Explanation found = pipeline::explain(plan);
  a.json ? print_json(core::reported(found)) : print(pipeline::explanation_text(found));
  return 0;
}

}  // namespace

void add_pipeline_commands(Commands& commands) {
  const auto a = std::make_shared<Given>();
  auto* c = commands.add(
      "run",
      "Examples\n  swath run configs/survey.toml --survey demo/survey.toml --output out\n  swath run configs/survey.toml --survey "
      "demo/survey.toml --set run.memory=\"4 GB\" --threads 8 --json-log\n\nRun a pipeline on a survey; the same command continues a run "
      "that was killed.",
      [a, &commands] { return run(*a, commands.typed()); });
  add_request(*c, a->request);
  add_run_options(*c, a->request, a->loudness, a->save);
  c->add_option("--deliver", a->deliver, "Copy the finished products to an object store: s3://BUCKET/PREFIX");
  auto* wave = c->add_option("--wave", a->wave, "Do one wave of a run that several processes do together (`swath tasks` lists them)");
  c->add_option("--part", a->part, "Part of the wave, i/n: 2/8")->needs(wave);

  const auto checked = std::make_shared<Given>();
  c = commands.add("check",
                   "Examples\n  swath check configs/survey.toml --survey demo/survey.toml\n\nReport every fault of a config and its "
                   "survey, without reading data.",
                   [checked] { return check(*checked); });
  add_request(*c, checked->request);
  add_quiet(*c, checked->loudness.quiet);

  const auto explained = std::make_shared<Given>();
  c = commands.add("explain",
                   "Examples\n  swath explain configs/survey.toml --survey demo/survey.toml --set dtm.cell=\"50 cm\"\n\nShow every "
                   "effective option and where its value comes from.",
                   [explained] { return explain(*explained); });
  add_request(*c, explained->request);
  c->add_flag("--json", explained->json, "As JSON");
}

}  // namespace swath::tools
