// SPDX-License-Identifier: GPL-3.0-or-later
// What a stage is. A stage is thin: it adapts a free function of a lower room to the engine's three grains of work.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/area.h"
#include "core/block.h"
#include "core/config/option.h"
#include "core/config/result.h"
#include "core/geo/geodesy.h"
#include "core/grid.h"
#include "core/on_progress.h"
#include "core/report.h"
#include "core/shot.h"
#include "io/survey/survey.h"
#include "stages/records.h"

namespace swath::stages {

/// The unit a stage works on (house plan, section 2). `merge` joins what crosses the tiles' edges.
enum class Grain { survey, strip, tile, merge };
std::string_view name_of(Grain g);

struct Info {
  std::string_view name;
  std::string_view summary;  ///< one sentence
  std::vector<Grain> grains;
  core::ColumnSet needs, gives;
  std::vector<Product> needs_products, gives_products;
  std::vector<Product> uses_products{};  ///< where they are there, beside those it needs
  bool uses(Product p) const { return takes(p) || std::find(uses_products.begin(), uses_products.end(), p) != uses_products.end(); }
  bool takes(Product p) const { return std::find(needs_products.begin(), needs_products.end(), p) != needs_products.end(); }
  bool makes(Product p) const { return std::find(gives_products.begin(), gives_products.end(), p) != gives_products.end(); }
};

/// A square of the survey's tiling: [ix, ix+1) x [iy, iy+1) times the tile's side, map metres.
struct TileKey {
  int ix = 0, iy = 0;
  auto operator<=>(const TileKey&) const = default;
};

using core::Area;
using core::Box;

/// The cells whose centres lie in the box.
core::Lattice lattice_in(double cell, const Box& box);

/// Where the grids of earlier stages are found.
class Grids {
 public:
  virtual ~Grids() = default;
  virtual bool has(Product product) const = 0;
  /// The window of a product's surface, from as many tiles as it touches; void (no_data) outside them.
  virtual core::Grid window(Product product, const core::Lattice& lattice) const = 0;
  /// Folder of the stage that gives the product.
  virtual std::filesystem::path folder(Product product) const = 0;
  /// Side of the product's cells, m.
  virtual double cell(Product product) const = 0;
};

/// One flight line of one source, read and georeferenced on its own.
struct Strip {
  size_t source = 0;  ///< index in the survey's [[laser]] or [[points]]
  size_t index = 0;   ///< index within the source
  int line = 0;       ///< flight line id
  std::string name;   ///< "line 3 of flight.las", for messages
  std::uint64_t records = 0;
  /// Times of its first and last record as recorded, GPS time s; not a number where they are not known.
  double first_time = std::numeric_limits<double>::quiet_NaN(), last_time = std::numeric_limits<double>::quiet_NaN();
};

/// A raster that a stage works on, for the memory that it takes.
struct Raster {
  std::string_view option;        ///< of the stage, that sets the cells; empty where none does
  double cell = 1.0;              ///< side of a cell, m
  double side = 0.0;              ///< of the square that the raster covers, m
  double bytes = 0.0;             ///< of working memory per cell
  double cells_per_point = 0.0;   ///< most cells that a point makes, where only those are kept; 0: every cell is there
  std::string_view widened_by{};  ///< option of the stage that makes the square wider than the tile; empty where none does
  /// m: of the square there is only what the points' box covers with so much around it; infinite: all of it.
  double rim = std::numeric_limits<double>::infinity();

  /// Bytes, where `points` are worked on.
  double total(double points) const {
    const double cells = (side / cell) * (side / cell);
    return bytes * (cells_per_point > 0.0 && points * cells_per_point < cells ? points * cells_per_point : cells);
  }
};

/// What a tile at work takes beside its columns.
struct TileMemory {
  double bytes_per_point = 64.0;  ///< of tile and near halo
  std::vector<Raster> rasters{};  ///< needed however few points there are
  double share_of_points = 1.0;   ///< that those bytes are for: less than 1 where a stage leaves the halo's far points out
  double bytes_per_own = 0.0;     ///< more of the tile's own points, once the rasters that have a rim are gone
};

class Stage;
struct Context;

/// The rasters of a stage that works on a tile's window of a grid and on `others` grids of that size made from it; none where the run has
/// no such grid (yet).
std::vector<Raster> window_of(const Context& context, Product product, int others);

/// What every stage sees of a run. Read-only but for what survey stages hand on, and `origin`, which follows from the trajectory.
struct Context {
  const io::Survey& survey;
  core::Crs crs{};
  std::string product_crs{};                   ///< of the files written: `crs`, with an explicit height unit where the CRS leaves it open
  std::string heights{core::unknown_heights};  ///< what the run's heights count from, for files and reports
  double unit = 1.0;                           ///< metres per horizontal unit of the CRS
  double vertical_unit = 1.0;                  ///< metres per vertical unit of the CRS
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< of every Block of the run, m
  Area area{};                                       ///< of the run: what lies outside is left out
  bool weekless = false;                             ///< times are seconds of a GPS week that no file names: written on as such
  std::array<std::uint8_t, 16> project{};            ///< identifier of all files of the run
  int creation_year = 0, creation_day = 0;           ///< UTC, day of year from 1; 0 0: not stated
  int threads = 1;
  double memory = 2e9;                           ///< bytes that a survey stage or merge may take
  double tile_side = 500.0;                      ///< m
  std::filesystem::path output{};                ///< where the stage at work puts its products, laid out as in the output folder
  std::vector<std::filesystem::path> earlier{};  ///< the same of the stages before it
  std::vector<std::string> planned{};            ///< products of the stages before it, while a plan is checked
  core::OnProgress progress = core::unwatched;   ///< of the survey stage or merge at work
  const Grids* grids = nullptr;
  const Stage* source = nullptr;     ///< of the plan; null where it has none
  core::ColumnSet unread{};          ///< columns of the source's points that no stage of the run reads
  std::vector<Strip> strips{};       ///< of the source, in the order of the work
  Records records{};                 ///< that survey stages handed on
  std::vector<Product> last_uses{};  ///< of records that no stage behind the one at work needs

  Box box_of(TileKey k) const { return {k.ix * tile_side, k.iy * tile_side, (k.ix + 1) * tile_side, (k.iy + 1) * tile_side}; }
  /// The file that a stage before this one made under `name`; empty where none did.
  std::filesystem::path made(const std::filesystem::path& name) const;
  /// "652000_5310500": the tile's south-west corner in units of the CRS, for file names. Millimetres where it is not whole metres; in other
  /// units the nearest whole one.
  std::string label(TileKey k) const;
};

/// A batch of one strip on its way: raw shots first, a block after georeferencing.
struct StripBatch {
  int line = 0;
  size_t source = 0;  ///< index in the survey's [[laser]] or [[points]]
  core::Shots shots;
  core::Block block;
};

/// Streams one strip. next() is false at the end.
class StripReader {
 public:
  virtual ~StripReader() = default;
  virtual bool next(StripBatch& batch, size_t most, core::Tally& tally) = 0;
};

/// Calls a function with all points of a tile, some at a time, in their order.
using PointStream = std::function<void(const std::function<void(core::Block&)>&)>;

/// One tile at work: its own points first, then those of the halo. `own` counts the former.
struct TileJob {
  TileKey key;                   ///< of the first, where a filter gets several tiles at once
  Box box;                       ///< around them all
  std::filesystem::path folder;  ///< the stage's own folder for intermediate results
  core::Block block;
  size_t own = 0;
  core::Tally tally;
  PointStream stream{};  ///< the points of a stage that is_streamed(); `block` is empty then
};

/// The merge of one stage: all tiles, in order.
struct MergeJob {
  std::filesystem::path folder;
  std::vector<TileKey> tiles;
  core::Tally tally;
  core::Value findings = core::Value::object();  ///< goes to the report under the stage
  core::Tally of_tiles{};                        ///< what the tiles have counted
};

/// A stage of a plan. Every method that runs is const and may run in parallel with itself.
class Stage {
 public:
  virtual ~Stage() = default;
  virtual const Info& info() const = 0;
  virtual void visit(core::Visitor& v) = 0;

  /// The results that it declares, of a sample without values: documentation and texts are made from them. What it counts is under `tally`
  /// in the report, what it finds under `findings`.
  virtual void visit_counts(core::ResultVisitor&) const {}
  virtual void visit_findings(core::ResultVisitor&) const {}

  /// The stage whose findings this one uses: put in front of it where the plan does not name it; empty: none. `cloud`: the plan's points
  /// come georeferenced.
  virtual std::string_view implied([[maybe_unused]] bool cloud) const { return {}; }

  /// Conditions that only the survey can settle; faults are thrown as core::Error before any byte is read.
  virtual void check(const Context&) const {}

  /// About the bytes that a survey stage takes beside the records given to it; 0: few.
  virtual double survey_memory(const Context&) const { return 0.0; }
  virtual void run_survey(Context&, core::Tally&, core::Value& /*findings*/) const {}

  virtual bool is_source() const { return false; }
  /// The CRS of the source's own coordinates, for surveys that state none.
  virtual std::string own_crs(const io::Survey&) const { return {}; }
  /// Sets context.origin from the source's own coordinates, and context.heights where the CRS leaves them open; sources of raw shots leave
  /// both to the trajectory.
  virtual void locate(Context&) const {}
  virtual std::vector<Strip> strips(const Context&, core::Tally&) const { return {}; }
  virtual std::unique_ptr<StripReader> open(const Context&, const Strip&) const { return nullptr; }
  /// Files whose content decides the result (hashed for provenance and resume).
  virtual std::vector<std::filesystem::path> inputs(const io::Survey&) const { return {}; }

  virtual void run_strip(const Context&, StripBatch&, core::Tally&) const {}

  /// Columns a tile stage reads where they are there, beside those it needs.
  virtual core::ColumnSet also_reads() const { return {}; }
  /// Metres of points around a tile that its result depends on.
  virtual double halo() const { return 0.0; }
  /// Metres within which it depends on every point; of those farther off, on the ones that thin() leaves.
  virtual double near_halo() const { return halo(); }
  /// Takes out of points around the box `tiles` those that the result does not depend on; keeps the order of the others.
  virtual void thin(const Context&, const Box& /*tiles*/, core::Block& /*around*/) const {}
  /// Points per square metre beyond near_halo() that thin() leaves at most; infinite where it leaves all.
  virtual double left_per_area() const { return std::numeric_limits<double>::infinity(); }
  /// Working memory of one tile of the context's side. In a plan there are no `grids` yet, and rasters whose cells they set are left out.
  virtual TileMemory memory(const Context&) const { return {}; }
  /// Side of the cells of the grids that the stage gives, m; 0 where it gives none or takes them from a grid. A stage that needs several
  /// grids needs them with the same cells.
  virtual double cell() const { return 0.0; }
  virtual void run_tile(const Context&, TileJob&) const {}
  /// False where the survey has nothing that the work on tiles is for: no point is kept or read for it, and the merge runs without tiles.
  virtual bool has_tile_work(const io::Survey&) const { return true; }
  /// Does a tile's work take its points from TileJob::stream, some at a time?
  virtual bool is_streamed() const { return false; }
  /// Can a tile that does not fit into memory be worked on in parts, each with its own halo and folder, with the same result?
  virtual bool is_divisible() const { return !info().gives.empty() && info().gives_products.empty(); }
  /// Makes of the files in the folders of a tile's parts those of the tile in `whole.folder`. `whole` has no points.
  virtual void join_parts(const Context&, const TileJob& /*whole*/, const std::vector<std::filesystem::path>& /*parts*/) const {}

  virtual void run_merge(const Context&, MergeJob&) const {}

  /// Names within the output folder of the files and folders that the stage makes; each belongs to one stage of a plan.
  virtual std::vector<std::string> products() const { return {}; }

  /// A record that the stage declares; null where there is none.
  template <Record R>
  const R* record(const Context& context) const {
    if (!info().uses(Product::of<R>()))
      throw core::Error("uses the " + std::string(RecordName<R>::value) + ", which it does not declare", std::string(info().name),
                        "this is a fault of the program");
    return context.records.find<R>();
  }

  bool works_on(Grain g) const {
    for (const Grain mine : info().grains)
      if (mine == g) return true;
    return false;
  }
};

/// The files of one of the survey's lists, as Stage::inputs.
template <auto list>
std::vector<std::filesystem::path> files_in(const io::Survey& survey) {
  std::vector<std::filesystem::path> out;
  for (const auto& f : survey.*list) out.push_back(io::resolve(survey, f.file));
  return out;
}

/// A stage without options, or without declared results.
struct NoOptions {};
template <class V>
void describe(NoOptions&, V&) {}
struct NoResults {};
template <class V>
void describe(const NoResults&, V&) {}

/// A stage with a struct of options and structs of results: what it counts and what it finds.
template <class O, class Counts = NoResults, class Findings = NoResults>
class OptionStage : public Stage {
 public:
  void visit(core::Visitor& v) override { describe(options, v); }
  void visit_counts(core::ResultVisitor& v) const override { describe(Counts{}, v); }
  void visit_findings(core::ResultVisitor& v) const override { describe(Findings{}, v); }
  O options;
};

}  // namespace swath::stages
