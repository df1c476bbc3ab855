// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/plan.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "core/config/result_visitors.h"
#include "core/error.h"
#include "core/geo/map_axes.h"
#include "io/survey/read_survey.h"
#include "io/survey/record_checks.h"
#include "io/survey/tree_kind.h"
#include "io/text/value_file.h"
#include "pipeline/jobs/config_folder.h"
#include "pipeline/jobs/pdal_pipeline.h"
#include "pipeline/jobs/set_options.h"
#include "stages/registry.h"

namespace swath::pipeline {
namespace {

using core::ColumnSet;
using core::Fault;
using core::Value;
using stages::Grain;
using stages::Product;

/// What a stage uses of others and the plan does not name, where there are points for it.
void add_implied(const stages::Stage& stage, const core::Location& where, const std::string& path, Plan& plan) {
  bool cloud = false, points = false;
  for (const PlannedStage& s : plan.stages) {
    points = points || s.stage->info().makes(Product::points);
    cloud = cloud || (s.stage->is_source() && s.stage->info().makes(Product::points));
  }
  const std::string_view name = stage.implied(cloud);
  if (name.empty() || !points) return;
  for (const PlannedStage& s : plan.stages)
    if (s.stage->info().name == name) return;
  Value table = Value::object();
  table.where = where;
  plan.stages.push_back({stages::make_stage(name), std::move(table), path});
}

void read_stages(const Value& tree, const std::vector<stages::Entry>& entries, Plan& plan, std::vector<Fault>& faults) {
  const Value* list = tree.find("stage");
  if (!list || !list->is_array() || list->items().empty()) {
    faults.push_back({tree.where, "stage", "the pipeline has no stages", "an ordered list of [[stage]] tables, each with a type"});
    return;
  }
  int number = 0;
  for (const Value& table : list->items()) {
    const std::string path = "stage[" + std::to_string(++number) + "]";
    const Value* type = table.find("type");
    if (!type || !type->is_text()) {
      faults.push_back({table.where, path, "the stage has no type", "`swath stages` lists them"});
      continue;
    }
    const auto own = std::find_if(entries.begin(), entries.end(), [&](const stages::Entry& e) { return e.name == type->as_text(); });
    auto stage = own != entries.end() ? own->make() : stages::make_stage(type->as_text());
    if (!stage) {
      const std::string near = core::nearest(type->as_text(), stages::stage_names());
      faults.push_back({type->where, path + ".type", "'" + type->as_text() + "' is not a stage",
                        near.empty() ? "`swath stages` lists them" : "did you mean '" + near + "'?"});
      continue;
    }
    core::read_options([&](core::Visitor& v) { stage->visit(v); }, table, path + " (" + type->as_text() + ")", faults, {"type"});
    add_implied(*stage, table.where, path, plan);
    plan.stages.push_back({std::move(stage), table, path});
  }
}

/// The cells of two grids that a stage needs where they differ; otherwise empty.
std::string differing_cells(const stages::Info& info, const std::map<Product, double>& cells) {
  const auto cell = [&](Product q) {
    return core::format_quantity(core::Dimension::length, cells.at(q)) + " of " + std::string(name_of(q));
  };
  const Product* first = nullptr;
  for (const Product& p : info.needs_products) {
    if (!cells.contains(p)) continue;
    if (first && cells.at(p) != cells.at(*first)) return cell(*first) + " and " + cell(p);
    first = &p;
  }
  return {};
}

/// Do the stages fit one another: sources first, columns and products given before they are needed, grains in order.
void check_order(const Plan& plan, std::vector<Fault>& faults) {
  ColumnSet columns;
  std::vector<Product> products;
  std::map<Product, double> cells;  // of the grids given
  bool tiles_began = false;
  int sources = 0;
  std::map<std::filesystem::path, std::string> makers{{"report.json", "the report"}, {".swath", "the work in progress"}};
  for (const PlannedStage& s : plan.stages) {
    const stages::Info& info = s.stage->info();
    const auto fault = [&](std::string what, std::string hint) {
      faults.push_back({s.table.where, s.path + " (" + std::string(info.name) + ")", std::move(what), std::move(hint)});
    };
    const auto giver = [](auto&& gives) {
      std::string names;
      for (const auto& e : stages::registry())
        if (gives(e.make()->info())) names += (names.empty() ? "" : ", ") + std::string(e.name);
      return names.empty() ? std::string() : "given by: " + names;
    };
    if (s.stage->is_source() && sources++ > 0) fault("a second source of points", "one reader per pipeline");
    if (s.stage->works_on(Grain::strip) && tiles_began)
      fault("a strip stage behind a tile stage", "readers, georeference and returns come before filters and terrain");
    tiles_began = tiles_began || s.stage->works_on(Grain::tile);
    for (const Product p : info.needs_products)
      if (std::find(products.begin(), products.end(), p) == products.end())
        fault("needs " + std::string(name_of(p)) + ", which no stage before it gives",
              giver([p](const stages::Info& i) { return i.makes(p); }));
    if (const std::string sizes = differing_cells(info, cells); !sizes.empty())
      fault("needs grids of the same cells, and they are " + sizes, "give both stages the same cell");
    for (int c = 0; c < core::column_count; ++c) {
      const auto column = static_cast<core::Column>(c);
      if (info.needs.has(column) && !columns.has(column))
        fault("needs the column " + std::string(core::name_of(column)) + ", which no stage before it gives",
              giver([column](const stages::Info& i) { return i.gives.has(column); }));
    }
    for (const std::string& name : s.stage->products()) {
      std::filesystem::path product = std::filesystem::path(name).lexically_normal();
      if (!product.has_filename()) product = product.parent_path();
      if (product.empty() || product == "." || product.is_absolute() || *product.begin() == "..")
        fault("the name '" + name + "' of a product does not lie in the output folder", "a plain name, such as \"points\"");
      else if (const auto [maker, fresh] = makers.try_emplace(product, s.path); !fresh)
        fault("makes " + name + " in the output folder, as does " + maker->second, "give one of them another name, or leave it out");
    }
    columns = columns | info.gives;
    if (s.stage->cell() > 0.0)
      for (const Product p : info.gives_products) cells[p] = s.stage->cell();
    products.insert(products.end(), info.gives_products.begin(), info.gives_products.end());
  }
  const core::Location place{plan.config.string(), 0, 0};
  if (sources == 0 && works_on_the_map(plan))
    faults.push_back({place, "stage", "no reader: nothing to work on", "readers.laser or readers.las give points"});
}

/// The rasters of one tile must fit into the budget, however few points there are.
void check_memory(const Plan& plan, std::vector<Fault>& faults) {
  stages::Context context{plan.survey};
  context.tile_side = plan.run.tile.value;
  for (const PlannedStage& s : plan.stages) {
    double needed = 0.0;
    stages::Raster largest;
    for (const stages::Raster& r : s.stage->memory(context).rasters) {
      needed += r.total(0.0);
      if (r.total(0.0) > largest.total(0.0)) largest = r;
    }
    if (needed <= plan.run.memory.value) continue;
    const auto written = [&](std::string_view key) { return key.empty() ? nullptr : s.table.find(key); };
    const bool is_widened = !written(largest.option) && written(largest.widened_by);  // by what the user has written
    const std::string option(is_widened ? largest.widened_by : largest.option);
    const auto megabytes = [](double bytes) { return core::format_quantity(core::Dimension::memory, std::ceil(bytes * 1e-6) * 1e6); };
    const auto length = [](double v) { return core::format_quantity(core::Dimension::length, v); };
    faults.push_back({written(option) ? written(option)->where : s.table.where,
                      s.path + " (" + std::string(s.stage->info().name) + ")" + (option.empty() ? "" : "." + option),
                      "cells of " + length(largest.cell) + " over a square of " + length(std::round(largest.side)) + " need " +
                          megabytes(needed) + " for a single tile, more than run.memory = " + megabytes(plan.run.memory.value),
                      std::string(option.empty() ? "" : (is_widened ? "a smaller " : "a larger ") + option + ", ") +
                          "smaller tiles (run.tile = " + length(plan.run.tile.value) + ") or more memory"});
  }
}

/// The trajectory has a way to the products' CRS, with every grid that it takes.
void require_way_to(const core::Crs& crs, const std::filesystem::path& survey) {
  try {
    core::Transform(core::wgs84_geodetic(), crs);
  } catch (const core::Error& e) {
    throw core::usage_error(e.what(), survey.string() + ": crs", e.hint());
  }
}

/// The CRS of the source's own coordinates; empty where it has none.
std::string crs_of_source(const Plan& plan) {
  for (const PlannedStage& s : plan.stages)
    if (s.stage->is_source()) return s.stage->own_crs(plan.survey);
  return {};
}

/// What only the survey can settle: a map projection, and each stage's own conditions.
void check_against_survey(const Plan& plan) {
  if (!plan.survey.crs.empty() && works_on_the_map(plan)) require_projected(core::Crs(plan.survey.crs), plan.survey_file);
  if (!plan.survey.crs.empty() && plan.survey.points.empty() && !plan.survey.hangar)
    require_way_to(core::Crs(plan.survey.crs), plan.survey_file);
  stages::Context context{plan.survey};
  context.tile_side = plan.run.tile.value;
  for (const PlannedStage& s : plan.stages)
    if (s.stage->is_source()) context.source = s.stage.get();
  for (const PlannedStage& s : plan.stages) {
    s.stage->check(context);
    for (std::string& product : s.stage->products()) context.planned.push_back(std::move(product));
  }
  if (plan.survey.crs.empty() && works_on_the_map(plan))
    if (const std::string own = crs_of_source(plan); !own.empty()) require_projected(core::Crs(own), plan.survey_file);
}

/// Where the side of the tiles is left to the program, their corners have whole numbers in the CRS's unit: 1600 ft in place of 500 m.
void settle_tile(Plan& plan) {
  if (plan.run_table.find("tile") || !works_on_the_map(plan)) return;
  const std::string definition = plan.survey.crs.empty() ? crs_of_source(plan) : plan.survey.crs;
  const double unit = definition.empty() ? 1.0 : core::Crs(definition).metres_per_unit();
  const double hundred = 100.0 * unit;
  if (unit == 1.0 || hundred > plan.run.tile.value) return;
  plan.run.tile = core::Metres(std::floor(plan.run.tile.value / hundred) * hundred);
}

/// The value of an option and where it was set.
struct Origin {
  Value value;
  std::string from;
};

template <class V>
void describe(const Origin& o, V& v) {
  v.other("value", o.value, "The value as a config would write it.");
  v.result("from", o.from, "Where it was set; default: nowhere.");
}

bool takes_points(const PlannedStage& s) {
  const auto& grains = s.stage->info().grains;
  return std::any_of(grains.begin(), grains.end(), [](stages::Grain g) { return g != stages::Grain::survey; });
}

/// Sets {"key": {"value", "from"}} for each effective option of a table.
Value with_origin(const core::Describe& d, const Value& written) {
  const std::function<Value(const Value&, const Value*)> walk = [&](const Value& effective, const Value* given) {
    Value out = Value::object();
    for (const auto& [key, value] : effective.members()) {
      const Value* mine = given ? given->find(key) : nullptr;
      if (value.is_object()) {
        out[key] = walk(value, mine);
        continue;
      }
      out[key] = core::reported(Origin{value, mine ? mine->where.text() : "default"});
    }
    return out;
  };
  return walk(core::effective_values(d), &written);
}

/// The survey that the request or the config names. Its faults join those of the config.
void read_plan_survey(const Request& request, Plan& plan, std::vector<Fault>& faults) {
  if (plan.survey_tree)
    plan.survey_file = "command line";
  else if (!request.survey.empty())
    plan.survey_file = request.survey;
  else if (plan.run.survey)
    plan.survey_file = plan.config.parent_path() / *plan.run.survey;
  if (plan.survey_file.empty()) return;
  if (!plan.survey_tree && !std::filesystem::exists(plan.survey_file))
    throw core::usage_error("no such file", plan.survey_file.string(), "check the name of the survey");
  try {
    const Value survey = plan.survey_tree ? *plan.survey_tree : io::read_value_file(plan.survey_file);
    plan.survey = io::read_survey(survey, plan.survey_file.parent_path(), request.records);
    io::check_records(plan.survey, survey);
  } catch (const core::Error& e) {
    if (faults.empty()) throw;
    faults.push_back({core::Location{}, "", e.text(), ""});
  }
}

}  // namespace

Plan make_plan(const Request& request) {
  Plan plan;
  plan.config = request.tree ? request.config : find_config(request.config);
  Value tree = request.tree ? *request.tree : io::read_value_file(plan.config);
  plan.survey_tree = request.survey_tree;
  const bool is_pdal = !request.tree && is_pdal_pipeline(tree);
  if (is_pdal && !request.survey.empty()) throw core::usage_error("a PDAL pipeline names its clouds itself", "--survey");
  if (is_pdal) std::tie(tree, plan.survey_tree, plan.runs_as) = read_pdal_pipeline(tree, plan.config);
  if (!tree.is_object()) throw core::usage_error("a pipeline is a table with [run] and [[stage]]", plan.config.string());
  if (!request.tree && !is_pdal) io::require_kind(tree, io::TreeKind::pipeline, plan.config);
  for (const std::string& s : request.sets) set_stage_option(tree, s);

  std::vector<Fault> faults;
  for (const auto& [key, value] : tree.members())
    if (key != "run" && key != "stage") {
      const std::string near = core::nearest(key, {"run", "stage"});
      faults.push_back({value.where, key, "unknown key", near.empty() ? "known here: run, stage" : "did you mean '" + near + "'?"});
    }
  plan.run_table = tree.find("run") ? *tree.find("run") : Value::object();
  if (plan.run_table.is_object())
    core::read_options(core::described(plan.run), plan.run_table, "run", faults);
  else
    faults.push_back({plan.run_table.where, "run", "expected a table", ""});
  read_stages(tree, request.entries, plan, faults);
  if (faults.empty()) check_order(plan, faults);
  if (faults.empty()) check_memory(plan, faults);

  const auto flag = [&](const char* key, const char* name, Value value) { (plan.run_flags[key] = std::move(value)).where.file = name; };
  if (!request.output.empty()) plan.run.output = request.output, flag("output", "--output", request.output.string());
  if (request.threads >= 0) plan.run.threads = request.threads, flag("threads", "--threads", request.threads);
  read_plan_survey(request, plan, faults);
  core::throw_if_any(faults);
  if (!plan.survey_file.empty()) {
    check_against_survey(plan);
    settle_tile(plan);
  }
  return plan;
}

bool works_on_the_map(const Plan& plan) { return std::any_of(plan.stages.begin(), plan.stages.end(), takes_points); }

bool makes_points(const Plan& plan) {
  return std::any_of(plan.stages.begin(), plan.stages.end(),
                     [](const PlannedStage& s) { return !s.stage->is_source() && takes_points(s); });
}

void require_projected(const core::Crs& crs, const std::filesystem::path& survey) {
  core::require_easting_northing(crs, survey.string() + ": crs");
  if (crs.is_projected()) return;
  throw core::usage_error("the products' CRS is " + crs.name() + ", which is not a map projection", survey.string() + ": crs",
                          "choose a projected CRS, for example the UTM zone EPSG:326xx");
}

Explanation explain(Plan& plan) {
  Value run_table = plan.run_table;
  for (const auto& [key, value] : plan.run_flags.members()) run_table[key] = value;
  Explanation out{plan.config.string(), plan.survey_file.string(), with_origin(core::described(plan.run), run_table)};
  for (const PlannedStage& s : plan.stages) out.stages.push_back({s.stage->info().name, with_origin(s.describe(), s.table)});
  return out;
}

}  // namespace swath::pipeline
