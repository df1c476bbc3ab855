// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>
#include <sstream>
#include <thread>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "core/config/option_visitors.h"
#include "core/config/result_visitors.h"
#include "core/error.h"
#include "core/printable.h"
#include "io/survey/info.h"
#include "io/text/value_file.h"
#include "pipeline/describe.h"
#include "pipeline/flight_plan/budget.h"
#include "pipeline/flight_plan/plan_files.h"
#include "pipeline/input_guard.h"
#include "pipeline/limits.h"
#include "pipeline/plan.h"
#include "pipeline/profile.h"
#include "pipeline/provenance.h"
#include "pipeline/run.h"
#include "pipeline/summary.h"
#include "pipeline/volume_files.h"
#include "simulate/simulate.h"

namespace {

using namespace swath;

/// For a person: texts of files as a terminal can show them.
void print(const std::string& text) { std::fputs(core::printable(text).c_str(), stdout); }
void print_json(const core::Value& v) { std::fputs(io::to_json(v).c_str(), stdout); }

struct Arguments {
  pipeline::Request request;
  pipeline::VolumeRequest volumes;
  pipeline::ProfileRequest profile;
  pipeline::PlanRequest plan;
  pipeline::BudgetRequest budget;
  std::vector<std::string> angles{"0 deg", "20 deg"};
  std::string name, folder, scene, width = "1 m", speed = "60 m/s";
  bool quiet = false, json_log = false, json = false, check = false;

  pipeline::Voice voice() const { return json_log ? pipeline::Voice::json : quiet ? pipeline::Voice::quiet : pipeline::Voice::bar; }
};

int run(Arguments& a, const std::string& command) {
  pipeline::Plan plan = pipeline::make_plan(a.request);
  pipeline::Progress progress(a.voice());
  const pipeline::Outcome outcome = pipeline::run(plan, progress, command);
  if (!a.quiet && !a.json_log) print(pipeline::summary(outcome.report, plan.run.output));
  if (outcome.code == core::Exit::quality_missed)
    for (const pipeline::Warning& w : pipeline::missed_limits(*outcome.report.find("limits")))
      std::fprintf(stderr, "swath: done, but a quality limit was missed: %s\n", core::printable(w.text).c_str());
  return static_cast<int>(outcome.code);
}

int check(Arguments& a) {
  if (pipeline::is_flight_plan(a.request.config)) {
    const planning::FlightPlan plan = pipeline::check_flight_plan({a.request.config, {}, {}, a.request.sets});
    if (!a.quiet) std::printf("%s: a flight of %zu lines\n", a.request.config.c_str(), plan.lines.size());
    return 0;
  }
  const pipeline::Plan plan = pipeline::make_plan(a.request);
  if (!plan.survey_file.empty()) pipeline::check_output(plan);
  if (a.quiet) return 0;
  std::printf("%s: %zu stages fit one another\n", a.request.config.c_str(), plan.stages.size());
  if (plan.survey_file.empty())
    std::printf("no survey was named: its files are not checked\n");
  else
    std::printf("%s: complete; %zu laser, %zu trajectory, %zu IMU, %zu GNSS, %zu point files\n", plan.survey_file.c_str(),
                plan.survey.laser.size(), plan.survey.trajectory.size(), plan.survey.imu.size(), plan.survey.gnss.size(),
                plan.survey.points.size());
  return 0;
}

int explain(Arguments& a) {
  pipeline::Plan plan = pipeline::make_plan(a.request);
  const pipeline::Explanation found = pipeline::explain(plan);
  a.json ? print_json(core::reported(found)) : print(pipeline::explanation_text(found));
  return 0;
}

int simulate_survey(Arguments& a) {
  core::Value given = a.request.config.empty() ? core::Value::object() : io::read_value_file(a.request.config);
  for (const std::string& set : a.request.sets) pipeline::set_option(given, set);
  const simulate::Options options = simulate::read_options(given);
  pipeline::Progress progress(a.voice());
  progress.begin("simulate", 1000, "per mille");
  std::uint64_t told = 0;
  const simulate::Made made = simulate::run(options, a.folder, [&](double share) {
    const auto now = static_cast<std::uint64_t>(share * 1000);
    if (now > told) progress.advance(now - told);
    told = std::max(told, now);
  });
  progress.end();
  if (!a.quiet) std::fputs(io::to_json(core::reported(made)).c_str(), stdout);
  return 0;
}

int info(const Arguments& a) {
  const core::Value found = io::describe_file(a.name);
  a.json ? print_json(found) : print(io::info_text(found));
  return 0;
}

int volumes(const Arguments& a) {
  if (a.volumes.after.empty() == !a.volumes.design)
    throw core::usage_error("volumes need a second surface or a design height", "swath volumes", "give AFTER or --design, one of them");
  const pipeline::VolumesFound found = pipeline::volumes_of(a.volumes);
  a.json ? print_json(core::reported(found)) : print(pipeline::volume_text(found));
  return 0;
}

/// A number with its unit from the command line; `example`: one that would do.
double quantity(core::Dimension d, const std::string& text, const std::string& option, const std::string& example) {
  std::string fault;
  const auto value = core::read_scalar({core::Kind::quantity, d}, text, fault);
  if (!value) throw core::usage_error("'" + text + "': " + fault, option, "write it with its unit: \"" + example + "\"");
  return value->as_number();
}

int profile(Arguments& a) {
  a.profile.half_width = quantity(core::Dimension::length, a.width, "--half-width", "2 m");
  if (!(a.profile.half_width > 0.0))
    throw core::usage_error("'" + a.width + "' is no width", "--half-width", "write a length with its unit: \"2 m\"");
  core::Value list = core::Value::array();
  for (const pipeline::ProfileFound& one : pipeline::write_profiles(a.profile)) {
    list.push(core::reported(one));
    if (a.json || a.quiet) continue;
    std::printf("%s: %.1f long, %zu points, %zu places of the terrain model; .csv, .svg and .png in %s\n", one.name.c_str(), one.length,
                one.points, one.terrain_samples, a.profile.folder.c_str());
    if (one.vertices_left_out > 0)
      std::printf("  %zu of its vertices are not finite or beyond every map, left out\n", one.vertices_left_out);
  }
  if (a.json) print_json(list);
  return 0;
}

int plan_flight(const Arguments& a) {
  const planning::FlightPlan plan = pipeline::write_flight_plan(a.plan);
  if (a.quiet) return 0;
  a.json ? print_json(core::reported(plan)) : print(pipeline::plan_text(plan));
  return 0;
}

int budget(Arguments& a) {
  a.budget.height = quantity(core::Dimension::length, a.width, "--height", "600 m");
  a.budget.speed = quantity(core::Dimension::speed, a.speed, "--speed", "60 m/s");
  a.budget.angles.clear();
  for (const std::string& angle : a.angles) a.budget.angles.push_back(quantity(core::Dimension::angle, angle, "--angle", "20 deg"));
  const pipeline::BudgetTable table = pipeline::budget_of(a.budget);
  a.json ? print_json(core::reported(table)) : print(pipeline::budget_text(table));
  return 0;
}

int docs(const Arguments& a) {
  const auto differing = pipeline::write_docs(a.folder, a.check);
  for (const auto& page : differing) std::printf("%s %s\n", a.check ? "out of date:" : "written:", page.c_str());
  return a.check && !differing.empty() ? static_cast<int>(core::Exit::bad_data) : 0;
}

/// Help that opens with examples; the overview shows of each command in its last sentence alone.
class HelpText : public CLI::Formatter {
 public:
  std::string make_subcommand(const CLI::App* c) const override {
    const std::string told = c->get_description();
    const size_t blank = told.rfind("\n\n");
    std::ostringstream out;
    CLI::detail::format_help(out, c->get_name(), blank == std::string::npos ? told : told.substr(blank + 2), column_width_);
    return out.str();
  }
};

/// A fault of the command line in the form of every other error.
core::Error usage_fault(const CLI::App& app, const CLI::ParseError& e, int argc, char** argv) {
  std::vector<std::string> names;
  for (const CLI::App* c : app.get_subcommands({})) names.push_back(c->get_name());
  const std::string first = argc > 1 ? argv[1] : "";
  const bool known = std::find(names.begin(), names.end(), first) != names.end();
  if (known || first.empty() || first[0] == '-')
    return core::usage_error(e.what(), known ? "swath " + first : "swath", known ? "see swath " + first + " --help" : "see swath --help");
  const std::string near = core::nearest(first, names);
  return core::usage_error("'" + first + "' is no command", "swath", near.empty() ? "see swath --help" : "did you mean '" + near + "'?");
}

void add_request(CLI::App* c, Arguments& a) {
  c->add_option("CONFIG", a.request.config, "Pipeline, .toml or .json")->required();
  c->add_option("--survey", a.request.survey, "survey.toml, in place of the config's");
  c->add_option("--output", a.request.output, "Folder of the products, in place of the config's");
  c->add_option("--set", a.request.sets, "One option of one stage: dtm.cell=\"50 cm\", run.tile=\"250 m\"")->allow_extra_args(false);
}

void add_pipeline_commands(CLI::App& app, Arguments& a) {
  auto* c = app.add_subcommand(
      "run",
      "Examples\n  swath run configs/survey.toml --survey demo/survey.toml --output out\n  swath run configs/survey.toml --survey "
      "demo/survey.toml --set run.memory=\"4 GB\" --threads 8 --json-log\n\nRun a pipeline on a survey; the same command continues a run "
      "that was killed.");
  add_request(c, a);
  c->add_option("--threads", a.request.threads, "Threads, in place of the config's (0: one per processor)");
  c->add_flag("--quiet", a.quiet, "Nothing but errors");
  c->add_flag("--json-log", a.json_log, "Progress as one JSON object per line on standard error");

  c = app.add_subcommand("check",
                         "Examples\n  swath check configs/survey.toml --survey demo/survey.toml\n\nReport every fault of a config and its "
                         "survey, without reading data.");
  add_request(c, a);
  c->add_flag("--quiet", a.quiet, "Nothing but faults");

  c = app.add_subcommand("explain",
                         "Examples\n  swath explain configs/survey.toml --survey demo/survey.toml --set dtm.cell=\"50 cm\"\n\nShow every "
                         "effective option and where its value comes from.");
  add_request(c, a);
  c->add_flag("--json", a.json, "As JSON");
}

void add_list_commands(CLI::App& app, Arguments& a) {
  auto* c = app.add_subcommand("stages", "Examples\n  swath stages\n  swath stages filters.smrf\n\nList the stages, or describe one.");
  c->add_option("NAME", a.name, "Stage");

  c = app.add_subcommand("warnings",
                         "Examples\n  swath warnings\n  swath warnings limit.voids\n\nList the codes of warnings, or explain one.");
  c->add_option("CODE", a.name, "Code of a warning");

  app.add_subcommand("schema", "Examples\n  swath schema > swath.schema.json\n\nPrint the JSON Schema of pipelines and surveys.");
}

void add_survey_commands(CLI::App& app, Arguments& a) {
  auto* c = app.add_subcommand(
      "plan",
      "Examples\n  swath plan configs/flight/plan.toml --output plan\n  swath plan flight.toml --dem terrain.tif --output "
      "plan --set flight.speed=\"60 m/s\"\n\nPlan a flight over an area: lines, density, accuracy, time and cost.");
  c->add_option("PLAN", a.plan.config, "What is asked of the flight, .toml or .json")->required();
  c->add_option("--dem", a.plan.dem, "Terrain model, in place of the config's");
  c->add_option("--output", a.plan.folder, "Folder to write to")->required();
  c->add_option("--set", a.plan.sets, "One option of the plan: flight.speed=\"60 m/s\"")->allow_extra_args(false);
  c->add_flag("--quiet", a.quiet, "Nothing but errors");
  c->add_flag("--json", a.json, "The plan as JSON");

  c = app.add_subcommand("budget",
                         "Examples\n  swath budget demo/survey.toml --height \"600 m\" --angle \"0 deg\" --angle \"20 deg\" --slope "
                         "0.1\n\nShow the errors of a survey's points by source, from its own sigmas.");
  c->add_option("SURVEY", a.budget.survey, "survey.toml")->required();
  c->add_option("--height", a.width, "Above the ground")->required();
  c->add_option("--angle", a.angles, "Scan angle; may be given more than once")->allow_extra_args(false)->capture_default_str();
  c->add_option("--speed", a.speed, "Over the ground: errors of time move a point along the track")->capture_default_str();
  c->add_option("--slope", a.budget.slope, "Of the ground across the track, rise / run")->capture_default_str();
  c->add_option("--penetration", a.budget.penetration, "Share of the pulses that reach the ground under trees")
      ->check(CLI::Range(0.0, 1.0));
  c->add_flag("--json", a.json, "As JSON");

  c = app.add_subcommand("simulate",
                         "Examples\n  swath simulate demo\n  swath simulate demo --set seed=7 --set flight.lines=2 --set "
                         "world.scene=forest\n\nMake the raw records of a survey whose truth is known.");
  c->add_option("FOLDER", a.folder, "Folder to make the survey in")->required();
  c->add_option("--config", a.request.config, "Options of the simulation, .toml or .json");
  c->add_option("--set", a.request.sets, "One option of the simulation: seed=7, flight.speed=\"60 m/s\"")->allow_extra_args(false);
  c->add_flag("--quiet", a.quiet, "Nothing but errors");

  c = app.add_subcommand(
      "info",
      "Examples\n  swath info flight.laz\n  swath info trajectory.sbet --json\n\nReport what a file holds (points, trajectories, "
      "raw records, RINEX, PCAP, rasters, GeoPackage, DXF, JSON), and what looks wrong.");
  c->add_option("FILE", a.name, "File")->required();
  c->add_flag("--json", a.json, "As JSON");
}

void add_product_commands(CLI::App& app, Arguments& a) {
  auto* c = app.add_subcommand(
      "volumes",
      "Examples\n  swath volumes may/dtm.vrt june/dtm.vrt --polygon pit.gpkg\n  swath volumes out/dtm.vrt --design 412.5 "
      "--json\n\nCut and fill between two terrain models, or from one to a design height, with sigma.");
  c->add_option("BEFORE", a.volumes.before, "Terrain model, GeoTIFF or VRT; NAME_quality beside it gives sigma")->required();
  c->add_option("AFTER", a.volumes.after, "The same later; its cells may be others");
  c->add_option("--design", a.volumes.design, "Height in place of AFTER, in the unit of BEFORE's heights");
  c->add_option("--polygon", a.volumes.polygon, "Polygons or closed lines to count within, in the CRS of BEFORE");
  c->add_option("--correlation", a.volumes.correlation, "Of the errors of any two cells of a model: 1 one shift for all, 0 noise")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  c->add_flag("--json", a.json, "As JSON");

  c = app.add_subcommand(
      "profile",
      "Examples\n  swath profile out/products/points --dtm out/products/dtm.vrt --from 652010,5310020 --to 652340,5310200 "
      "--output sections\n  swath profile flight.laz --line axis.gpkg --half-width \"2 m\" --output sections\n\nSections "
      "through points and terrain model along lines, as CSV, SVG and PNG.");
  c->add_option("POINTS", a.profile.points, "LAS or LAZ files, or folders of them");
  c->add_option("--dtm", a.profile.dtm, "Terrain model, GeoTIFF or VRT");
  c->add_option("--line", a.profile.lines, "Lines to cut along: GeoPackage, GeoJSON, DXF ..., or .csv with profile,x,y");
  c->add_option("--from", a.profile.from, "x,y where one straight line begins");
  c->add_option("--to", a.profile.to, "x,y where it ends");
  c->add_option("--half-width", a.width, "Points up to this far from the line are shown")->capture_default_str();
  c->add_option("--output", a.profile.folder, "Folder to write to")->required();
  c->add_flag("--quiet", a.quiet, "Nothing but errors");
  c->add_flag("--json", a.json, "What was found, as JSON");

  c = app.add_subcommand(
      "docs", "Examples\n  swath docs docs\n  swath docs docs --check\n\nWrite the generated parts of the documentation's pages.");
  c->add_option("FOLDER", a.folder, "The docs folder")->required();
  c->add_flag("--check", a.check, "Write nothing; exit 1 where a page is out of date");
}

int command_line(int argc, char** argv) {
  Arguments a;
  CLI::App app(
      "Examples\n"
      "  swath simulate demo                                   a small survey with its truth, in demo/\n"
      "  swath run configs/survey.toml --survey demo/survey.toml --output out\n"
      "  swath run configs/survey.toml --survey demo/survey.toml --set dtm.cell=\"50 cm\"\n"
      "  swath info flight.laz                                 what a file holds, and what looks wrong in it\n"
      "  swath stages filters.smrf                             a stage and its options\n"
      "\n"
      "swath: raw records of an airborne laser survey in; georeferenced, classified points, terrain model and contours out.\n",
      "swath");
  app.set_version_flag("--version", "swath " + std::string(pipeline::program_version()));
  app.require_subcommand(1);
  app.formatter(std::make_shared<HelpText>());
  app.footer("Exit codes: 0 done, 1 bad data, 2 bad usage or config, 3 done but a quality limit set in the config was missed.");
  add_pipeline_commands(app, a);
  add_list_commands(app, a);
  add_survey_commands(app, a);
  add_product_commands(app, a);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);
    throw usage_fault(app, e, argc, argv);
  }
  std::string command = "swath";
  for (int i = 1; i < argc; ++i) command += std::string(" ") + argv[i];

  const std::string name = app.get_subcommands().front()->get_name();
  if (name == "run") return run(a, command);
  if (name == "check") return check(a);
  if (name == "explain") return explain(a);
  if (name == "warnings") return print(pipeline::warning_help(a.name)), 0;
  if (name == "plan") return plan_flight(a);
  if (name == "budget") return budget(a);
  if (name == "simulate") return simulate_survey(a);
  if (name == "info") return info(a);
  if (name == "volumes") return volumes(a);
  if (name == "profile") return profile(a);
  if (name == "docs") return docs(a);
  if (name == "stages") std::fputs(a.name.empty() ? pipeline::stage_list().c_str() : pipeline::stage_help(a.name).c_str(), stdout);
  if (name == "schema") std::fputs(io::to_json(pipeline::schema()).c_str(), stdout);
  return 0;
}

/// Columns and grids of one tile are freed as those of the next are made: pages kept need not be fetched and cleared again. One arena for
/// all threads of a small machine, so that what one has freed serves the others and hardly more is held than was needed at once.
void keep_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_ARENA_MAX, static_cast<int>(1 + std::thread::hardware_concurrency() / 4));
  mallopt(M_MMAP_THRESHOLD, 32 << 20);  // the most that glibc takes
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
#endif
}

}  // namespace

int main(int argc, char** argv) {
  // Writing past a limit fails like a full disk, with its error, and does not kill.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  keep_freed_memory();
  try {
    const int code = command_line(argc, argv);
    errno = 0;
    if (const bool failed = std::fflush(stdout) != 0; failed || std::ferror(stdout) != 0) {
      const std::string why = failed && errno ? std::string(": ") + std::strerror(errno) : "";
      throw swath::core::Error("cannot write to the standard output" + why, "", errno == ENOSPC ? "the disk is full" : "");
    }
    return code;
  } catch (const swath::core::Error& e) {
    std::fprintf(stderr, "swath: error: %s\n", swath::core::printable(swath::core::shortened(e.text())).c_str());
    return static_cast<int>(e.code());
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "swath: error: out of memory\n  hint: a smaller run.memory or run.tile needs less\n");
    return static_cast<int>(swath::core::Exit::bad_data);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "swath: error: %s\n", swath::core::printable(swath::core::shortened(e.what())).c_str());
    return static_cast<int>(swath::core::Exit::bad_data);
  }
}
