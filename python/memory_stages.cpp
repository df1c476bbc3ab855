// SPDX-License-Identifier: GPL-3.0-or-later
// Deviation from the readers of files: a place is the caller's double less the run's origin, rounded once more than a file's integer times
// its scale: 1e-10 m at 500 km.
#include "python/memory_stages.h"

#include <algorithm>
#include <utility>

#include "stages/adapters/flight/place.h"
#include "stages/adapters/units.h"
#include "stages/area.h"
#include "stages/surfaces.h"

namespace swath::python {
namespace {

using core::Column;
using core::ColumnSet;
using stages::Context;
using stages::Grain;
using stages::Product;

/// Every cloud has these; zeros where the caller has none.
constexpr ColumnSet columns_of_clouds{Column::x,
                                      Column::y,
                                      Column::z,
                                      Column::time,
                                      Column::intensity,
                                      Column::return_number,
                                      Column::return_count,
                                      Column::classification,
                                      Column::flags,
                                      Column::scan_angle,
                                      Column::strip,
                                      Column::record};

class PointsReader : public stages::StripReader {
 public:
  PointsReader(const BorrowedPoints& points, const Context& context) : points_(points), context_(context) {}
  bool next(stages::StripBatch& batch, size_t most, core::Tally& tally) override {
    const size_t n = std::min(most, points_.size - at_);
    if (n == 0) return false;
    core::Block block;
    block.origin = context_.origin;
    core::for_each_column([&](Column c, std::string_view, auto member) {
      using T = typename std::remove_reference_t<decltype(block.*member)>::value_type;
      if (const T* from = points_.column<T>(c)) (block.*member).assign(from + at_, from + at_ + n);
    });
    for (size_t i = 0; i < n; ++i) {
      block.x[i] = block.x[i] * context_.unit - block.origin.x();
      block.y[i] = block.y[i] * context_.unit - block.origin.y();
      block.z[i] = block.z[i] * context_.vertical_unit - block.origin.z();
    }
    core::add_columns(block, columns_of_clouds);
    for (size_t i = 0; i < n; ++i) block.record[i] = static_cast<std::uint32_t>(at_ + i);
    at_ += n;
    tally.keep("points", n);
    batch.block = std::move(block);
    return true;
  }

 private:
  const BorrowedPoints& points_;
  const Context& context_;
  size_t at_ = 0;
};

class PointsInMemory : public stages::OptionStage<stages::NoOptions> {
 public:
  explicit PointsInMemory(const BorrowedPoints& points)
      : points_(points), info_{"python.points",  "Points in columns of the caller's.", {Grain::strip}, {}, columns_of_clouds, {},
                               {Product::points}} {
    for (int c = 0; c < core::column_count; ++c)
      if (points.columns.at(static_cast<size_t>(c))) info_.gives.add(static_cast<Column>(c));
  }
  const stages::Info& info() const override { return info_; }
  bool is_source() const override { return true; }
  void locate(Context& context) const override {
    const double *x = points_.column<double>(Column::x), *y = points_.column<double>(Column::y);
    context.weekless = points_.weekless;
    // As for clouds of files: heights of a CRS that leaves it open are in the unit of the horizontal axes.
    if (!context.crs.has_height_unit() && !context.survey.height_unit) context.vertical_unit = context.unit;
    context.origin = stages::origin_near(context, {x[0], y[0], 0.0});
    const auto [west, east] = std::minmax_element(x, x + points_.size);
    const auto [south, north] = std::minmax_element(y, y + points_.size);
    context.area.lowest = -core::Area::none, context.area.highest = core::Area::none;
    stages::set_area(context, {*west * context.unit, *south * context.unit, *east * context.unit, *north * context.unit},
                     stages::around_clouds);
    if (context.crs.heights() == core::Heights::unknown) context.heights = core::unknown_heights;
  }
  std::vector<stages::Strip> strips(const Context&, core::Tally& tally) const override {
    tally.read("points", points_.size);
    return {{0, 0, 0, "the points", points_.size}};
  }
  std::unique_ptr<stages::StripReader> open(const Context& context, const stages::Strip&) const override {
    return std::make_unique<PointsReader>(points_, context);
  }

 private:
  const BorrowedPoints& points_;
  stages::Info info_;
};

class GivenTrajectory : public stages::OptionStage<stages::NoOptions> {
 public:
  GivenTrajectory(const core::TrajectoryData& data, trajectory::TrajectoryOptions gaps) : data_(data), options_(gaps) {}
  const stages::Info& info() const override {
    static const stages::Info info{"python.trajectory",
                                   "A trajectory that was computed before.",
                                   {Grain::survey},
                                   {},
                                   {},
                                   {},
                                   {Product::of<trajectory::Trajectory>()}};
    return info;
  }
  void run_survey(Context& context, core::Tally& tally, core::Value&) const override {
    trajectory::Trajectory flown(data_, options_, "trajectory");
    stages::place_on_map(context, flown, tally);
    context.records.put(std::move(flown));
  }

 private:
  const core::TrajectoryData& data_;
  trajectory::TrajectoryOptions options_;
};

class TakeTrajectory : public stages::OptionStage<stages::NoOptions> {
 public:
  explicit TakeTrajectory(Taken& taken) : taken_(taken) {}
  const stages::Info& info() const override {
    static const stages::Info info{"python.take_trajectory",
                                   "Hands the trajectory to the caller.",
                                   {Grain::survey},
                                   {},
                                   {},
                                   {Product::of<trajectory::Trajectory>()},
                                   {}};
    return info;
  }
  void run_survey(Context& context, core::Tally&, core::Value&) const override {
    taken_.trajectory = record<trajectory::Trajectory>(context)->data();
  }

 private:
  Taken& taken_;
};

/// Rows and columns at the rim without any height go.
core::Lattice without_rim(const core::Grid& g) {
  const core::Lattice& l = g.lattice;
  int i0 = l.nx, j0 = l.ny, i1 = 0, j1 = 0;
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i)
      if (g.reason[l.at(i, j)] != core::Void::no_data)
        i0 = std::min(i0, i), i1 = std::max(i1, i + 1), j0 = std::min(j0, j), j1 = std::max(j1, j + 1);
  if (i0 >= i1) return {l.cell, l.i0, l.j0, 0, 0};
  return {l.cell, l.i0 + i0, l.j0 + j0, i1 - i0, j1 - j0};
}

core::Grid grid_over(const Context& context, Product product, const std::vector<stages::TileKey>& tiles) {
  stages::Box box = context.box_of(tiles.front());
  for (const stages::TileKey key : tiles) {
    const stages::Box one = context.box_of(key);
    box = {std::min(box.x0, one.x0), std::min(box.y0, one.y0), std::max(box.x1, one.x1), std::max(box.y1, one.y1)};
  }
  const core::Grid whole = context.grids->window(product, stages::lattice_in(context.grids->cell(product), box));
  core::Grid grid = context.grids->window(product, without_rim(whole));
  const auto& all = stages::surfaces();
  const auto surface = std::find_if(all.begin(), all.end(), [&](const stages::Surface& s) { return s.product == product; });
  const bool is_height = surface == all.end() || surface->has_quality || surface->unit == "height";
  if (is_height) return stages::in_crs_units(context, std::move(grid));
  grid.lattice = stages::in_crs_units(context, grid.lattice);
  return grid;
}

class Take : public stages::OptionStage<stages::NoOptions> {
 public:
  explicit Take(Taken& taken) : taken_(taken), info_{"python.take", "Hands results to the caller.", {}, {}, {}, {}, {}} {
    if (!taken.columns.empty()) {
      info_.grains.push_back(Grain::tile);
      info_.needs = taken.columns | ColumnSet{Column::record};
      info_.needs_products.push_back(Product::points);
    }
    if (!taken.products.empty() || !taken.lines_file.empty()) info_.grains.push_back(Grain::merge);
    info_.needs_products.insert(info_.needs_products.end(), taken.products.begin(), taken.products.end());
    if (!taken.lines_file.empty()) info_.needs_products.push_back(Product::contours);
  }
  const stages::Info& info() const override { return info_; }
  /// Tiles write to rows of their own.
  void run_tile(const Context& context, stages::TileJob& job) const override {
    core::Block& b = job.block;
    stages::to_crs_units(context, b);
    core::for_each_column([&](Column c, std::string_view, auto member) {
      using T = typename std::remove_reference_t<decltype(b.*member)>::value_type;
      if (!taken_.columns.has(c)) return;
      T* to = static_cast<T*>(taken_.to.at(static_cast<size_t>(c)));
      const double shift = c == Column::x ? b.origin.x() : c == Column::y ? b.origin.y() : c == Column::z ? b.origin.z() : 0.0;
      for (size_t i = 0; i < job.own; ++i) to[b.record[i]] = shift == 0.0 ? (b.*member)[i] : static_cast<T>((b.*member)[i] + shift);
    });
    if (taken_.reached)
      for (size_t i = 0; i < job.own; ++i) taken_.reached[b.record[i]] = 1;
  }
  void run_merge(const Context& context, stages::MergeJob& job) const override {
    for (const Product p : taken_.products) taken_.grids.push_back(grid_over(context, p, job.tiles));
    if (taken_.lines_file.empty()) return;
    if (const std::filesystem::path file = context.made(taken_.lines_file); !file.empty()) taken_.lines = io::read_lines(file);
  }

 private:
  Taken& taken_;
  stages::Info info_;
};

}  // namespace

stages::Entry points_stage(const BorrowedPoints& points) {
  return {"python.points", [&points] { return std::make_unique<PointsInMemory>(points); }};
}
stages::Entry trajectory_stage(const core::TrajectoryData& data, trajectory::TrajectoryOptions options) {
  return {"python.trajectory", [&data, options] { return std::make_unique<GivenTrajectory>(data, options); }};
}
stages::Entry take_stage(Taken& taken) {
  return {"python.take", [&taken] { return std::make_unique<Take>(taken); }};
}
stages::Entry take_trajectory_stage(Taken& taken) {
  return {"python.take_trajectory", [&taken] { return std::make_unique<TakeTrajectory>(taken); }};
}

}  // namespace swath::python
