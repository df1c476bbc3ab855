// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/report_docs.h"

#include <algorithm>

#include "stages/registry.h"

namespace swath::pipeline {
namespace {

using core::Value;

core::DescribeResults counts_of(const stages::Stage& s) {
  return [&s](core::ResultVisitor& v) { s.visit_counts(v); };
}
core::DescribeResults findings_of(const stages::Stage& s) {
  return [&s](core::ResultVisitor& v) { s.visit_findings(v); };
}

/// Under `tally` each count is a table with its examples.
const core::RecordCount any_records;

Value tally_schema(const stages::Stage& s) {
  Value out = core::result_schema(counts_of(s));
  for (auto& [key, one] : out["properties"].members()) {
    Value entry = Value::object();
    entry["type"] = "object";
    entry["description"] = *one.find("description");
    entry["properties"]["count"]["type"] = "integer";
    Value examples = Value::object();
    examples["type"] = "array";
    examples["items"]["type"] = "string";
    entry["properties"]["examples"] = std::move(examples);
    one = std::move(entry);
  }
  return out;
}

}  // namespace

std::string report_page() {
  std::string out = "## Files\n\nOf every stage that reads records, a list under `records`:\n\n" +
                    core::result_table_markdown(core::described_results(any_records));
  for (const auto& e : stages::registry()) {
    const auto s = e.make();
    const bool counts = !core::document_results(counts_of(*s)).empty(), findings = !core::document_results(findings_of(*s)).empty();
    if (!counts && !findings) continue;
    out += "\n## `" + std::string(e.name) + "`\n";
    if (counts) out += "\nUnder `tally`:\n\n" + core::result_table_markdown(counts_of(*s));
    if (findings) out += "\nUnder `findings`:\n\n" + core::result_table_markdown(findings_of(*s));
  }
  return out;
}

Value report_schema() {
  Value out = Value::object();
  out["type"] = "object";
  Value any = Value::array(), records = Value::object();
  records["type"] = "array";
  records["items"] = core::result_schema(core::described_results(any_records));
  for (const auto& e : stages::registry()) {
    const auto s = e.make();
    Value one = Value::object();
    one["type"] = "object";
    one["properties"]["type"]["const"] = e.name;
    one["properties"]["records"] = records;
    one["properties"]["tally"] = tally_schema(*s);
    one["properties"]["findings"] = core::result_schema(findings_of(*s));
    one["required"] = Value::array();
    one["required"].push("type");
    any.push(std::move(one));
  }
  Value& list = out["properties"]["stages"];
  list["type"] = "array";
  list["items"]["anyOf"] = std::move(any);
  return out;
}

std::map<std::string, core::ResultDoc> declared_findings(std::string_view stage) {
  std::map<std::string, core::ResultDoc> out;
  if (const auto s = stages::make_stage(stage))
    for (core::ResultDoc& d : core::document_results(findings_of(*s))) out.emplace(d.path, d);
  return out;
}

const Value* value_at(const Value& tables, std::string_view path) {
  const Value* at = &tables;
  while (at && !path.empty()) {
    const size_t dot = std::min(path.find('.'), path.size());
    at = at->find(path.substr(0, dot));
    path.remove_prefix(std::min(dot + 1, path.size()));
  }
  return at;
}

const std::vector<LimitedFinding>& limited_findings() {
  static const std::vector<LimitedFinding> list = [] {
    std::vector<LimitedFinding> found;
    for (const auto& e : stages::registry())
      for (const auto& [path, d] : declared_findings(e.name))
        if (!d.form.limit.empty()) found.push_back({std::string(e.name), path, std::string(d.form.limit)});
    return found;
  }();
  return list;
}

}  // namespace swath::pipeline
