// SPDX-License-Identifier: GPL-3.0-or-later
// What stages declare of themselves, for functions, docstrings and stubs.
#include <nanobind/stl/string.h>

#include <vector>

#include "core/config/option_visitors.h"
#include "core/config/result_visitors.h"
#include "core/error.h"
#include "io/text/value_file.h"
#include "pipeline/describe.h"
#include "python/bindings.h"
#include "stages/registry.h"

namespace swath::python {
namespace {

namespace nb = nanobind;
using core::Value;

template <class List>
Value names_of(const List& list) {
  Value out = Value::array();
  for (const auto& one : list) out.push(std::string(name_of(one)));
  return out;
}

Value names_of_columns(core::ColumnSet set) {
  Value out = Value::array();
  for (int c = 0; c < core::column_count; ++c)
    if (set.has(static_cast<core::Column>(c))) out.push(std::string(core::name_of(static_cast<core::Column>(c))));
  return out;
}

Value options_of(stages::Stage& stage) {
  Value out = Value::array();
  for (const core::OptionDoc& d : core::document_options([&](core::Visitor& v) { stage.visit(v); })) {
    Value one = Value::object();
    one["path"] = d.path, one["shape"] = d.shape, one["default"] = d.fallback, one["range"] = d.range, one["doc"] = d.doc;
    one["source"] = d.source, one["is_table"] = d.is_table;
    out.push(std::move(one));
  }
  return out;
}

/// Every stage of the registry: [{"name", "summary", "grains", "needs", "gives", "needs_products", "gives_products", "options", "schema",
/// "counts"}].
std::string stages_declared() {
  Value out = Value::array();
  for (const stages::Entry& e : stages::registry()) {
    const auto stage = e.make();
    const stages::Info& info = stage->info();
    Value one = Value::object();
    one["name"] = std::string(info.name);
    one["summary"] = std::string(info.summary);
    one["grains"] = names_of(info.grains);
    one["needs"] = names_of_columns(info.needs);
    one["gives"] = names_of_columns(info.gives);
    one["needs_products"] = names_of(info.needs_products);
    one["gives_products"] = names_of(info.gives_products);
    one["options"] = options_of(*stage);
    one["schema"] = core::schema_of([&](core::Visitor& v) { stage->visit(v); });
    Value& counts = one["counts"] = Value::array();
    for (const core::ResultDoc& d : core::document_results([&](core::ResultVisitor& v) { stage->visit_counts(v); }))
      counts.push(Value(Value::Object{{"key", d.path}, {"doc", d.doc}}));
    out.push(std::move(one));
  }
  return io::to_json(out);
}

/// Options of tables within tables lose their places in the text that Python made of them.
void forget_places(Value& v) {
  v.where = {};
  if (v.is_array())
    for (Value& one : v.items()) forget_places(one);
  if (v.is_object())
    for (auto& [key, one] : v.members()) forget_places(one);
}

/// Throws core::Error with all faults of a stage's options, each under `path`.
void check_options(const std::string& name, const std::string& options, const std::string& path) {
  const auto stage = stages::make_stage(name);
  if (!stage) throw core::usage_error("'" + name + "' is not a stage", path);
  Value table = io::parse_json(options, path);
  forget_places(table);
  std::vector<core::Fault> faults;
  core::read_options([&](core::Visitor& v) { stage->visit(v); }, table, path, faults);
  core::throw_if_any(faults);
}

}  // namespace

void bind_declared(nb::module_& m) {
  m.def("stages", &stages_declared);
  m.def("schema", [] { return io::to_json(pipeline::schema()); });
  m.def("check_options", &check_options);
}

}  // namespace swath::python
