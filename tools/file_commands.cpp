// SPDX-License-Identifier: GPL-3.0-or-later
// Files: simulated surveys, what a file holds.
#include <cstdio>
#include <string>
#include <vector>

#include "core/config/result_visitors.h"
#include "io/survey/info.h"
#include "io/survey/tree_kind.h"
#include "io/text/value_file.h"
#include "pipeline/jobs/set_options.h"
#include "simulate/files/earlier_survey.h"
#include "simulate/simulate.h"
#include "tools/command.h"

namespace swath::tools {

simulate::Made make_survey(const std::filesystem::path& config, const std::vector<std::string>& sets, const std::filesystem::path& folder,
                           const Loudness& loudness) {
  core::Value given = config.empty() ? core::Value::object() : io::read_value_file(config);
  io::require_kind(given, io::TreeKind::simulation, config);
  for (const std::string& set : sets) pipeline::set_option(given, set);
  const simulate::Options options = simulate::read_options(given);
  const simulate::EarlierSurvey earlier(folder);
  pipeline::Progress progress(loudness.voice());
  progress.begin("simulate", 0, "");
  simulate::Made made = simulate::run(options, folder, [&](double share) { progress.share(share); });
  progress.end();
  std::vector<std::filesystem::path> inputs;
  for (const io::TrajectoryFile& f : options.flight.along) inputs.push_back(f.file);
  if (options.world.dem) inputs.push_back(*options.world.dem);
  std::string stale;
  for (const std::string& name : earlier.remove_stale(inputs)) stale += (stale.empty() ? "" : ", ") + name;
  if (!stale.empty()) progress.say("removed: files of the earlier simulation in this folder that this one does not write: " + stale);
  return made;
}

namespace {

struct SimulateArguments {
  std::filesystem::path config;
  std::vector<std::string> sets;
  std::string folder;
  Loudness loudness;
};

int simulate_survey(const SimulateArguments& a) {
  const simulate::Made made = make_survey(a.config, a.sets, a.folder, a.loudness);
  if (!a.loudness.quiet) print_json(core::reported(made));
  return 0;
}

struct InfoArguments {
  std::vector<std::string> names;
  bool json = false;
};

int info(const InfoArguments& a) {
  if (a.json && a.names.size() > 1) {
    core::Value all = core::Value::array();
    for (const std::string& name : a.names) all.push(io::describe_file(name));
    print_json(all);
    return 0;
  }
  for (size_t k = 0; k < a.names.size(); ++k) {
    const core::Value found = io::describe_file(a.names[k]);
    if (k > 0) print("\n");
    a.json ? print_json(found) : print(io::info_text(found));
  }
  return 0;
}

}  // namespace

void add_simulate_command(Commands& commands) {
  const auto a = std::make_shared<SimulateArguments>();
  auto* c = commands.add("simulate",
                         "Examples\n  swath simulate demo\n  swath simulate demo --set seed=7 --set flight.lines=2 --set "
                         "world.scene=forest\n\nMake the raw records of a survey whose truth is known.",
                         [a] { return simulate_survey(*a); });
  c->add_option("FOLDER", a->folder, "Folder to make the survey in")->required();
  c->add_option("--config", a->config, "Options of the simulation, .toml or .json");
  c->add_option("--set", a->sets, "One option of the simulation: seed=7, flight.speed=\"60 m/s\"")->allow_extra_args(false);
  add_quiet(*c, a->loudness.quiet);
}

void add_info_command(Commands& commands) {
  const auto a = std::make_shared<InfoArguments>();
  auto* c = commands.add(
      "info",
      "Examples\n  swath info flight.laz\n  swath info trajectory.sbet --json\n\nReport what files hold (points, trajectories, "
      "raw records, RINEX, PCAP, rasters, GeoPackage, DXF, JSON), and what looks wrong.",
      [a] { return info(*a); });
  c->add_option("FILE", a->names, "Files; of several --json gives a list")->required();
  c->add_flag("--json", a->json, "As JSON");
}

}  // namespace swath::tools
