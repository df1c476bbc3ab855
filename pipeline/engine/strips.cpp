// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/strips.h"

#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "core/config/result_visitors.h"
#include "io/las/las_ending.h"
#include "io/las/las_header.h"
#include "io/las/las_source.h"
#include "io/survey/survey.h"
#include "io/text/value_file.h"
#include "pipeline/engine/fullest_tile.h"
#include "pipeline/engine/pulse_border.h"
#include "pipeline/engine/tiles.h"
#include "pipeline/expected_time.h"
#include "pipeline/stage_memory.h"
#include "pipeline/tile_work.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;
using core::Value;
using stages::Grain;

constexpr size_t most_in_batch = 1 << 17, least_in_batch = 1 << 12;  // points
constexpr double batch_bytes_per_point = 600.0;                      // of pulses, points, and what a strip stage makes of them
constexpr double share_of_batches = 0.1;                             // of the budget, while strips are read
constexpr double share_of_buffers = 0.2;                             // of free memory, then

/// The columns of the strips' points that the tile stages need or read: not those that a stage makes anew for every point before any other
/// reads them. Writers of a cloud make from its records what no other stage reads.
core::ColumnSet needed_columns(const RunState& run) {
  using core::Column;
  const bool as_recorded = run.last_strip_stage == run.source && run.stage(run.source).info().makes(stages::Product::points);
  core::ColumnSet needed{Column::x, Column::y, Column::z, Column::strip, Column::record}, made;
  for (size_t i = run.last_strip_stage + 1; i < run.plan.stages.size(); ++i) {
    if (!run.works_on(i, Grain::tile)) continue;
    const stages::Info& info = run.stage(i).info();
    const core::ColumnSet kept_as_read = info.needs | run.stage(i).also_reads();
    for (const Column c : {Column::height, Column::ground_probability})
      if (info.gives.has(c) && !kept_as_read.has(c) && !needed.has(c)) made.add(c);
    const bool is_writer = as_recorded && run.stage(i).is_streamed();
    needed = needed | (columns_of_tiles(run.stage(i)) - made - (is_writer ? io::held_by_source : core::ColumnSet{}));
  }
  return needed;
}

/// The columns of a cloud's points that neither a strip stage reads nor the strips keep. Times are always read: the reader judges them.
core::ColumnSet unread_columns(const RunState& run) {
  core::ColumnSet all;
  for (int c = 0; c < core::column_count; ++c) all.add(static_cast<core::Column>(c));
  core::ColumnSet read = run.kept | core::ColumnSet{core::Column::time};
  for (size_t i = run.source; i <= run.last_strip_stage; ++i)
    if (run.works_on(i, Grain::strip)) read = read | run.stage(i).info().needs | run.stage(i).also_reads();
  return all - read;
}

struct Parcel {
  stages::StripBatch batch;
  std::vector<Account> accounts;
  std::uint64_t read = 0;
};

/// How many batches are at work, and the points of each. Where the budget is little, they are small, and the same in each run; then few.
std::pair<size_t, size_t> batches_of(const RunState& run) {
  const double points_at_once = share_of_batches * run.memory.bytes() / batch_bytes_per_point;
  const auto batches = std::clamp(static_cast<size_t>(points_at_once) / least_in_batch, size_t{1}, static_cast<size_t>(run.threads) + 1);
  return {batches, std::clamp(static_cast<size_t>(points_at_once / static_cast<double>(batches)), least_in_batch, most_in_batch)};
}

void stream_strip(RunState& run, const stages::Strip& strip, const fs::path& strip_folder) {
  const size_t n = run.plan.stages.size(), source = run.source;
  const auto reader = run.stage(source).open(run.context, strip);
  const auto [batches, batch_points] = batches_of(run);
  StripWriter writer(strip_folder, run.plan.run.tile.value,
                     static_cast<size_t>(share_of_buffers * run.memory.free() / 2.0));  // columns grow by doubling
  std::vector<Account> accounts(n);
  PulseBorder border;
  bool more = true;

  const auto read = [&](tbb::flow_control& flow) -> std::shared_ptr<Parcel> {
    if (!more) {
      flow.stop();
      return nullptr;
    }
    auto parcel = std::make_shared<Parcel>();
    parcel->accounts.resize(n);
    parcel->batch.line = strip.line;
    parcel->batch.source = strip.source;
    const Stopwatch watch(Whose::thread);
    more = reader->next(parcel->batch, batch_points, parcel->accounts[source].tally);
    parcel->read = parcel->batch.shots.size() + parcel->batch.block.size();
    border.cut(parcel->batch, !more);
    const std::uint64_t given = parcel->batch.shots.size() + parcel->batch.block.size();
    parcel->accounts[source].out = given;
    parcel->accounts[source].time = watch.spent();
    return parcel;
  };
  const auto work = [&](std::shared_ptr<Parcel> parcel) {
    for (size_t i = source + 1; i <= run.last_strip_stage; ++i) {
      if (!run.works_on(i, Grain::strip)) continue;
      const auto size = [&] { return std::max(parcel->batch.shots.size(), parcel->batch.block.size()); };
      const Stopwatch watch(Whose::thread);
      parcel->accounts[i].in = size();
      run.stage(i).run_strip(run.context, parcel->batch, parcel->accounts[i].tally);
      parcel->accounts[i].out = size();
      if (parcel->accounts[i].in != parcel->accounts[i].out + parcel->accounts[i].tally.left_out())
        throw core::Error("returns were lost on the way", std::string(run.stage(i).info().name), "this is a fault of the program");
      parcel->accounts[i].time = watch.spent();
    }
    keep_columns(parcel->batch.block, run.kept);
    return parcel;
  };
  const auto write = [&](const std::shared_ptr<Parcel>& parcel) {
    writer.write(parcel->batch.block);
    for (size_t i = 0; i < n; ++i) accounts[i].add(parcel->accounts[i]);
    run.progress.advance(parcel->read);
  };
  tbb::parallel_pipeline(batches, tbb::make_filter<void, std::shared_ptr<Parcel>>(tbb::filter_mode::serial_in_order, read) &
                                      tbb::make_filter<std::shared_ptr<Parcel>, std::shared_ptr<Parcel>>(tbb::filter_mode::parallel, work) &
                                      tbb::make_filter<std::shared_ptr<Parcel>, void>(tbb::filter_mode::serial_in_order, write));

  accounts[source].in = strip.records;
  if (strip.records != accounts[source].out + accounts[source].tally.left_out())
    throw core::Error("records of " + strip.name + " were lost", std::string(run.stage(source).info().name),
                      "this is a fault of the program");
  Value note = Value::array();  // of no stage behind the strips: another run that reads this may have other ones
  for (size_t i = 0; i <= run.last_strip_stage; ++i) note.push(core::reported(accounts[i]));
  writer.commit(io::to_json(note));
}

/// The batches must fit beside what the process holds. They grow with the budget: what is needed are those of the least that works.
void expect_room_for_strips(const RunState& run) {
  const double left = run.memory.left(), counted = run.memory.bytes() - run.memory.reserve(), held = counted - left;
  const double least = held / (counted / run.memory.bytes() - share_of_batches);
  run.memory.require(share_of_batches * least, left, "reading the points");
}

/// Has the stage finished some of its tiles?
bool has_pieces(const fs::path& folder) {
  return fs::exists(folder) && std::any_of(fs::directory_iterator(folder), fs::directory_iterator(),
                                           [](const fs::directory_entry& e) { return e.path().extension() == ".done"; });
}

/// A tile that the clouds' headers show to be too full is refused before any point is read: with the budget for points that lie evenly over
/// their files' boxes, as the next ones around it do.
void expect_room_for_fullest_tile(const RunState& run) {
  if (!run.stage(run.source).info().makes(stages::Product::points)) return;
  const std::optional<FullTile> tile = fullest_tile(run.context);
  if (!tile) return;
  const double left = run.memory.left();
  // A cloud may be without the others.
  using core::Column;
  const core::ColumnSet certain = needed_columns(run) - core::ColumnSet{Column::sigma_v, Column::sigma_h, Column::range, Column::incidence};
  const auto needed = [&](const std::map<TileKey, std::uint64_t>& points) {
    TileStore assumed({}, run.plan.run.tile.value, run.context.origin);
    for (const auto& [key, n] : points) assumed.assume(key, n, certain);
    SquareCounts squares(assumed);
    std::pair<double, std::string_view> most;
    for (size_t i = run.last_strip_stage + 1; i < run.plan.stages.size(); ++i) {
      if (!run.works_on(i, Grain::tile) || has_pieces(run.folder(i))) continue;
      const StageMemory memory(assumed, run.stage(i), run.context);
      TileGroup largest;
      for (const auto& [key, n] : points)
        if (TileGroup g = memory.of({key}); g.bytes > largest.bytes) largest = std::move(g);
      const TileGroup cut = memory.cut(std::move(largest), static_cast<std::uint64_t>(std::max(0.0, left)), squares);
      most = std::max(most, {static_cast<double>(cut.bytes), run.stage(i).info().name});
    }
    return most;
  };
  if (needed({{tile->key, tile->points}}).first <= left) return;
  std::map<TileKey, std::uint64_t> even = even_tiles(run.context);
  even[tile->key] = std::max(even[tile->key], tile->points);
  const auto [bytes, what] = needed(even);
  run.memory.require(bytes, left, std::string(what) + " on the fullest tile of " + tile->file, true);
}

/// Every point of the clouds was left out: why, and where the first file says that its points lie.
core::Error none_of_the_clouds(const RunState& run) {
  std::string why, first;
  for (const Account& account : run.accounts) {
    const Value counts = account.tally.value();
    for (const auto& [what, one] : counts.members())
      if (what.ends_with("left out")) why += (why.empty() ? "" : "; ") + std::to_string(one.find("count")->as_int()) + " " + what;
  }
  const fs::path file = io::resolve(run.plan.survey, run.plan.survey.points.front().file);
  if (io::has_las_ending(file)) {
    std::vector<std::string> ignored;
    const io::LasHeader header = io::read_las_header(file, ignored);
    char text[160];
    std::snprintf(text, sizeof text, "its header states x %.3f to %.3f, y %.3f to %.3f; ", header.min.x(), header.max.x(), header.min.y(),
                  header.max.y());
    first = text;
  }
  return core::Error(
      "no point of the clouds is left to work on" + (why.empty() ? why : ": " + why), file.string(),
      first + "are these coordinates of " + run.context.crs.name() + "? see `swath info` of the cloud for scale, unit and CRS");
}

/// Of the strips and what follows them.
void expect_times(RunState& run, std::uint64_t returns) {
  const auto n = static_cast<double>(returns), shared = n / run.threads;
  std::vector<double> seconds(1, 0.0);
  for (size_t i = 0; i < run.plan.stages.size(); ++i) {
    const std::string_view name = run.stage(i).info().name;
    if (run.works_on(i, Grain::strip)) seconds[0] += shared * expected_seconds(name, Grain::strip);
    if (i <= run.last_strip_stage) continue;
    if (run.works_on(i, Grain::tile)) seconds.push_back(shared * expected_seconds(name, Grain::tile));
    if (run.works_on(i, Grain::merge)) seconds.push_back(n * expected_seconds(name, Grain::merge));
  }
  run.progress.expect(std::move(seconds));
}

}  // namespace

void choose_strips(RunState& run) {
  const auto keep = [&](core::ColumnSet columns) {
    run.kept = columns;
    std::string text = run.fingerprints[run.last_strip_stage];
    for (int c = 0; c < core::column_count; ++c) text += columns.has(static_cast<core::Column>(c)) ? '1' : '0';
    run.folders[run.last_strip_stage] = core::hex(core::fnv1a(text));
  };
  core::ColumnSet all;
  for (int c = 0; c < core::column_count; ++c) all.add(static_cast<core::Column>(c));
  keep(all);
  run.keeps_store = run.plan.run.keep_work || fs::exists(run.folder(run.last_strip_stage));
  if (!run.keeps_store) keep(needed_columns(run));
  run.context.unread = unread_columns(run);
}

void find_strips(RunState& run) {
  if (run.context.source) return;
  run.context.source = &run.stage(run.source);
  run.context.strips = run.context.source->strips(run.context, run.accounts[run.source].tally);
}

void run_strips(RunState& run) {
  find_strips(run);
  const size_t source = run.source;
  const std::uint64_t without_strip = run.accounts[source].tally.left_out();  // records that no strip holds
  const std::vector<stages::Strip>& strips = run.context.strips;
  const fs::path strips_folder = run.folder(run.last_strip_stage);
  std::uint64_t records = 0;
  for (const stages::Strip& s : strips) records += s.records;
  expect_times(run, records);
  run.progress.begin("strips", records, "returns");
  const bool is_shared = run.shares(WaveKind::strips, 0);
  std::vector<double> work;
  for (const stages::Strip& s : strips) work.push_back(static_cast<double>(s.records));
  const std::vector<bool> mine = run.own_pieces(work);
  std::vector<std::string> names;
  bool has_room = false;  // for those that are not done
  for (size_t i = 0; i < strips.size(); ++i) {
    char name[32];
    std::snprintf(name, sizeof name, "strip_%04zu", i + 1);
    names.emplace_back(name);
    const fs::path strip_folder = strips_folder / name;
    if (is_shared && !mine[i]) continue;
    std::optional<PieceLock> lock;
    if (is_shared) lock.emplace(strip_folder);
    if (TileStore::is_committed(strip_folder)) {
      ++run.resumed;
      run.progress.skip(strips[i].records);
    } else if (run.share && !is_shared) {
      wave_too_early(run, strips[i].name + " is missing");
    } else {
      if (!std::exchange(has_room, true)) expect_room_for_strips(run), expect_room_for_fullest_tile(run);
      stream_strip(run, strips[i], strip_folder);
    }
    if (is_shared) continue;
    const Value note = io::parse_json(TileStore::note(strip_folder), strip_folder.string());
    if (!note.is_array() || note.items().size() != run.last_strip_stage + 1) throw damaged_work(strip_folder);
    for (size_t k = 0; k <= run.last_strip_stage; ++k) {
      const std::optional<Account> one = account_of(note.items()[k]);
      if (!one) throw damaged_work(strip_folder);
      run.accounts[k].add(*one);
    }
  }
  run.progress.end();
  if (is_shared) return;
  if (run.accounts[source].in == 0 && run.stage(source).info().makes(stages::Product::points)) {
    const std::vector<io::PointFile>& files = run.plan.survey.points;
    if (strips.size() < files.size()) throw none_of_the_clouds(run);  // some have points, none of which was read
    throw core::Error(files.size() == 1 ? "the file has no points" : "no file of [[points]] has a point",
                      io::resolve(run.plan.survey, files.front().file).string(), "see `swath info` of the file");
  }
  if (run.accounts[source].in == 0)
    throw core::Error("no laser return to work on", run.plan.survey_file.string(),
                      "are the lines' times those of the records? see `swath info` of the laser file");
  run.accounts[source].in += without_strip;
  expect_balance(run.accounts[source].tally, run.stage(source));
  run.store = std::make_unique<TileStore>(strips_folder, run.plan.run.tile.value, run.context.origin);
  run.store->open(names);
  if (run.store->points() == 0 && run.stage(source).info().makes(stages::Product::points)) throw none_of_the_clouds(run);
  if (run.store->points() == 0)
    throw core::Error("no return could be georeferenced: the trajectory covers none of them", run.plan.survey_file.string(),
                      "compare the time scales with `swath info` of the laser and trajectory files");
  run.squares = std::make_unique<SquareCounts>(*run.store);
  if (!run.share) expect_room_for_tiles(run);
}

}  // namespace swath::pipeline
