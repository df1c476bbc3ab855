// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/jobs/set_options.h"

#include <algorithm>
#include <vector>

#include "core/error.h"
#include "io/text/value_file.h"

namespace swath::pipeline {
namespace {

using core::Value;

/// A --set value: true/false, a whole number, a number, otherwise text. A list is written [a, b, c].
Value set_value(std::string text) {
  const core::Location where{"--set", 0, 0};
  try {
    Value v = *io::parse_toml("v = " + text, "--set").find("v");
    v.where = where;
    return v;
  } catch (const core::Error&) {
    Value v(std::move(text));
    v.where = where;
    return v;
  }
}

/// Sets "key" or "table.key" within a table.
void set_member(Value& table, const std::string& path, const Value& value, const std::string& set) {
  if (!table.is_null() && !table.is_object()) throw core::usage_error("what it changes is no table", "--set " + set);
  const size_t dot = path.find('.');
  if (dot != std::string::npos) return set_member(table[path.substr(0, dot)], path.substr(dot + 1), value, set);
  table[path] = value;
}

void refuse_deep_key(const std::string& path, const std::string& set) {
  constexpr auto deepest = 20;
  if (std::count(path.begin(), path.end(), '.') > deepest)
    throw core::usage_error("a key of more than " + std::to_string(deepest) + " levels", "--set " + set);
}

}  // namespace

bool is_named(const std::string& type, const std::string& name) {
  return type == name || (type.size() > name.size() && type.ends_with("." + name));
}

void set_stage_option(Value& tree, const std::string& set) {
  const size_t equals = set.find('=');
  const std::string path = set.substr(0, equals);
  const size_t dot = path.rfind('.');
  if (equals == std::string::npos || dot == std::string::npos)
    throw core::usage_error("'" + set + "' is not stage.key=value", "--set", "for example --set dtm.cell=\"50 cm\"");
  refuse_deep_key(path, set);
  const Value value = set_value(set.substr(equals + 1));
  if (path.starts_with("run.")) return set_member(tree["run"], path.substr(4), value, set);
  std::vector<std::string> types;
  std::vector<Value*> named;
  size_t longest = 0;  // name of a stage that begins the path wins: "quality.swath.anps" is no option of report.quality
  if (Value* list = tree.find("stage"); list && list->is_array())
    for (Value& stage : list->items()) {
      const Value* type = stage.find("type");
      if (!type || !type->is_text()) continue;
      types.push_back(type->as_text());
      for (size_t d = path.find('.'); d != std::string::npos; d = path.find('.', d + 1)) {
        if (d < longest || !is_named(type->as_text(), path.substr(0, d))) continue;
        if (d > longest) named.clear(), longest = d;
        named.push_back(&stage);
      }
    }
  for (Value* stage : named) set_member(*stage, path.substr(longest + 1), value, set);
  if (!named.empty()) return;
  const std::string near = core::nearest(path.substr(0, dot), types);
  std::string known = "its stages: run";
  for (const std::string& t : types) known += ", " + t;
  throw core::usage_error("no stage '" + path.substr(0, dot) + "' in this pipeline", "--set " + set,
                          near.empty() ? known : "did you mean '" + near + "'?");
}

void set_option(core::Value& table, const std::string& set) {
  const size_t equals = set.find('=');
  if (equals == std::string::npos || equals == 0)
    throw core::usage_error("'" + set + "' is not key=value", "--set", "for example --set flight.speed=\"60 m/s\"");
  refuse_deep_key(set.substr(0, equals), set);
  set_member(table, set.substr(0, equals), set_value(set.substr(equals + 1)), set);
}

}  // namespace swath::pipeline
