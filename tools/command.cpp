// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/command.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <sstream>

#include "core/config/option.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/printable.h"
#include "io/text/value_file.h"
#include "pipeline/provenance.h"
#include "tools/usage_fault.h"

namespace swath::tools {
namespace {

/// Help that opens with examples; the overview shows of each command in its last sentence alone.
class HelpText : public CLI::Formatter {
 public:
  std::string make_subcommand(const CLI::App* c) const override {
    const std::string whole = c->get_description();
    const size_t blank = whole.rfind("\n\n");
    std::ostringstream out;
    CLI::detail::format_help(out, c->get_name(), blank == std::string::npos ? whole : whole.substr(blank + 2), column_width_);
    return out.str();
  }
};

constexpr const char* overview =
    "Examples\n"
    "  swath demo                                            a simulated survey, its products and their errors\n"
    "  swath dtm flight.laz --cell 50cm --contours 1m        terrain model and contours of a point cloud\n"
    "  swath run survey --survey lech/survey.toml -o out     raw records to products, by a config of the program's own\n"
    "  swath info flight.laz                                 what a file holds, and what looks wrong in it\n"
    "  swath stages filters.smrf                             a stage and its options\n"
    "\n"
    "swath: raw records of an airborne laser survey in; georeferenced, classified points, terrain model and contours out.\n";

}  // namespace

Commands::Commands() : app_(overview, "swath") {
  app_.set_version_flag("--version", "swath " + std::string(pipeline::program_version()));
  app_.require_subcommand(1);
  app_.formatter(std::make_shared<HelpText>());
  app_.footer("Exit codes: 0 done, 1 bad data, 2 bad usage or config, 3 done but a quality limit set in the config was missed.");
}

CLI::App* Commands::add(const std::string& name, const std::string& help, std::function<int()> call) {
  CLI::App* command = app_.add_subcommand(name, help);
  calls_.emplace_back(command, std::move(call));
  return command;
}

int Commands::call(int argc, char** argv) {
  const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  typed_ = "swath";
  for (const std::string& word : words) typed_ += " " + word;
  try {
    return parse_and_call(argc, argv, words);
  } catch (const core::Error& e) {
    // Of the command line or a word of it: other errors have hints of their own.
    const bool is_typed = e.where().starts_with("swath ") || std::find(words.begin(), words.end(), e.where()) != words.end();
    const std::string hint = e.code() == core::Exit::bad_usage && (is_typed || e.hint().empty()) ? split_quantity_hint(words) : "";
    if (hint.empty()) throw;
    throw core::Error(e.what(), e.where(), hint, e.code());
  }
}

int Commands::parse_and_call(int argc, char** argv, const std::vector<std::string>& words) {
  try {
    app_.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app_.exit(e);
    throw usage_fault(app_, e, words);
  }
  const CLI::App* given = app_.get_subcommands().front();
  for (const auto& [command, function] : calls_)
    if (command == given) return function();
  return 0;
}

CLI::Validator threads_check() {
  return CLI::Validator(
      [](std::string& text) -> std::string {
        int n = 0;
        const auto [end, bad] = std::from_chars(text.data(), text.data() + text.size(), n);
        if (bad == std::errc() && end == text.data() + text.size() && n >= 0 && n <= core::max_threads) return {};
        return "'" + text + "' is not a number of threads: 1 to " + std::to_string(core::max_threads) + ", or 0 for one per processor";
      },
      "");
}

CLI::Validator name_check() {
  return CLI::Validator([](std::string& text) -> std::string { return text.empty() ? "the name is empty" : ""; }, "");
}

CLI::Option* add_output(CLI::App& c, std::filesystem::path& folder, const std::string& text) {
  return c.add_option("-o,--output", folder, text)->check(name_check());
}

void add_quiet(CLI::App& c, bool& quiet) { c.add_flag("--quiet", quiet, "Nothing but errors"); }

void add_request(CLI::App& c, pipeline::Request& request) {
  c.add_option("CONFIG", request.config, "Pipeline, .toml or .json, or the name of one that comes with the program")->required();
  c.add_option("--survey", request.survey, "survey.toml, in place of the config's");
  add_output(c, request.output, "Folder of the products, in place of the config's");
  c.add_option("--set", request.sets, "One option of one stage: dtm.cell=\"50 cm\", run.tile=\"250 m\"")->allow_extra_args(false);
}

void add_run_options(CLI::App& c, pipeline::Request& request, Loudness& loudness, std::filesystem::path& save) {
  c.add_option("--threads", request.threads, "Threads, in place of the config's (0: one per processor)")->check(threads_check());
  c.add_option("--save-config", save, "Write what is run as a config for `swath run`: NAME.toml");
  add_quiet(c, loudness.quiet);
  c.add_flag("--json-log", loudness.json_log, "Progress as one JSON object per line on standard error");
}

void print(const std::string& text) { std::fputs(core::printable(text).c_str(), stdout); }
void print_json(const core::Value& value) { std::fputs(io::to_json(value).c_str(), stdout); }

double quantity(core::Dimension dimension, const std::string& text, const std::string& option, const std::string& example) {
  std::string fault;
  const auto value = core::read_scalar({core::Kind::quantity, dimension}, text, fault);
  if (!value) throw core::usage_error("'" + text + "': " + fault, option, "write it with its unit: \"" + example + "\"");
  return value->as_number();
}

}  // namespace swath::tools
