// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/summary.h"

#include <algorithm>
#include <cstdio>

#include "io/las/las_box.h"
#include "io/text/value_file.h"
#include "pipeline/limits.h"
#include "pipeline/progress.h"
#include "pipeline/report_docs.h"

namespace swath::pipeline {
namespace {

using core::Value;

std::string scalar(const Value& v) {
  if (v.is_text()) return v.as_text();
  if (v.is_number() && !v.is_int()) {
    char buf[32];
    std::snprintf(buf, sizeof buf, "%.4g", v.as_number());
    return buf;
  }
  std::string text = io::to_json(v);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

/// The findings of a stage, those with a declaration as it says: in its unit, and no details.
class FindingsText {
 public:
  explicit FindingsText(std::string_view stage) : declared_(declared_findings(stage)) {}

  std::string of(const Value& tables, const std::string& margin, const std::string& path = {}) const {
    std::string out;
    for (const auto& [key, value] : tables.members()) {
      const std::string at = path.empty() ? key : path + "." + key;
      if (value.is_object()) {
        const std::string inner = of(value, margin + "  ", at);
        if (!inner.empty()) out += margin + key + "\n" + inner;
        continue;
      }
      const auto known = declared_.find(at);
      if (known != declared_.end() && known->second.form.audience == core::Audience::detail) continue;
      const bool is_figure = known != declared_.end() && value.is_number();
      out += margin + key + ": " + (is_figure ? core::shown(value, known->second.form) : scalar(value)) + "\n";
    }
    return out;
  }

 private:
  std::map<std::string, core::ResultDoc> declared_;
};

void options(const Value& table, const std::string& path, std::string& out) {
  for (const auto& [key, value] : table.members()) {
    const std::string name = path.empty() ? key : path + "." + key;
    const Value* from = value.find("from");
    if (value.is_object() && (!from || !value.find("value"))) {
      options(value, name, out);
      continue;
    }
    std::string line = "  " + name + " = " + (value.find("value") ? scalar(*value.find("value")) : "");
    line.resize(std::max<size_t>(line.size() + 2, 46), ' ');
    out += line + from->as_text() + "\n";
  }
}

/// A line for each example, and one for those that the report counts without.
void box_warnings(const Value& wrong, std::string& out) {
  const auto& examples = wrong.find("examples")->items();
  for (const Value& example : examples) out += "\nwarning: " + example.as_text() + "\n";
  const auto more = wrong.find("count")->as_int() - static_cast<std::int64_t>(examples.size());
  if (more > 0) out += "\nwarning: and " + std::to_string(more) + " more " + io::wrong_box + ": report.json\n";
}

}  // namespace

std::string summary(const Value& report, const std::filesystem::path& output) {
  std::string out = "\n";
  for (const Value& stage : report.find("stages")->items()) {
    out += stage.find("type")->as_text();
    if (const Value* counts = stage.find("counts")) {
      const auto in = counts->find("in")->as_int(), gone = counts->find("out")->as_int();
      out += ": " + std::to_string(in) + (in == gone ? " points" : " in, " + std::to_string(gone) + " out");
    }
    out += "\n";
    if (const Value* tally = stage.find("tally"))
      for (const auto& [what, one] : tally->members()) {
        out += "    " + what + ": " + std::to_string(one.find("count")->as_int());
        if (const Value* examples = one.find("examples")) out += "  (" + examples->items().front().as_text() + ")";
        out += "\n";
      }
    if (const Value* findings = stage.find("findings")) out += FindingsText(stage.find("type")->as_text()).of(*findings, "    ");
  }
  if (const Value* resumed = report.find("pieces_resumed"); resumed && resumed->as_int() > 0)
    out += "\nresumed: " + std::to_string(resumed->as_int()) + " pieces were done by an earlier run\n";
  for (const Value& stage : report.find("stages")->items())
    if (const Value* tally = stage.find("tally"))
      if (const Value* wrong = tally->find(io::wrong_box)) box_warnings(*wrong, out);
  if (const Value* geometry = report.find("geometry"))
    for (const Value& warning : geometry->find("warnings")->items()) out += "\nwarning: " + warning.as_text() + "\n";
  if (const Value* limits = report.find("limits"))
    for (const std::string& limit : missed_limits(*limits)) out += "\nlimit missed: " + limit + "\n";
  out += "\nproducts in " + output.generic_string() + ", report in " + (output / "report.json").generic_string() + " (" +
         duration_text(report.find("seconds")->as_number()) + ")\n";
  return out;
}

core::Error with_geometry(const core::Error& e, const Value* geometry, const std::vector<std::filesystem::path>& inputs) {
  const auto is_within = [&](const std::filesystem::path& file) {
    return e.where().starts_with(file.string()) || e.where().starts_with(file.filename().string());
  };
  if (e.code() != core::Exit::bad_data || std::any_of(inputs.begin(), inputs.end(), is_within)) return e;
  const Value* named = geometry ? geometry->find("named") : nullptr;
  const Value* warnings = geometry ? geometry->find("warnings") : nullptr;
  if (!named || named->items().empty() || !warnings || warnings->items().empty()) return e;
  // The sentences of what is named stand last.
  const size_t count = std::min(named->items().size(), warnings->items().size());
  std::string hint = e.hint();
  for (size_t k = warnings->items().size() - count; k < warnings->items().size(); ++k)
    hint += (hint.empty() ? "" : "; ") + std::string("quality.geometry: ") + warnings->items()[k].as_text();
  return core::Error(e.what(), e.where(), hint, e.code());
}

std::string explanation_text(const Value& explanation) {
  std::string out = "[run]\n";
  options(*explanation.find("run"), "", out);
  for (const Value& stage : explanation.find("stages")->items()) {
    out += "\n[[stage]] " + stage.find("type")->as_text() + "\n";
    options(*stage.find("options"), "", out);
  }
  return out;
}

}  // namespace swath::pipeline
