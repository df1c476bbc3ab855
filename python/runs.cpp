// SPDX-License-Identifier: GPL-3.0-or-later
// Runs of pipelines from Python: on files, or on points and trajectories in memory.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>
#include <variant>

#include "core/config/result_visitors.h"
#include "core/error.h"
#include "io/text/value_file.h"
#include "pipeline/input_guard.h"
#include "pipeline/memory.h"
#include "pipeline/run.h"
#include "pipeline/work/work_folder.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/memory_stages.h"
#include "python/on_tile.h"
#include "python/watched.h"
#include "stages/registry.h"

namespace swath::python {
namespace {

namespace fs = std::filesystem;
using core::Column;
using core::Value;

/// A trajectory as the smoother has it, with its covariances, for later runs.
struct HeldTrajectory {
  core::TrajectoryData data;
};

/// The value under a key of a request; `otherwise` where there is none.
template <class T>
T value_at(const nb::dict& request, const char* key, T otherwise = {}) {
  return request.contains(key) && !request[key].is_none() ? nb::cast<T>(request[key]) : otherwise;
}

core::ColumnSet columns_named(const std::vector<std::string>& names) {
  core::ColumnSet out;
  for (const std::string& name : names) {
    bool known = false;
    std::vector<std::string> all;
    core::for_each_column([&](Column c, std::string_view n, auto) {
      all.emplace_back(n);
      if (n == name) out.add(c), known = true;
    });
    const std::string near = core::nearest(name, all);
    if (!known) throw core::usage_error("no column is named '" + name + "'", "columns", near.empty() ? "" : "did you mean '" + near + "'?");
  }
  return out;
}

/// The caller's points, and the arrays that they lie in.
struct Points {
  BorrowedPoints borrowed;
  std::vector<AnyArray> arrays;

  void take(const nb::dict& columns) {
    core::for_each_column([&](Column c, std::string_view name, auto member) {
      using T = typename std::remove_reference_t<decltype(std::declval<core::Block>().*member)>::value_type;
      const std::string key(name);
      if (!columns.contains(key.c_str())) return;
      arrays.push_back(nb::cast<AnyArray>(columns[key.c_str()]));
      if (c == Column::x) borrowed.size = arrays.back().shape(0);
      borrowed.columns.at(static_cast<size_t>(c)) = column_of<T>(arrays.back(), borrowed.size, key);
    });
  }
};

/// Places for the columns that a run leaves.
class Places {
 public:
  Places(Taken& taken, size_t records) {
    reached_.assign(records, 0);
    taken.reached = reached_.data();
    core::for_each_column([&](Column c, std::string_view name, auto member) {
      using T = typename std::remove_reference_t<decltype(std::declval<core::Block>().*member)>::value_type;
      if (!taken.columns.has(c)) return;
      auto& place = places_.emplace_back(std::string(name), std::vector<T>(records));
      taken.to.at(static_cast<size_t>(c)) = std::get<std::vector<T>>(place.second).data();
    });
  }
  nb::dict arrays() {
    nb::dict out;
    for (auto& [name, column] : places_)
      std::visit([&, key = name](auto& values) { out[key.c_str()] = array_of(std::move(values)); }, column);
    out["reached"] = array_of(std::move(reached_));
    return out;
  }

 private:
  using AnyColumn = std::variant<std::vector<double>, std::vector<float>, std::vector<std::uint8_t>, std::vector<std::uint16_t>,
                                 std::vector<std::uint32_t>>;
  std::vector<std::uint8_t> reached_;
  std::vector<std::pair<std::string, AnyColumn>> places_;
};

/// The place behind the last ground filter of a pipeline, or where it has none behind the last stage on strips.
size_t place_behind(const Value::Array& list, const std::string& behind, const std::string& config) {
  static const std::vector<std::string> ground{"filters.ground", "filters.smrf", "filters.ptd",
                                               "filters.robust", "filters.pmf",  "filters.csf"};
  size_t after_ground = 0, after_strips = 0, after_named = 0;
  std::vector<std::string> types;
  for (size_t i = 0; i < list.size(); ++i) {
    const Value* type = list[i].find("type");
    if (!type || !type->is_text()) continue;
    types.push_back(type->as_text());
    if (std::count(ground.begin(), ground.end(), types.back())) after_ground = i + 1;
    if (types.back() == behind) after_named = i + 1;
    if (const auto stage = stages::make_stage(types.back()); stage && stage->works_on(stages::Grain::strip)) after_strips = i + 1;
  }
  if (behind.empty()) return after_ground > 0 ? after_ground : after_strips;
  const std::string near = core::nearest(behind, types);
  if (after_named == 0)
    throw core::usage_error("no stage '" + behind + "' in this pipeline", config + ": after",
                            near.empty() ? "" : "did you mean '" + near + "'?");
  return after_named;
}

void put_on_tile(Value& tree, const std::string& behind, const std::string& config) {
  Value* list = tree.find("stage");
  if (!list || !list->is_array()) return;  // make_plan names the fault
  Value stage(Value::Object{{"type", "python.on_tile"}});
  const size_t place = place_behind(list->items(), behind, config);
  list->items().insert(list->items().begin() + static_cast<std::ptrdiff_t>(place), std::move(stage));
}

OnTile on_tile_of(const nb::dict& given) {
  OnTile out;
  out.function = nb::borrow(given["function"]);
  std::string fault;
  const std::string halo = nb::cast<std::string>(given["halo"]);
  const auto metres = core::parse_quantity(core::Dimension::length, halo, fault);
  if (!metres || !(*metres >= 0.0))
    throw core::usage_error("'" + halo + "': " + (metres ? "below 0" : fault), "halo", "write it with its unit: \"20 m\"");
  out.halo = core::Metres(*metres);
  if (const auto names = value_at<std::optional<std::vector<std::string>>>(given, "columns"))
    out.columns = columns_named(*names);
  else
    core::for_each_column([&](Column c, std::string_view, auto) { out.columns.add(c); });
  out.code = nb::cast<std::string>(given["code"]);
  return out;
}

/// What an earlier run has done with the function of that run goes: what the function calls may have changed.
void forget_from(const pipeline::Plan& plan, const std::string& type) {
  const fs::path work = fs::absolute(plan.run.output) / ".swath";
  if (!fs::is_directory(work)) return;
  pipeline::expect_own(work);
  const pipeline::WorkLock lock(work);
  size_t first = 0;
  while (first < plan.stages.size() && plan.stages[first].stage->info().name != type) ++first;
  std::vector<fs::path> later;
  for (const auto& e : fs::directory_iterator(work))
    if (const std::string name = e.path().filename().string(); e.is_directory() && std::isdigit(static_cast<unsigned char>(name[0])))
      if (std::stoul(name) >= first) later.push_back(e.path());
  for (const fs::path& folder : later) fs::remove_all(folder);
}

/// A request of Python's and all that its run refers to.
struct Job {
  pipeline::Request request;
  Points points;
  Taken taken;
  std::unique_ptr<Places> places;
  OnTile on_tile;
  bool has_on_tile = false;
  std::string command;

  explicit Job(const nb::dict& r) {
    request.config = value_at<std::string>(r, "config");
    request.survey = value_at<std::string>(r, "survey");
    request.output = value_at<std::string>(r, "output");
    request.sets = value_at<std::vector<std::string>>(r, "sets");
    request.threads = value_at(r, "threads", -1);
    command = value_at<std::string>(r, "command");
    if (const auto tree = value_at<std::string>(r, "tree"); !tree.empty()) request.tree = io::parse_json(tree, request.config.string());
    if (r.contains("points")) points.take(nb::cast<nb::dict>(r["points"]));
    points.borrowed.weekless = value_at(r, "weekless", false);
    taken.columns = columns_named(value_at<std::vector<std::string>>(r, "take_columns"));
    taken.lines_file = value_at<std::string>(r, "take_lines");
    places = std::make_unique<Places>(taken, value_at(r, "records", points.borrowed.size));
    add_products(value_at<std::vector<std::string>>(r, "take_grids"));
    if (value_at(r, "in_memory", false)) {
      request.entries = {points_stage(points.borrowed), take_stage(taken), take_trajectory_stage(taken)};
      request.records = io::RecordsIn::memory;
    }
    if (r.contains("trajectory")) {
      trajectory::TrajectoryOptions gaps;
      gaps.max_gap.value = value_at(r, "max_gap", gaps.max_gap.value);
      request.entries.push_back(trajectory_stage(nb::cast<const HeldTrajectory&>(r["trajectory"]).data, gaps));
    }
    if (r.contains("on_tile")) add_on_tile(nb::cast<nb::dict>(r["on_tile"]));
  }

 private:
  void add_products(const std::vector<std::string>& names) {
    for (const auto& e : stages::registry()) {
      const auto stage = e.make();
      for (const stages::Product p : stage->info().gives_products)
        if (std::count(names.begin(), names.end(), p.name()) && !std::count(taken.products.begin(), taken.products.end(), p))
          taken.products.push_back(p);
    }
  }
  void add_on_tile(const nb::dict& given) {
    on_tile = on_tile_of(given);
    has_on_tile = true;
    if (!request.tree) request.tree = io::read_value_file(request.config);
    put_on_tile(*request.tree, value_at<std::string>(given, "after"), request.config.string());
    request.entries.push_back(on_tile_stage(on_tile));
  }
};

/// A grid as Python gets it: rows from the north.
nb::dict grid_to_python(core::Grid grid) {
  const core::Lattice l = grid.lattice;
  const auto turned = [&](auto values) {
    using T = typename decltype(values)::value_type;
    std::vector<T> out;
    out.reserve(values.size());
    for (int j = l.ny - 1; j >= 0 && !values.empty(); --j)
      out.insert(out.end(), values.begin() + static_cast<std::ptrdiff_t>(l.at(0, j)),
                 values.begin() + static_cast<std::ptrdiff_t>(l.at(0, j) + static_cast<size_t>(l.nx)));
    return array_of(std::move(out), {static_cast<size_t>(l.ny), static_cast<size_t>(l.nx)});
  };
  nb::dict out;
  out["cell"] = l.cell;
  out["west"] = l.west();
  out["north"] = l.north();
  out["height"] = turned(std::move(grid.height));
  if (!grid.sigma.empty()) out["sigma"] = turned(std::move(grid.sigma));
  if (!grid.count.empty()) out["count"] = turned(std::move(grid.count));
  std::vector<std::uint8_t> reason(grid.reason.size());
  std::transform(grid.reason.begin(), grid.reason.end(), reason.begin(), [](core::Void v) { return static_cast<std::uint8_t>(v); });
  out["void_reason"] = turned(std::move(reason));
  return out;
}

nb::list lines_to_python(io::VectorLines lines) {
  nb::list out;
  for (io::VectorLine& line : lines.lines) {
    nb::dict one;
    one["x"] = array_of(std::move(line.x));
    one["y"] = array_of(std::move(line.y));
    if (!line.z.empty()) one["z"] = array_of(std::move(line.z));
    one["height"] = line.height;
    one["index"] = line.index;
    one["closed"] = line.closed;
    one["depression"] = line.depression;
    one["layer"] = line.layer;
    out.append(one);
  }
  return out;
}

nb::dict run(const nb::dict& r) {
  Job job(r);
  pipeline::Progress progress(value_at(r, "bar", false) ? pipeline::Voice::bar : pipeline::Voice::quiet);
  pipeline::Outcome outcome;
  std::string crs;
  const double beside = value_at(r, "memory_beside", 0.0);
  run_watched(
      [&] {
        pipeline::Plan plan = pipeline::make_plan(job.request);
        if (beside > 0.0) plan.run.memory = core::Bytes(static_cast<double>(pipeline::resident_bytes()) + beside);
        if (job.has_on_tile) forget_from(plan, "python.on_tile");
        outcome = pipeline::run(plan, progress, job.command);
        crs = plan.survey.crs;
      },
      [&] { progress.stop(); });
  nb::dict out;
  out["report"] = io::to_json(outcome.report);
  out["code"] = static_cast<int>(outcome.code);
  out["crs"] = crs;
  out["columns"] = job.places->arrays();
  nb::dict grids;
  for (size_t i = 0; i < job.taken.grids.size(); ++i) {
    const std::string_view name = job.taken.products[i].name();
    grids[nb::str(name.data(), name.size())] = grid_to_python(std::move(job.taken.grids[i]));
  }
  out["grids"] = grids;
  out["lines"] = lines_to_python(std::move(job.taken.lines));
  if (job.taken.trajectory.size() > 0) out["trajectory"] = nb::cast(HeldTrajectory{std::move(job.taken.trajectory)});
  return out;
}

/// Faults of config and survey, without reading data. The effective options as JSON.
std::string explain(const nb::dict& r) {
  const Job job(r);
  pipeline::Plan plan = pipeline::make_plan(job.request);
  if (!plan.survey_file.empty()) pipeline::check_output(plan);
  return io::to_json(core::reported(pipeline::explain(plan)));
}

/// A column of the trajectory as a view of what `self` holds.
nb::object column_of_trajectory(nb::handle self, const std::string& name) {
  const core::TrajectoryData& d = nb::cast<const HeldTrajectory&>(self).data;
  const std::vector<std::pair<const char*, const std::vector<double>*>> doubles{
      {"time", &d.time},   {"latitude", &d.latitude}, {"longitude", &d.longitude}, {"height", &d.height}, {"roll", &d.roll},
      {"pitch", &d.pitch}, {"heading", &d.heading},   {"v_north", &d.v_north},     {"v_east", &d.v_east}, {"v_down", &d.v_down}};
  const std::vector<std::pair<const char*, const std::vector<float>*>> floats{
      {"sigma_north", &d.sigma_north}, {"sigma_east", &d.sigma_east},   {"sigma_down", &d.sigma_down},
      {"sigma_roll", &d.sigma_roll},   {"sigma_pitch", &d.sigma_pitch}, {"sigma_heading", &d.sigma_heading}};
  for (const auto& [key, column] : doubles)
    if (const size_t n = column->size(); key == name && n > 0)
      return nb::cast(nb::ndarray<nb::numpy, const double>(column->data(), 1, &n, self));
  for (const auto& [key, column] : floats)
    if (const size_t n = column->size(); key == name && n > 0)
      return nb::cast(nb::ndarray<nb::numpy, const float>(column->data(), 1, &n, self));
  return nb::none();
}

}  // namespace

void bind_runs(nb::module_& m) {
  nb::class_<HeldTrajectory>(m, "HeldTrajectory").def("column", &column_of_trajectory).def("size", [](const HeldTrajectory& t) {
    return t.data.size();
  });
  m.def("run", &run);
  m.def("explain", &explain);
  m.def("resident_bytes", &pipeline::resident_bytes);
}

}  // namespace swath::python
