// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/on_tile.h"

#include <nanobind/stl/string.h>

#include <memory>

#include "python/arrays.h"

namespace swath::python {
namespace {

using core::Column;
using core::ColumnSet;

constexpr ColumnSet needed{Column::x, Column::y, Column::z, Column::classification};
/// Of NumPy's temporaries: some dozen columns of doubles and the nodes of a tree of neighbours.
constexpr double bytes_per_point = 256.0;

struct OnTileOptions {
  core::Metres halo{0.0};
  std::string code;
};

template <class V>
void describe(OnTileOptions& o, V& v) {
  v.option("halo", o.halo, core::at_least(0.0), "Points around a tile that the function gets with it.");
  v.option("code", o.code, "Distinguishes the function from others.");
}

/// A column as a NumPy view that keeps the block alive.
template <class T>
nb::object view_of(std::vector<T>& column, const std::shared_ptr<core::Block>& block, bool writable) {
  auto* kept = new std::shared_ptr<core::Block>(block);
  nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::shared_ptr<core::Block>*>(p); });
  const size_t n = column.size();
  if (writable) return nb::cast(nb::ndarray<nb::numpy, T>(column.data(), 1, &n, owner));
  return nb::cast(nb::ndarray<nb::numpy, const T>(column.data(), 1, &n, owner));
}

class OnTileStage : public stages::OptionStage<OnTileOptions> {
 public:
  explicit OnTileStage(const OnTile& on_tile) : on_tile_(on_tile) { options = {on_tile.halo, on_tile.code}; }
  const stages::Info& info() const override {
    static const stages::Info info{"python.on_tile",
                                   "A function of the caller's on every tile with its halo.",
                                   {stages::Grain::tile},
                                   needed,
                                   {Column::classification},
                                   {stages::Product::points},
                                   {}};
    return info;
  }
  ColumnSet also_reads() const override { return on_tile_.columns; }
  double halo() const override { return options.halo.value; }
  stages::TileMemory memory(const stages::Context&) const override { return {bytes_per_point}; }

  /// The function gets columns as views, metres relative to `origin`, the tile's `own` points first. It returns nothing, having written to
  /// the classes, or the own points' classes.
  void run_tile(const stages::Context&, stages::TileJob& job) const override {
    if (job.own == 0) return;
    auto block = std::make_shared<core::Block>(std::move(job.block));
    {
      const nb::gil_scoped_acquire lock;
      nb::dict columns;
      core::for_each_column([&](Column c, std::string_view name, auto member) {
        if (!((*block).*member).empty())
          columns[nb::str(name.data(), name.size())] = view_of((*block).*member, block, c == Column::classification);
      });
      const nb::object classes = on_tile_.function(columns, job.own, nb::make_tuple(job.box.x0, job.box.y0, job.box.x1, job.box.y1),
                                                   nb::make_tuple(block->origin.x(), block->origin.y(), block->origin.z()));
      if (!classes.is_none()) {
        const auto given = nb::cast<AnyArray>(classes);
        const std::uint8_t* from = column_of<std::uint8_t>(given, job.own, "the classes that the function returned");
        std::copy(from, from + job.own, block->classification.begin());
      }
    }
    if (block.use_count() == 1)
      job.block = std::move(*block);
    else
      job.block = *block;  // the caller has kept a view
  }

 private:
  const OnTile& on_tile_;
};

}  // namespace

stages::Entry on_tile_stage(const OnTile& on_tile) {
  return {"python.on_tile", [&on_tile] { return std::make_unique<OnTileStage>(on_tile); }};
}

}  // namespace swath::python
