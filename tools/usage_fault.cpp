// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/usage_fault.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <optional>
#include <string_view>

#include "core/config/units.h"
#include "core/config/value.h"
#include "io/las/las_ending.h"
#include "pipeline/jobs/config_folder.h"

namespace swath::tools {
namespace {

using Words = std::vector<std::string>;

/// What other programs and the craft call a job, and what does it here.
struct OtherWord {
  std::string_view word, hint;
};
constexpr std::array<OtherWord, 29> other_words{{
    {"contour", "`swath dtm CLOUD --contours 1m` makes contours"},
    {"contours", "`swath dtm CLOUD --contours 1m` makes contours"},
    {"dem", "`swath dtm CLOUD` makes a terrain model"},
    {"terrain", "`swath dtm CLOUD` makes a terrain model"},
    {"grid", "`swath dtm CLOUD` makes a terrain model"},
    {"dsm", "the stage terrain.dsm makes a surface model: `swath stages terrain.dsm`"},
    {"chm", "`swath run forest --survey survey.toml` makes a canopy height model"},
    {"ground", "`swath classify CLOUD` classifies ground"},
    {"classification", "`swath classify CLOUD` classifies points"},
    {"denoise", "`swath classify CLOUD` classifies noise"},
    {"convert", "`swath copc CLOUD` writes COPC; `swath run CONFIG` with a writer of `swath stages` writes other formats"},
    {"translate", "`swath copc CLOUD` writes COPC; `swath run CONFIG` with a writer of `swath stages` writes other formats"},
    {"export", "`swath copc CLOUD` writes COPC; `swath run CONFIG` with a writer of `swath stages` writes other formats"},
    {"pipeline", "`swath run CONFIG` runs a pipeline"},
    {"process", "`swath run survey --survey survey.toml` makes the products of a survey"},
    {"georeference", "`swath run survey --survey survey.toml` makes the products of a survey"},
    {"boresight", "`swath run calibrate --survey survey.toml` estimates the calibration"},
    {"calibration", "`swath run calibrate --survey survey.toml` estimates the calibration"},
    {"trajectory", "`swath run survey --survey survey.toml` computes the trajectory first"},
    {"new", "`swath init` writes a survey.toml for a folder of records"},
    {"create", "`swath init` writes a survey.toml for a folder of records"},
    {"ortho", "`swath orthophoto CLOUD` makes orthophotos"},
    {"orthophotos", "`swath orthophoto CLOUD` makes orthophotos"},
    {"colorize", "`swath colour CLOUD` gives points the colours of photographs"},
    {"color", "`swath colour CLOUD` gives points the colours of photographs"},
    {"quality", "`swath qc CLOUD` judges the quality of clouds"},
    {"validate", "`swath check CONFIG` checks a config and its survey; `swath qc CLOUD` judges clouds"},
    {"show", "`swath view FOLDER` shows products; `swath info FILE` says what a file holds"},
    {"section", "`swath profile` makes sections"},
}};

bool contains(const Words& list, const std::string& word) { return std::find(list.begin(), list.end(), word) != list.end(); }

bool is_number(std::string_view text) {
  double value = 0.0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  return fault == std::errc() && end == text.data() + text.size();
}

bool exists(const std::string& file) {
  std::error_code ec;
  return std::filesystem::exists(file, ec);
}

bool is_unit(const std::string& word) {
  const auto& all = core::units();
  return std::any_of(all.begin(), all.end(), [&](const core::Unit& u) { return u.name == word; });
}

/// Words that a command of CONFIG and --survey has no place for: nearly always the survey, or its data.
std::optional<core::Error> survey_without_option(const std::string& command, const CLI::App& c, const Words& words) {
  const Words left = c.remaining();
  if (left.empty() || c.get_option_no_throw("--survey") == nullptr) return std::nullopt;
  const std::string& file = left.front();
  if (file.empty() || file[0] == '-') return std::nullopt;
  const std::string where = "swath " + command, what = "'" + file + "' has no place after the config";
  const CLI::Option* config = c.get_option("CONFIG");
  const std::string name = config->count() > 0 ? config->as<std::string>() : "CONFIG";
  if (io::has_las_ending(file))
    return core::usage_error(what, where,
                             "point clouds are given to `swath dtm`, `swath classify` or `swath qc`; " + command +
                                 " takes a survey: --survey survey.toml with [[points]]");
  const bool is_tree = file.ends_with(".toml") || file.ends_with(".json");
  if (contains(words, "--survey"))
    return core::usage_error(what, where, "the survey is given by --survey; see swath " + command + " --help");
  return core::usage_error(what, where,
                           is_tree ? "name the survey by its option: swath " + command + " " + name + " --survey " + file
                                   : "records are named in a survey.toml, which is given by --survey; `swath init FOLDER` "
                                     "writes one");
}

}  // namespace

std::string command_hint(const std::string& word, const Words& commands, const Words& configs) {
  if (contains(configs, word)) return "it is a config: swath run " + word + " --survey survey.toml";
  for (const OtherWord& other : other_words)
    if (other.word == word) return std::string(other.hint);
  const std::string near = core::nearest(word, commands);
  if (!near.empty()) return "did you mean '" + near + "'?";
  const std::string config = core::nearest(word, configs);
  return config.empty() ? "see swath --help" : "did you mean the config '" + config + "': swath run " + config + " --survey survey.toml?";
}

std::string split_quantity_hint(const Words& words) {
  for (size_t k = 1; k + 1 < words.size(); ++k) {
    const std::string &option = words[k - 1], &value = words[k], &unit = words[k + 1];
    const size_t equals = value.rfind('=');
    const bool is_set = equals != std::string::npos;
    if (!option.starts_with("--") || !is_number(is_set ? value.substr(equals + 1) : value) || !is_unit(unit) || exists(unit)) continue;
    return "'" + option + " " + value + " " + unit + "' is a value and a word of its own: write " + option + " " + value + unit + " or " +
           option + " \"" + value + " " + unit + "\"";
  }
  return {};
}

core::Error usage_fault(const CLI::App& app, const CLI::ParseError& e, const Words& words) {
  Words names;
  for (const CLI::App* c : app.get_subcommands({})) names.push_back(c->get_name());
  const std::string first = words.empty() ? "" : words[0];
  const bool known = contains(names, first);
  if (known)
    if (const auto survey = survey_without_option(first, *app.get_subcommand(first), words)) return *survey;
  if (known || first.empty() || first[0] == '-')
    return core::usage_error(e.what(), known ? "swath " + first : "swath", known ? "see swath " + first + " --help" : "see swath --help");
  const Words configs = pipeline::config_names();
  if (configs.empty())  // as where the program's file alone was copied
    return core::usage_error("'" + first + "' is not a command, or one that needs the configs of the program, which are not found", "swath",
                             "they are in share/swath/configs beside the folder of the program; SWATH_CONFIGS names another folder");
  return core::usage_error("'" + first + "' is not a command", "swath", command_hint(first, names, configs));
}

}  // namespace swath::tools
