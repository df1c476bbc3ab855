// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/summary.h"

#include <algorithm>
#include <cstdio>

#include "core/config/units.h"
#include "io/text/value_file.h"
#include "pipeline/progress.h"
#include "pipeline/report_docs.h"
#include "pipeline/report_warnings.h"

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

constexpr size_t tables_shown = 6;  // of a list; the report has them all

/// The findings of a stage, those with a declaration as it says: in its unit, and no details.
class FindingsText {
 public:
  explicit FindingsText(std::string_view stage) : declared_(declared_findings(stage)) {}

  std::string of(const Value& tables, const std::string& margin, const std::string& path = {}) const {
    std::string out;
    for (const auto& [key, value] : tables.members()) {
      if (value.is_array() && value.items().empty()) continue;
      const std::string at = path.empty() ? key : path + "." + key;
      if (value.is_object()) {
        const std::string inner = of(value, margin + "  ", at);
        if (!inner.empty()) out += margin + key + "\n" + inner;
      } else if (is_list_of_tables(value)) {
        out += list(value, key, margin, at + "[]");
      } else if (!is_detail(at)) {
        out += margin + key + ":" + figure(value, at, margin + "  ") + "\n";
      }
    }
    return out;
  }

 private:
  static bool is_list_of_tables(const Value& v) { return v.is_array() && !v.items().empty() && v.items()[0].is_object(); }
  static bool is_list_of_numbers(const Value& v) {
    return v.is_array() && std::ranges::all_of(v.items(), [](const Value& one) { return one.is_number(); });
  }
  bool is_detail(const std::string& at) const {
    const auto known = declared_.find(at);
    return known != declared_.end() && known->second.form.audience == core::Audience::detail;
  }
  /// A text of several lines starts on a line of its own.
  std::string figure(const Value& v, const std::string& at, const std::string& margin) const {
    const auto known = declared_.find(at);
    if (known != declared_.end() && v.is_number()) return " " + core::shown(v, known->second.form);
    if (known != declared_.end() && is_list_of_numbers(v)) {
      std::string row;
      for (const Value& one : v.items()) row += (row.empty() ? " " : ", ") + core::shown(one, known->second.form);
      return row;
    }
    std::string text = scalar(v);
    if (!v.is_text() || text.find('\n') == std::string::npos) return " " + text;
    if (text.back() == '\n') text.pop_back();
    for (size_t k = text.find('\n'); k != std::string::npos; k = text.find('\n', k + 1)) text.insert(k + 1, margin);
    return "\n" + margin + text;
  }
  /// A line for each table: its figures that are no details.
  std::string list(const Value& tables, const std::string& key, const std::string& margin, const std::string& at) const {
    std::string out;
    const size_t count = tables.items().size();
    for (size_t k = 0; k < std::min(count, tables_shown); ++k) {
      std::string line;
      for (const auto& [name, value] : tables.items()[k].members())
        if (!value.is_object() && !is_list_of_tables(value) && !is_detail(at + "." + name))
          line += (line.empty() ? "" : ", ") + name + figure(value, at + "." + name, "");
      if (!line.empty()) out += margin + "  " + line + "\n";
    }
    if (out.empty()) return {};
    if (count > tables_shown) out += margin + "  and " + std::to_string(count - tables_shown) + " more: report.json\n";
    return margin + key + "\n" + out;
  }

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
    out += "\nresumed: " + core::counted(resumed->as_int(), "piece was", "pieces were") + " done by an earlier run\n";
  for (const Warning& w : warnings_in(report)) out += "\nwarning [" + w.code + "]: " + w.text + "\n";
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

std::string explanation_text(const Explanation& e) {
  std::string out = "[run]\n";
  options(e.run, "", out);
  for (const ExplainedStage& stage : e.stages) {
    out += "\n[[stage]] " + std::string(stage.type) + "\n";
    options(stage.options, "", out);
  }
  return out;
}

}  // namespace swath::pipeline
