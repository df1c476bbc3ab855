// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/describe.h"

#include "calib/block/block_findings.h"
#include "calib/block/block_theory.h"
#include "calib/block/station_drift.h"
#include "core/config/option_visitors.h"
#include "core/config/result_visitors.h"
#include "core/error.h"
#include "io/survey/hangar_file.h"
#include "io/survey/survey.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "pipeline/jobs/set_options.h"
#include "pipeline/plan.h"
#include "pipeline/report_docs.h"
#include "pipeline/warnings.h"
#include "planning/flight_plan.h"
#include "stages/registry.h"

namespace swath::pipeline {
namespace {

using stages::Stage;

std::string columns_text(core::ColumnSet set) {
  std::string out;
  for (int c = 0; c < core::column_count; ++c)
    if (set.has(static_cast<core::Column>(c))) out += (out.empty() ? "" : ", ") + std::string(core::name_of(static_cast<core::Column>(c)));
  return out;
}

std::string products_text(const std::vector<stages::Product>& products) {
  std::string out;
  for (const stages::Product p : products) out += (out.empty() ? "" : ", ") + std::string(name_of(p));
  return out;
}

std::string both(core::ColumnSet set, const std::vector<stages::Product>& products) {
  const std::string c = columns_text(set), p = products_text(products);
  if (c.empty() && p.empty()) return "nothing";
  if (c.empty()) return p;
  return (p.empty() ? "" : p + "; ") + "columns " + c;
}

std::string grains_text(const Stage& s) {
  std::string out;
  for (const stages::Grain g : s.info().grains) out += (out.empty() ? "" : ", ") + std::string(name_of(g));
  return out;
}

/// What it uses beside what it needs; nothing where that is nothing.
std::string used_by(const Stage& s, const std::string& head) {
  return s.info().uses_products.empty() ? std::string() : head + products_text(s.info().uses_products);
}

core::Describe describe_of(Stage& s) {
  return [&s](core::Visitor& v) { s.visit(v); };
}

std::string stage_page(Stage& s) {
  std::string out = std::string(s.info().summary) + "\n\n";
  out += "- works on: " + grains_text(s) + "\n- needs: " + both(s.info().needs, s.info().needs_products) +
         used_by(s, "\n- uses if present: ") + "\n- gives: " + both(s.info().gives, s.info().gives_products) + "\n\n";
  if (core::document_options(describe_of(s)).empty()) return out + "It has no options.\n";
  return out + core::option_table_markdown(describe_of(s));
}

/// Replaces what stands between the marks; a page without marks gets them at its end.
std::string with_generated(std::string page, const std::string& title, const std::string& text) {
  static const std::string begin = "<!-- generated -->\n", end = "<!-- end -->\n";
  if (page.empty()) page = "# " + title + "\n\n" + begin + end;
  size_t from = page.find(begin);
  size_t to = page.find(end);
  if (from == std::string::npos || to == std::string::npos || to < from) {
    page += "\n" + begin + end;
    from = page.find(begin);
    to = page.find(end);
  }
  from += begin.size();
  return page.replace(from, to - from, text);
}

}  // namespace

std::string stage_list() {
  size_t width = 0;
  for (const auto& e : stages::registry()) width = std::max(width, e.name.size());
  std::string out;
  for (const auto& e : stages::registry()) {
    const auto s = e.make();
    out += std::string(e.name) + std::string(width + 2 - e.name.size(), ' ') + std::string(s->info().summary) + "\n";
  }
  return out;
}

std::vector<std::string> stage_names() { return stages::stage_names(); }

std::vector<std::string> settable_options() {
  std::vector<std::string> out;
  const auto add = [&](const std::string& table, const core::Describe& d) {
    for (const core::OptionDoc& o : core::document_options(d))
      if (!o.is_table && o.path.find("[]") == std::string::npos) out.push_back(table + "." + o.path);
  };
  RunOptions run;
  add("run", core::described(run));
  for (const std::string& name : stage_names()) {
    const auto stage = stages::make_stage(name);
    add(name.substr(name.rfind('.') + 1), describe_of(*stage));
  }
  return out;
}

std::string stage_help(const std::string& name) {
  const auto s = stages::make_stage(name);
  if (!s) {
    std::string near;
    int fitting = 0;
    for (const std::string& one : stage_names())
      if (is_named(one, name)) near += (fitting++ ? "' or '" : "") + one;
    if (fitting == 1) return stage_help(near);
    if (fitting == 0) near = core::nearest(name, stage_names());
    throw core::usage_error("'" + name + "' is not a stage", "",
                            near.empty() ? "`swath stages` lists them" : "did you mean '" + near + "'?");
  }
  return std::string(s->info().name) + ": " + std::string(s->info().summary) + "\n\n  works on  " + grains_text(*s) + "\n  needs     " +
         both(s->info().needs, s->info().needs_products) + used_by(*s, "\n  uses      ") + "\n  gives     " +
         both(s->info().gives, s->info().gives_products) + "\n\nOptions\n" + core::option_table_text(describe_of(*s));
}

std::vector<std::filesystem::path> write_docs(const std::filesystem::path& docs, bool only_check) {
  std::vector<std::filesystem::path> differing;
  const auto page = [&](const std::filesystem::path& file, const std::string& title, const std::string& text) {
    const std::string before = std::filesystem::exists(file) ? io::read_text_file(file) : std::string();
    const std::string after = with_generated(before, title, text);
    if (before == after) return;
    differing.push_back(file);
    if (!only_check) io::write_text_file(file, after);
  };
  std::string index = "| stage | what it does |\n|---|---|\n";
  for (const auto& e : stages::registry()) {
    const auto s = e.make();
    const std::string name(e.name);
    page(docs / "stages" / (name + ".md"), "`" + name + "`", stage_page(*s));
    index += "| [`" + name + "`](" + name + ".md) | " + std::string(s->info().summary) + " |\n";
  }
  page(docs / "stages" / "README.md", "Stages", index);
  io::Survey survey;
  page(docs / "survey.md", "survey.toml", core::option_table_markdown(core::described(survey)));
  io::HangarSurvey hangar;
  page(docs / "lever-arm.md", "hangar.toml", core::option_table_markdown(core::described(hangar)));
  page(docs / "report.md", "report.json", report_page());
  page(docs / "warnings.md", "Warnings", warning_page());
  planning::PlanOptions plan;
  const planning::FlightPlan flight;
  page(docs / "planning.md", "Flight planning",
       "### Options of plan.toml\n\n" + core::option_table_markdown(core::described(plan)) + "\n### Keys of plan.json\n\n" +
           core::result_table_markdown(core::described_results(flight)));
  calib::TheoryOptions theory;
  const calib::TheoryTable theory_found;
  const calib::DriftFound drift_found;
  calib::BlockConfig block;
  const calib::BlockFound block_found;
  page(docs / "block.md", "Blocks of images",
       "### Options of a block\n\n" + core::option_table_markdown(core::described(block)) + "\n### Keys of block.json\n\n" +
           core::result_table_markdown(core::described_results(block_found)) + "\n### Options of a theory file\n\n" +
           core::option_table_markdown(core::described(theory)) + "\n### Keys of `block-theory --json`\n\n" +
           core::result_table_markdown(core::described_results(theory_found)) + "\n### Keys of `block-drift --json`\n\n" +
           core::result_table_markdown(core::described_results(drift_found)));
  RunOptions run;
  page(docs / "run.md", "[run]", core::option_table_markdown(core::described(run)));
  return differing;
}

core::Value schema() {
  using core::Value;
  const auto table = [](Value::Object members) { return Value(std::move(members)); };
  Value any = Value::array();
  for (const auto& e : stages::registry()) {
    const auto stage = e.make();
    Value one = core::schema_of([&](core::Visitor& v) { stage->visit(v); });
    Value& options = *one.find("properties");
    options.members().emplace_back("type", table({{"const", e.name}}));
    one.members().emplace_back("required", Value(Value::Array{"type"}));
    one.members().emplace_back("description", stage->info().summary);
    any.push(std::move(one));
  }
  RunOptions run;
  io::Survey survey;
  Value stages = table({{"type", "array"}, {"items", table({{"anyOf", std::move(any)}})}});
  return table({{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                {"title", "swath pipeline"},
                {"type", "object"},
                {"additionalProperties", false},
                {"required", Value(Value::Array{"stage"})},
                {"properties", table({{"run", core::schema_of(core::described(run))}, {"stage", std::move(stages)}})},
                {"$defs", table({{"survey", core::schema_of(core::described(survey))}, {"report", report_schema()}})}});
}

}  // namespace swath::pipeline
