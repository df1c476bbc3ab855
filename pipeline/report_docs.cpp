// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/report_docs.h"

#include <algorithm>

#include "pipeline/engine/run_report.h"
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

struct LineCount {};

template <class V>
void describe(const LineCount&, V& v) {
  v.result("line", 0, "Number of the flight line.");
  v.result("count", std::uint64_t{0}, "Records of it.");
}

struct FileCount {};

template <class V>
void describe(const FileCount&, V& v) {
  v.result("file", std::string{}, "Name of the file.");
  v.result("count", std::uint64_t{0}, "Records of it.");
  v.result("first_s", 0.0, "Time of the first of them, GPS time.");
  v.result("last_s", 0.0, "Time of the last of them, GPS time.");
}

/// A count under `tally`.
struct CountedSample {};

template <class V>
void describe(const CountedSample&, V& v) {
  v.result("count", std::uint64_t{0}, "Number of records.");
  v.tables_if(false, "lines", std::vector<LineCount>{}, "The count by flight line.");
  v.tables_if(false, "files", std::vector<FileCount>{}, "The count by file, with times.");
  v.result("examples", std::vector<std::string>{}, "The first of them.");
}

/// Under `tally` each count is a table with its examples.
Value tally_schema(const stages::Stage& s) {
  Value out = core::result_schema(counts_of(s));
  for (auto& [key, one] : out.find("properties")->members()) {
    Value entry = core::result_schema(core::described_results(CountedSample{}));
    entry.members().emplace_back("description", *one.find("description"));
    one = std::move(entry);
  }
  return out;
}

/// Its place in the schema of what holds it.
Value& property(Value& schema, std::string_view key) { return *schema.find("properties")->find(key); }

}  // namespace

std::string report_page() {
  std::string out = "## The run\n\n" + core::result_table_markdown(core::described_results(RunReport{}));
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
  Value out = core::result_schema(core::described_results(RunReport{}));
  Value any = Value::array();
  for (const auto& e : stages::registry()) {
    const auto s = e.make();
    Value one = core::result_schema(core::described_results(StageReport{}));
    property(one, "type") = Value(Value::Object{{"const", e.name}});
    property(one, "tally") = tally_schema(*s);
    Value findings = core::result_schema(findings_of(*s));
    Value& found = *findings.find("properties");
    if (Value* geometry = found.find("geometry")) {  // lies beside the stages; the stage has its verdict alone
      Value verdict = property(*geometry, "verdict");
      property(out, "geometry") = std::move(*geometry);
      found = Value(Value::Object{{"verdict", std::move(verdict)}});
    }
    property(one, "findings") = std::move(findings);
    one.members().emplace_back("required", Value(Value::Array{"type"}));
    any.push(std::move(one));
  }
  property(out, "stages") = Value(Value::Object{{"type", "array"}, {"items", Value(Value::Object{{"anyOf", std::move(any)}})}});
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
