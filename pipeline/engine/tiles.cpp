// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/tiles.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/config/result_visitors.h"
#include "io/raster/grid_file.h"
#include "io/text/output_file.h"
#include "pipeline/stage_memory.h"
#include "pipeline/tile_queue.h"
#include "pipeline/tile_work.h"
#include "pipeline/work/released_points.h"
#include "stages/waters.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;
using stages::Grain;

constexpr const char *groups_file = "groups.done", *merge_file = "merge.done";

/// What a group takes to work on, for the progress: its memory holds the points around it and its rasters, and so one point alone in a tile
/// is not taken for next to nothing.
double work_of(const TileGroup& g) { return 1.0 + static_cast<double>(g.bytes); }

fs::path done_file(const RunState& run, size_t number, const TileBox& box) {
  return run.folder(number) / (file_label(box.low) + (box.low == box.high ? "" : "_to_" + file_label(box.high)) + ".done");
}

fs::path done_file(const RunState& run, size_t number, const TileGroup& group) { return done_file(run, number, TileBox(group.tiles)); }

/// The tiles with points, and for what is made of surfaces also those that triangles of their neighbours' points reach into: the surface
/// does not depend on where the tiles' borders lie.
std::vector<TileKey> tiles_of(const RunState& run, size_t number) {
  const stages::Info& info = run.stage(number).info();
  std::set<TileKey> keys;
  if (info.gives.empty() && (has_surface(info.gives_products) || has_surface(info.needs_products))) keys = run.surface_tiles;
  for (const auto& [key, n] : run.store->tiles()) keys.insert(key);
  return {keys.begin(), keys.end()};
}

/// Tiles without points that water of known height lies in, between the survey's own tiles.
std::set<TileKey> tiles_of_water(const RunState& run) {
  std::set<TileKey> out;
  if (run.store->tiles().empty()) return out;
  std::vector<TileKey> keys;
  for (const auto& [key, n] : run.store->tiles()) keys.push_back(key);
  const auto [low, high] = TileBox(keys);
  const auto tile = [&](double edge) { return std::floor(edge / run.context.tile_side); };
  for (const stages::Box& water : stages::waters_of(run.context)) {
    // As numbers: water may reach far beyond the survey.
    const double x0 = std::max<double>(low.ix, tile(water.x0)), x1 = std::min<double>(high.ix, tile(water.x1));
    const double y0 = std::max<double>(low.iy, tile(water.y0)), y1 = std::min<double>(high.iy, tile(water.y1));
    for (double iy = y0; iy <= y1; ++iy)
      for (double ix = x0; ix <= x1; ++ix)
        if (const TileKey key{static_cast<int>(ix), static_cast<int>(iy)}; !run.store->tiles().contains(key)) out.insert(key);
  }
  return out;
}

/// A tile without points in which the surface says nothing: it is not part of the survey.
bool is_void_fringe(const RunState& run, size_t number, const TileGroup& group) {
  const TileKey key = group.tiles[0];
  const fs::path file = stages::grid_file(run.folder(number), key);
  if (run.store->tiles().contains(key) || run.surface_tiles.contains(key) || !fs::exists(file)) return false;
  const core::Grid grid = io::read_grid_file(file);
  return std::all_of(grid.reason.begin(), grid.reason.end(), [](core::Void r) { return r == core::Void::no_data; });
}

/// Of the tiles without points only those stay in which the surface says anything.
void keep_surface_tiles(RunState& run, size_t number, const std::set<TileKey>& fringe) {
  for (const TileKey key : fringe)
    if (fs::exists(stages::grid_file(run.folder(number), key))) run.surface_tiles.insert(key);
}

/// Tiles are joined only where they give nothing but points' columns. A tile that does not fit is cut into parts.
std::vector<TileGroup> groups_of(RunState& run, size_t number, const std::vector<TileKey>& keys, std::uint64_t budget) {
  const stages::Info& info = run.stage(number).info();
  const StageMemory memory(*run.store, run.stage(number), run.context);
  const Measure measure = [&](std::vector<TileKey> tiles) { return memory.of(std::move(tiles)); };
  const auto fitted = [&](std::vector<TileGroup> groups) {
    for (TileGroup& g : groups)  // what is done is not done again, and its points may be gone
      if (!fs::exists(done_file(run, number, g))) g = memory.cut(std::move(g), budget, *run.squares);
    return groups;
  };
  if (info.gives.empty() || !info.gives_products.empty() || run.works_on(number, Grain::merge)) return fitted(single_tiles(keys, measure));
  // Those of a run that was killed, so that what it has done counts.
  const fs::path file = run.folder(number) / groups_file;
  if (run.share) {
    // Every process comes to the same groups, whatever it holds.
    const std::vector<TileGroup> groups = single_tiles(keys, measure);
    if (!fs::exists(file)) write_boxes(file, groups);
    return fitted(groups);
  }
  std::vector<TileGroup> groups = grouped_tiles(keys, read_boxes(file), measure), open;
  std::copy_if(groups.begin(), groups.end(), std::back_inserter(open),
               [&](const TileGroup& g) { return !fs::exists(done_file(run, number, g)); });
  size_t held = 0;
  for (const TileGroup& g : groups) held += g.tiles.size();
  if (held == keys.size() && most_bytes(open, run.threads) <= budget) return groups;
  groups = joined_tiles(keys, run.threads, budget, measure);
  write_boxes(file, groups);
  return fitted(std::move(groups));
}

/// Runs the stage on a group and keeps what it did: the tally and seconds.
PieceRecord run_group(RunState& run, size_t number, const TileGroup& group, bool has_water) {
  const stages::Info& info = run.stage(number).info();
  const fs::path mine = run.folder(number), done = done_file(run, number, group);
  stages::TileJob job{group.tiles[0], TileBox(group.tiles).metres(run.context.tile_side), mine, {}, 0, {}};
  const io::FinishedFiles finished;
  const io::UnflushedFiles checked_when_resumed;
  const Stopwatch watch(Whose::thread);
  TileWork(*run.store, run.context, run.stage(number)).run(group, job, has_water);
  std::vector<fs::path> by_stage = finished.files();
  std::vector<PieceFile> overlays;
  if (!info.gives.empty()) {
    size_t first = 0;
    for (const TileKey k : group.tiles) {
      const size_t count = group.tiles.size() == 1 ? job.own : run.store->tiles().at(k);
      overlays.push_back(run.store->write_overlay(mine, k, job.block, first, count, info.gives));
      first += count;
    }
  }
  if (is_void_fringe(run, number, group)) {
    const fs::path empty = stages::grid_file(mine, group.tiles[0]);
    std::erase(by_stage, empty);
    fs::remove(empty);
  }
  Account account;
  account.tally = std::move(job.tally);
  account.time = watch.spent();
  account.cut = group.parts > 1;
  PieceRecord record{piece_files(mine, by_stage), core::reported(account)};
  replace_files(record.files, std::move(overlays));
  write_record(done, record);
  return record;
}

/// Are the points of a tile needed no more once the stage has worked on it? A store that an earlier run has kept whole stays so.
bool releases(const RunState& run, size_t number) {
  return number == last_reader(run) && !run.keeps_store && !run.share && run.stage(number).halo() <= 0.0 &&
         run.stage(number).info().gives.empty();
}

/// The tiles that the stage works on.
struct StageTiles {
  std::vector<TileKey> keys;
  std::set<TileKey> fringe, wet;  ///< without points of their own; with water
};

StageTiles stage_tiles(const RunState& run, size_t number) {
  const stages::Info& info = run.stage(number).info();
  StageTiles out{tiles_of(run, number), {}, {}};
  if (has_surface(info.gives_products)) out.fringe = run.store->fringe(run.stage(number).halo());
  if (info.makes(stages::Product::dtm)) out.wet = tiles_of_water(run);
  out.fringe.insert(out.wet.begin(), out.wet.end());
  for (const TileKey key : out.fringe)
    if (!run.surface_tiles.contains(key)) out.keys.push_back(key);
  return out;
}

/// What the groups' pieces say goes to the stage's account.
void add_pieces(RunState& run, size_t number, const std::vector<TileGroup>& groups, std::vector<PieceRecord> pieces) {
  Account& account = run.accounts[number];
  account.in = account.out = run.store->points();
  for (size_t i = 0; i < pieces.size(); ++i) {
    const TileKey first = groups[i].tiles[0];
    std::optional<Account> one = account_of(pieces[i].note);
    if (!one) throw damaged_work(done_file(run, number, groups[i]));
    if (!run.store->tiles().contains(first) && !run.surface_tiles.contains(first)) one->tally = {};
    account.add(*one);
    for (PieceFile& f : pieces[i].files) run.made[number].push_back(std::move(f));
  }
}

/// Of several processes' groups those of this one, by points: what a group takes depends on what the process holds.
std::vector<TileGroup> own_groups(const RunState& run, const std::vector<TileGroup>& groups) {
  constexpr double points_of_a_tile = 1e4;  // what a tile takes that holds none
  std::vector<double> work;
  for (const TileGroup& g : groups) work.push_back(static_cast<double>(g.own) + points_of_a_tile);
  const std::vector<bool> mine = run.own_pieces(work);
  std::vector<TileGroup> out;
  for (size_t i = 0; i < groups.size(); ++i)
    if (mine[i]) out.push_back(groups[i]);
  return out;
}

void expect_done(const RunState& run, size_t number, const std::vector<TileGroup>& groups) {
  const auto open = std::count_if(groups.begin(), groups.end(), [&](const TileGroup& g) { return !fs::exists(done_file(run, number, g)); });
  if (open > 0)
    wave_too_early(run, std::to_string(open) + " of " + std::to_string(groups.size()) + " tiles of " +
                            std::string(run.stage(number).info().name) + " are missing");
}

/// Does a later stage read what the merge makes, its findings or a product? A surface is there with its tiles.
bool is_read_later(const RunState& run, size_t number) {
  const stages::Info& info = run.stage(number).info();
  const auto reads = [&](const stages::Stage& later) {
    return later.implied(true) == info.name || later.implied(false) == info.name ||
           std::any_of(info.gives_products.begin(), info.gives_products.end(),
                       [&](stages::Product p) { return !has_surface({p}) && later.info().uses(p); });
  };
  for (size_t i = number + 1; i < run.plan.stages.size(); ++i)
    if (reads(run.stage(i))) return true;
  return false;
}

void run_tiles(RunState& run, size_t number) {
  const stages::Info& info = run.stage(number).info();
  const StageTiles tiles = stage_tiles(run, number);
  const double left = run.memory.left(), free = std::max(0.0, left);
  const auto budget = static_cast<std::uint64_t>(free);
  const bool is_shared = run.shares(WaveKind::tiles, number);
  const std::vector<TileGroup> all = groups_of(run, number, tiles.keys, budget), groups = is_shared ? own_groups(run, all) : all;
  if (run.share && !is_shared) expect_done(run, number, groups);
  for (const TileGroup& g : groups)
    if (!fs::exists(done_file(run, number, g)))
      run.memory.require(static_cast<double>(g.bytes), left + run.memory.reserve(),
                         std::string(info.name) + " on the tile " + run.context.label(g.tiles[0]));
  std::vector<PieceRecord> notes(groups.size());
  std::vector<std::uint64_t> bytes;
  double work = 0.0;
  for (const TileGroup& g : groups) {
    bytes.push_back(fs::exists(done_file(run, number, g)) ? 0 : g.bytes);
    work += work_of(g);
  }
  const bool lets_go = releases(run, number);
  if (lets_go) {
    std::vector<fs::path> made;
    for (size_t i = run.last_strip_stage + 1; i < number; ++i) made.push_back(run.folder(i));
    note_release(run.folder(run.last_strip_stage), made);
  }
  run.progress.begin(std::string(info.name), run.store->points(), "points", work);
  TileQueue queue(std::move(bytes), budget);
  std::atomic<std::uint64_t> again{0};
  tbb::parallel_for(
      tbb::blocked_range<size_t>(0, groups.size(), 1),
      [&](const tbb::blocked_range<size_t>& range) {
        for (size_t turn = range.begin(); turn < range.end(); ++turn) {
          const TileQueue::Piece piece = queue.take();
          const TileGroup& group = groups[piece.number()];
          PieceRecord& note = notes[piece.number()];
          std::optional<PieceLock> lock;
          if (is_shared) lock.emplace(done_file(run, number, group));
          if (const fs::path done = done_file(run, number, group); fs::exists(done)) {
            std::optional<PieceRecord> read = read_record(done);
            if (!read) throw damaged_work(done);
            note = std::move(*read);
            ++again;
            run.progress.skip(group.own, work_of(group));
          } else {
            run.memory.make_room(group.bytes);
            note = run_group(run, number, group, tiles.wet.contains(group.tiles[0]));
            run.progress.advance(group.own, work_of(group));
          }
          if (lets_go) run.store->release(group.tiles[0]);
        }
      },
      tbb::simple_partitioner());
  run.progress.end();
  run.resumed += again;
  if (is_shared) return;
  keep_surface_tiles(run, number, tiles.fringe);
  add_pieces(run, number, groups, std::move(notes));
  if (!info.gives.empty()) run.store->add_overlay(run.folder(number), info.gives);
  for (const stages::Product p : info.gives_products) run.grids.add(p, run.folder(number));
  expect_made(run, number);
}

void run_merge(RunState& run, size_t number) {
  stages::MergeJob job{run.folder(number), {}, {}};
  job.tiles = tiles_of(run, number);
  job.of_tiles = run.accounts[number].tally;
  const Stopwatch watch(Whose::program);
  run.context.memory = run.memory.free();
  run.progress.begin(std::string(run.stage(number).info().name) + " merge", 0, "");
  const io::FinishedFiles finished;
  const io::UnflushedFiles flushed_when_delivered;
  run.stage(number).run_merge(run.context, job);
  replace_files(run.made[number], files_without_checksum(job.folder, finished.files()));
  run.progress.end();
  expect_balance(job.tally, run.stage(number));
  run.accounts[number].tally.add(job.tally);
  for (auto& [key, value] : job.findings.members()) run.accounts[number].findings[key] = std::move(value);
  run.accounts[number].time += watch.spent();
}

/// The first process that comes to a later wave merges for all. The last wave merges again, for the report.
void share_merge(RunState& run, size_t number) {
  if (!is_read_later(run, number)) return;
  const fs::path done = run.folder(number) / merge_file;
  const PieceLock lock(done);
  if (fs::exists(done)) return;
  std::vector<PieceFile> before = run.made[number];
  run.made[number].clear();
  run_merge(run, number);
  std::vector<fs::path> files;
  for (const PieceFile& f : run.made[number]) files.push_back(run.folder(number) / f.name);
  write_record(done, {piece_files(run.folder(number), std::move(files)), {}});
  replace_files(run.made[number], std::move(before));
}

}  // namespace

size_t last_reader(const RunState& run) {
  size_t last = run.last_strip_stage;
  for (size_t i = run.last_strip_stage + 1; i < run.plan.stages.size(); ++i)
    if (run.works_on(i, Grain::tile) && reads_points(run.stage(i))) last = i;
  return last;
}

bool is_tile_done(const RunState& run, size_t number, TileKey key) { return fs::exists(done_file(run, number, TileBox(key, key))); }

void expect_room_for_tiles(RunState& run) {
  const double left = run.memory.left(), free = std::max(0.0, left);
  double most = 0.0;
  std::string what;
  for (size_t i = run.last_strip_stage + 1; i < run.plan.stages.size(); ++i) {
    if (!run.works_on(i, Grain::tile)) continue;
    const StageMemory memory(*run.store, run.stage(i), run.context);
    std::vector<TileBox> done = read_boxes(run.folder(i) / groups_file);
    std::erase_if(done, [&](const TileBox& box) { return !fs::exists(done_file(run, i, box)); });
    for (const auto& [key, n] : run.store->tiles()) {
      const auto holds = [k = key](const TileBox& box) { return box.holds(k); };
      if (fs::exists(done_file(run, i, TileBox(key, key))) || std::any_of(done.begin(), done.end(), holds)) continue;
      const auto bytes = static_cast<double>(memory.cut(memory.of({key}), static_cast<std::uint64_t>(free), *run.squares).bytes);
      if (bytes <= most) continue;
      most = bytes;
      what = std::string(run.stage(i).info().name) + " on the tile " + run.context.label(key) + " of " + core::counted(n, "point");
    }
  }
  if (most > 0.0) run.memory.require(most, left, what);
}

void run_tile_stages(RunState& run) {
  for (size_t i = run.last_strip_stage + 1; i < run.plan.stages.size(); ++i) {
    if (!run.works_on(i, Grain::tile) && !run.works_on(i, Grain::merge)) continue;
    if (run.share && !run.works_on(i, Grain::tile) && !is_read_later(run, i)) continue;
    begin_products(run, i);
    if (run.works_on(i, Grain::tile))
      run_tiles(run, i);
    else
      for (const stages::Product p : run.stage(i).info().gives_products) run.grids.add(p, run.folder(i));
    if (run.shares(WaveKind::tiles, i)) return;
    if (run.works_on(i, Grain::merge)) run.share ? share_merge(run, i) : run_merge(run, i);
    if (!run.works_on(i, Grain::survey)) run.context.earlier.push_back(run.context.output);
    // What a comparison alone says of data that are refused is not kept.
    run.has_products = run.has_products || (!run.stage(i).info().name.starts_with("quality.") && fs::exists(run.context.output));
  }
}

}  // namespace swath::pipeline
