// SPDX-License-Identifier: GPL-3.0-or-later
// A filter is a free function on the points of a tile:
//
//   SmrfCounts classify_ground_smrf(core::Block& block, size_t own, const SmrfOptions& o);
//
// Beside it stand the describe() of its options and of its counts, columns(o) (core/tile_columns.h) and, where its result depends on points
// around the tile, halo(o). registry.cpp makes a stage of it in one line:
//
//   ground_filter<filters::classify_ground_smrf>("filters.smrf", "Ground points by ..."),
#pragma once

#include <memory>
#include <string_view>
#include <utility>

#include "stages/kept_classes.h"
#include "stages/stage.h"
#include "stages/tile.h"
#include "stages/tile_memory.h"

namespace swath::stages {

template <class F>
struct FilterSignature;
template <class R, class O>
struct FilterSignature<R (*)(core::Block&, size_t, const O&)> {
  using Counts = R;
  using Options = O;
};
template <auto function>
using OptionsOf = typename FilterSignature<decltype(function)>::Options;
template <auto function>
using CountsOf = typename FilterSignature<decltype(function)>::Counts;

/// What only some filters need.
struct FilterExtras {
  void (*check)(const Context&, std::string_view stage, core::TileColumns columns) = nullptr;  ///< as Stage::check
};

/// `All`: the function's options, or a struct that adds some to them.
template <auto function, class All = OptionsOf<function>>
class TileFilter : public OptionStage<All, CountsOf<function>> {
 public:
  TileFilter(std::string_view name, std::string_view summary, FilterExtras extras = {})
      : info_{name, summary, {Grain::tile}, columns(OptionsOf<function>{}).needs, columns(OptionsOf<function>{}).gives, {Product::points},
              {}},
        extras_(extras) {}

  const Info& info() const override { return info_; }
  core::ColumnSet also_reads() const override { return columns(own_options()).reads; }
  void check(const Context& context) const override {
    if (extras_.check) extras_.check(context, info_.name, columns(own_options()));
  }
  double halo() const override { return halo_of(own_options()); }
  TileMemory memory(const Context& c) const override { return memory_of(own_options(), c.tile_side); }
  void run_tile(const Context&, TileJob& job) const override {
    core::count_results(function(job.block, job.own, own_options()), job.tally);
  }

 protected:
  const OptionsOf<function>& own_options() const { return this->options; }

 private:
  Info info_;
  FilterExtras extras_;
};

/// A filter that gives classes, with the choice of those that stay. `gives_ground`: it says what is ground, so that where ground is kept
/// it changes no class.
template <auto function, bool gives_ground>
class ClassFilter : public TileFilter<function, Keeping<OptionsOf<function>>> {
 public:
  using TileFilter<function, Keeping<OptionsOf<function>>>::TileFilter;

  void visit_counts(core::ResultVisitor& v) const override {
    describe(CountsOf<function>{}, v);
    describe(KeptCount{}, v);
  }
  void run_tile(const Context&, TileJob& job) const override {
    const KeptClasses kept(job.block, this->options.keep_classes);
    const auto counts = function(job.block, job.own, this->own_options());
    core::count_results(kept.put_back(job.block, job.own, gives_ground), job.tally);
    core::count_results(counts, job.tally);
  }
};

template <class S>
Entry entry_of(std::string_view name, std::string_view summary, FilterExtras extras) {
  return {name, [=] { return std::make_unique<S>(name, summary, extras); }};
}

template <auto function>
Entry filter(std::string_view name, std::string_view summary, FilterExtras extras = {}) {
  return entry_of<TileFilter<function>>(name, summary, extras);
}
template <auto function>
Entry class_filter(std::string_view name, std::string_view summary, FilterExtras extras = {}) {
  return entry_of<ClassFilter<function, false>>(name, summary, extras);
}
template <auto function>
Entry ground_filter(std::string_view name, std::string_view summary, FilterExtras extras = {}) {
  return entry_of<ClassFilter<function, true>>(name, summary, extras);
}

}  // namespace swath::stages
