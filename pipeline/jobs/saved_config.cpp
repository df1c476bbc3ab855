// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/jobs/saved_config.h"

#include "core/error.h"
#include "io/text/output_file.h"
#include "io/text/toml_text.h"
#include "io/text/value_file.h"
#include "pipeline/provenance.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;
using core::Value;

void write_new(const fs::path& file, const std::string& text) {
  if (fs::exists(file) && (!fs::is_regular_file(file) || io::read_text_file(file) != text))
    throw core::usage_error("is there already and is another config", file.string(), "name another file, or remove it");
  io::write_text_file(file, text);
}

/// A command line on one line of a comment.
std::string comment_of(const std::string& typed) {
  std::string out = "# swath " + std::string(program_version()) + ": " + typed;
  for (char& c : out)
    if ((c >= 0 && c < ' ') || c == 0x7f) c = ' ';
  return out + "\n";
}

}  // namespace

Value config_of(const Plan& plan) {
  Value config = Value::object();
  config["run"] = plan.run_table;
  config["run"]["output"] = plan.run.output.string();
  if (plan.run.threads != RunOptions{}.threads) config["run"]["threads"] = plan.run.threads;
  config["stage"] = Value::array();
  for (const PlannedStage& s : plan.stages) {
    Value stage = Value::object();
    stage["type"] = s.stage->info().name;
    for (const auto& [key, value] : s.table.members()) stage[key] = value;
    config["stage"].push(std::move(stage));
  }
  return config;
}

void save_config(const Plan& plan, const fs::path& file, const std::string& typed) {
  Value config = config_of(plan);
  const std::string comment = comment_of(typed);
  if (plan.survey_tree) {
    const fs::path survey = fs::path(file).replace_extension(".survey.toml");
    write_new(survey, comment + io::to_toml(*plan.survey_tree));
    config["run"]["survey"] = survey.filename().string();
  } else if (!plan.survey_file.empty()) {
    config["run"]["survey"] = fs::absolute(plan.survey_file).lexically_normal().string();
  }
  write_new(file, comment + io::to_toml(config));
}

}  // namespace swath::pipeline
