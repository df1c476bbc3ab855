// SPDX-License-Identifier: GPL-3.0-or-later
// A stage that works on strips or tiles, and one that joins what its tiles have left, is made of free functions, too:
//
//   Tiled<CellCounts, Product::dsm> model_surface(const TileJob& job, const terrain::DsmOptions& o);
//   DtmFindings judge_cover(const MergeJob& job, const Context& context);
//
// Their signatures say what they need and give. Parameters, in any order, beside those of once.h (but a record by value, and shots):
// clang-format off
//   TileJob&, MergeJob&, StripBatch&   the work, const where it is only read
//   const In<Product::dtm>&            the grid of a stage before this one
//   RunCache&                          what all tiles of the stage share
// clang-format on
// Functions on strips and tiles return their counts, with the grids that they make of a tile (Tiled); those that merge return what they
// have found, or with counts of their own (Found).
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <typeindex>

#include "core/tile_columns.h"
#include "stages/grid_tile.h"
#include "stages/once.h"

namespace swath::stages {

/// A grid of a stage before this one.
template <const Product& product>
struct In {
  const Grids& grids;
  double cell() const { return grids.cell(product); }
  core::Lattice lattice(const Box& box) const { return lattice_in(cell(), box); }
  core::Grid window(const core::Lattice& lattice) const { return grids.window(product, lattice); }
  core::Grid over(const Box& box) const { return window(lattice(box)); }
};

/// What all tiles of a stage share, one thing of each type: made by the first that asks. What makes it must not ask for another.
class RunCache {
 public:
  template <class F>
  const std::invoke_result_t<F>& get(F&& make) {
    using T = std::invoke_result_t<F>;
    const std::lock_guard lock(mutex_);
    std::shared_ptr<const void>& kept = kept_[typeid(T)];
    if (!kept) kept = std::shared_ptr<const T>(new const T(make()));
    return *static_cast<const T*>(kept.get());
  }
  /// Null where no tile has asked for it.
  template <class T>
  const T* find() {
    const std::lock_guard lock(mutex_);
    return static_cast<const T*>(kept_[typeid(T)].get());
  }

 private:
  std::mutex mutex_;
  std::map<std::type_index, std::shared_ptr<const void>> kept_;
};

/// The counts of a tile and the grids that it has made; of several each has a folder of its own in the stage's.
template <class C, const Product&... products>
struct Tiled {
  C counts;
  std::array<core::Grid, sizeof...(products)> grids;
};

/// What a merge has found, and what it has counted.
template <class F, class C>
struct Found {
  F findings;
  C counts;
};

/// A stage at work on one piece.
template <class J>
struct JobSite {
  const Context& context;
  J& job;
  core::Tally& tally;
  RunCache& cache;
};
template <class J>
concept Job = std::same_as<J, TileJob> || std::same_as<J, MergeJob> || std::same_as<J, StripBatch>;
template <Job J>
struct Argument<J&> : PlainArgument {
  static J& of(JobSite<J>& s) { return s.job; }
};
template <Job J>
struct Argument<const J&> : Argument<J&> {};
template <>
struct Argument<RunCache&> : PlainArgument {
  static RunCache& of(auto& s) { return s.cache; }
};
template <const Product& product>
struct Argument<const In<product>&> {
  static void declare(Info& info) {
    if (!info.takes(product)) info.needs_products.push_back(product);
  }
  static In<product> of(auto& s) { return {*s.context.grids}; }
};

/// What a function on strips or tiles returns.
template <class T>
struct Counted {
  using Counts = T;
  static constexpr std::array<Product, 0> grids{};
};
template <>
struct Counted<void> : Counted<NoResults> {};
template <class C, const Product&... products>
struct Counted<Tiled<C, products...>> {
  using Counts = C;
  static constexpr std::array<Product, sizeof...(products)> grids{products...};
};

/// What a function that merges returns.
template <class T>
struct Merged {
  using Findings = T;
  using Counts = NoResults;
};
template <>
struct Merged<void> : Merged<NoResults> {};
template <class T>
struct Merged<std::optional<T>> : Merged<T> {};
template <class F, class C>
struct Merged<Found<F, C>> {
  using Findings = F;
  using Counts = C;
};

/// What functions do not say of themselves; each may be left out.
template <class O>
struct TileExtras {
  core::TileColumns columns{};                                  ///< none: the functions work without points
  std::vector<Product> needs{}, gives{};                        ///< beside those of the signatures
  core::ColumnSet (*reads)(const O&) = nullptr;                 ///< as Stage::also_reads, where it depends on options
  double (*halo)(const O&) = nullptr;                           ///< as Stage::halo; otherwise the halo() beside the options
  TileMemory (*memory)(const O&, const Context&) = nullptr;     ///< as Stage::memory
  std::string_view (*implied)(const O&, bool cloud) = nullptr;  ///< as Stage::implied
  void (*check)(const Context&, const O&) = nullptr;
  bool (*has_tile_work)(const io::Survey&) = nullptr;  ///< as Stage::has_tile_work
  std::vector<std::filesystem::path> (*inputs)(const io::Survey&) = nullptr;
  std::vector<std::filesystem::path> (*files)(const io::Survey&, const O&) = nullptr;  ///< inputs that options name, beside those
  std::vector<std::string> (*products)(const O&) = nullptr;
  bool is_streamed = false;
  /// As Stage::join_parts; grids made of points alone are joined in any case.
  void (*join_parts)(const Context&, const TileJob&, const std::vector<std::filesystem::path>&) = nullptr;
};

/// The halo() beside the options; 0 where there is none. (Within a class its member of that name would hide it.)
template <class O>
double halo_of(const O& o) {
  if constexpr (requires { halo(o); })
    return halo(o);
  else
    return 0.0;
}

/// The functions of a stage; nullptr where it has none of that kind.
template <auto strip, auto tile, auto merge>
struct Functions {
  using Strip = Signature<decltype(strip)>;
  using Tile = Signature<decltype(tile)>;
  using Merge = Signature<decltype(merge)>;
  template <class A, class B>
  using Either = std::conditional_t<std::same_as<A, NoOptions>, B, A>;
  using Options = Either<typename Strip::Options, Either<typename Tile::Options, typename Merge::Options>>;
  static constexpr bool on_strips = !std::same_as<decltype(strip), std::nullptr_t>;
  static constexpr bool on_tiles = !std::same_as<decltype(tile), std::nullptr_t>;
  static constexpr bool merges = !std::same_as<decltype(merge), std::nullptr_t>;
  using Work = Counted<std::conditional_t<on_strips, typename Strip::Result, typename Tile::Result>>;
  using Joined = Merged<typename Merge::Result>;
  using Counts = std::conditional_t<std::same_as<typename Work::Counts, NoResults>, typename Joined::Counts, typename Work::Counts>;
};

template <auto strip, auto tile, auto merge, class F = Functions<strip, tile, merge>>
class WorkStage : public OptionStage<typename F::Options, typename F::Counts, typename F::Joined::Findings> {
 public:
  using Options = typename F::Options;

  WorkStage(std::string_view name, std::string_view summary, TileExtras<Options> extras)
      : info_{name, summary, {}, extras.columns.needs, extras.columns.gives, {}, {}}, extras_(extras) {
    if (F::on_strips) info_.grains.push_back(Grain::strip);
    if (F::on_tiles) info_.grains.push_back(Grain::tile);
    if (F::merges) info_.grains.push_back(Grain::merge);
    const core::ColumnSet columns = extras.columns.needs | extras.columns.reads | extras.columns.gives;
    if (columns != core::ColumnSet{} && !F::on_strips) info_.needs_products.push_back(Product::points);
    info_.needs_products.insert(info_.needs_products.end(), extras.needs.begin(), extras.needs.end());
    F::Strip::declare(info_);
    F::Tile::declare(info_);
    F::Merge::declare(info_);
    info_.gives_products.assign(F::Work::grids.begin(), F::Work::grids.end());
    info_.gives_products.insert(info_.gives_products.end(), extras.gives.begin(), extras.gives.end());
  }
  const Info& info() const override { return info_; }
  core::ColumnSet also_reads() const override { return extras_.reads ? extras_.reads(this->options) : extras_.columns.reads; }
  double halo() const override { return extras_.halo ? extras_.halo(this->options) : halo_of(this->options); }
  TileMemory memory(const Context& c) const override { return extras_.memory ? extras_.memory(this->options, c) : TileMemory(); }
  std::string_view implied(bool cloud) const override { return extras_.implied ? extras_.implied(this->options, cloud) : ""; }
  void check(const Context& c) const override {
    if (extras_.check) extras_.check(c, this->options);
  }
  std::vector<std::filesystem::path> inputs(const io::Survey& s) const override {
    std::vector<std::filesystem::path> out;
    if (extras_.inputs) out = extras_.inputs(s);
    if (!extras_.files) return out;
    for (std::filesystem::path& file : extras_.files(s, this->options)) out.push_back(std::move(file));
    return out;
  }
  std::vector<std::string> products() const override {
    return extras_.products ? extras_.products(this->options) : std::vector<std::string>{};
  }
  bool has_tile_work(const io::Survey& s) const override { return !extras_.has_tile_work || extras_.has_tile_work(s); }
  bool is_streamed() const override { return extras_.is_streamed; }
  double cell() const override {
    if constexpr (requires { this->options.cell.value; })
      if (makes_grids_of_points()) return this->options.cell.value;
    return 0.0;
  }
  bool is_divisible() const override { return extras_.join_parts || makes_grids_of_points() || Stage::is_divisible(); }
  void join_parts(const Context& c, const TileJob& whole, const std::vector<std::filesystem::path>& parts) const override {
    if (extras_.join_parts) return extras_.join_parts(c, whole, parts);
    for (const Product p : F::Work::grids) {
      std::vector<std::filesystem::path> of_parts;
      for (const std::filesystem::path& part : parts) of_parts.push_back(folder_of(part, p));
      join_grid_parts(folder_of(whole.folder, p), whole.key, of_parts, lattice_in(cell(), whole.box));
    }
  }
  void run_strip(const Context& c, StripBatch& batch, core::Tally& tally) const override {
    if constexpr (F::on_strips) core::count_results(work<typename F::Strip>(strip, c, batch, tally), tally);
  }
  void run_tile(const Context& c, TileJob& job) const override {
    if constexpr (!F::on_tiles) {
      return;
    } else if constexpr (std::is_void_v<typename F::Tile::Result>) {
      work<typename F::Tile>(tile, c, job, job.tally);
    } else if constexpr (F::Work::grids.empty()) {
      core::count_results(work<typename F::Tile>(tile, c, job, job.tally), job.tally);
    } else {
      const auto made = work<typename F::Tile>(tile, c, job, job.tally);
      core::count_results(made.counts, job.tally);
      for (size_t k = 0; k < made.grids.size(); ++k) write_grid_tile(folder_of(job.folder, F::Work::grids[k]), job.key, made.grids[k]);
    }
  }
  void run_merge(const Context& c, MergeJob& job) const override {
    if constexpr (F::merges) {
      const std::optional found = work<typename F::Merge>(merge, c, job, job.tally);
      if (!found) return;
      if constexpr (std::same_as<typename F::Joined::Counts, NoResults>) {
        job.findings = core::reported(*found);
      } else {
        job.findings = core::reported(found->findings);
        core::count_results(found->counts, job.tally);
      }
    }
  }

 private:
  template <class S, class J>
  auto work(auto function, const Context& c, J& job, core::Tally& tally) const {
    JobSite<J> site{c, job, tally, cache_};
    return S::call(function, site, this->options);
  }
  bool makes_grids_of_points() const { return !F::Work::grids.empty() && info_.gives == core::ColumnSet{} && info_.takes(Product::points); }
  static std::filesystem::path folder_of(const std::filesystem::path& folder, Product p) {
    return F::Work::grids.size() == 1 ? folder : folder / name_of(p);
  }

  Info info_;
  TileExtras<Options> extras_;
  mutable RunCache cache_;
};

template <auto s, auto t, auto m>
Entry work_entry(std::string_view name, std::string_view summary, TileExtras<typename Functions<s, t, m>::Options> extras) {
  return {name, [=] { return std::make_unique<WorkStage<s, t, m>>(name, summary, extras); }};
}
template <auto function>
Entry strip(std::string_view name, std::string_view summary, TileExtras<typename Functions<function, nullptr, nullptr>::Options> extras) {
  return work_entry<function, nullptr, nullptr>(name, summary, extras);
}
template <auto function, auto merge_function = nullptr>
Entry tile(std::string_view name, std::string_view summary,
           TileExtras<typename Functions<nullptr, function, merge_function>::Options> extras) {
  return work_entry<nullptr, function, merge_function>(name, summary, extras);
}
template <auto function>
Entry merge(std::string_view name, std::string_view summary, TileExtras<typename Functions<nullptr, nullptr, function>::Options> extras) {
  return work_entry<nullptr, nullptr, function>(name, summary, extras);
}

}  // namespace swath::stages
