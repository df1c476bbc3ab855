// SPDX-License-Identifier: GPL-3.0-or-later
// Work folder: OUTPUT/.swath/<nn>-<stage>-<fingerprint>/. A folder's name says what it was made from, so a folder that is
// there is still valid; within it a strip's strip.json or a tile's .done (piece_record.h) says that the piece is whole, which is checked
// before a run goes on from it. Products wait in its products/ until the run is done.
// Over 400 lines: the engine is one class whose steps share its state; the steps stand in the order of a run.
#include "pipeline/run.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>
#include <thread>
#include <utility>

#include "io/las/las_source.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "pipeline/delivery.h"
#include "pipeline/expected_time.h"
#include "pipeline/fullest_tile.h"
#include "pipeline/grid_store.h"
#include "pipeline/input_guard.h"
#include "pipeline/limits.h"
#include "pipeline/memory.h"
#include "pipeline/provenance.h"
#include "pipeline/pulse_border.h"
#include "pipeline/released_points.h"
#include "pipeline/report_docs.h"
#include "pipeline/stage_memory.h"
#include "pipeline/summary.h"
#include "pipeline/tile_groups.h"
#include "pipeline/tile_queue.h"
#include "pipeline/tile_store.h"
#include "pipeline/tile_work.h"
#include "pipeline/work/piece_record.h"
#include "pipeline/work/survey_piece.h"
#include "pipeline/work/work_folder.h"
#include "stages/area.h"
#include "stages/waters.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;
using core::Tally;
using core::Value;
using stages::Grain;
using stages::Stage;
using Clock = std::chrono::steady_clock;

constexpr size_t most_in_batch = 1 << 17, least_in_batch = 1 << 12;  // points
constexpr double batch_bytes_per_point = 600.0;                      // of pulses, points, and what a strip stage makes of them
constexpr double share_of_batches = 0.1;                             // of the budget, while strips are read
constexpr double share_of_buffers = 0.2;                             // of free memory, then
constexpr const char *discarded_name = ".swath-discarded", *products_name = "products";

double since(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

/// What the report says of one stage.
struct Account {
  std::uint64_t in = 0, out = 0;
  Tally tally;
  Value findings = Value::object();
  double seconds = 0;
  std::uint64_t cut = 0;  ///< tiles that were worked on in parts
};

constexpr const char* groups_file = "groups.done";

/// What a group takes to work on, for the progress: its memory holds the points around it and its rasters, and so one point alone in a tile
/// is not taken for next to nothing.
double work_of(const TileGroup& g) { return 1.0 + static_cast<double>(g.bytes); }

class Engine {
 public:
  Engine(Plan& plan, Progress& progress)
      : plan_(plan),
        progress_(progress),
        output_(fs::absolute(plan.run.output)),
        work_(output_ / ".swath"),
        threads_(plan.run.threads > 0 ? plan.run.threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()))),
        tbb_threads_(tbb::global_control::max_allowed_parallelism, static_cast<size_t>(threads_)),
        memory_(plan.run.memory.value),
        grids_(plan.run.tile.value),
        context_{plan.survey},
        accounts_(plan.stages.size()),
        made_(plan.stages.size()) {}

  Outcome run(const std::string& command);

 private:
  void prepare();
  void prepare_map();
  core::ColumnSet needed_columns() const;
  void choose_strips();
  size_t last_reader() const;
  bool releases(size_t number) const;
  void find_strips();
  bool is_read_again(size_t number) const;
  bool is_resumed(size_t number) const;
  std::vector<stages::Product> last_uses(size_t number) const;
  void run_survey_stages();
  void run_strips();
  void stream_strip(const stages::Strip& strip, const fs::path& folder);
  void run_tile_stages();
  [[noreturn]] void keep_finished(const core::Error& e);
  const Value* judged_geometry() const;
  std::vector<TileKey> tiles_of(size_t number) const;
  std::set<TileKey> tiles_of_water() const;
  void expect_room_for_strips() const;
  void expect_room_for_fullest_tile() const;
  void expect_room_for_tiles();
  fs::path done_file(size_t number, const TileBox& box) const;
  fs::path done_file(size_t number, const TileGroup& group) const { return done_file(number, TileBox(group.tiles)); }
  std::vector<TileGroup> groups_of(size_t number, const std::vector<TileKey>& keys, std::uint64_t budget);
  PieceRecord run_group(size_t number, const TileGroup& group, bool has_water);
  void run_tiles(size_t number);
  void keep_surface_tiles(size_t number, const std::set<TileKey>& fringe);
  void run_merge(size_t number);
  void begin_products(size_t number);
  void compose_report(const std::string& command);
  void deliver_all(const WorkLock& lock);
  /// At the very end, when the work is discarded too.
  void expect_all_delivered() const;
  Measured measured() const;
  void keep_whole();
  void expect_made(size_t number) const;
  bool is_void_fringe(size_t number, const TileGroup& group) const;
  size_t steps() const;
  void expect_times(std::uint64_t returns);
  fs::path folder(size_t number) const {
    char digits[8];
    std::snprintf(digits, sizeof digits, "%02zu-", number);
    return work_ / (digits + std::string(plan_.stages[number].stage->info().name) + "-" + folders_[number]);
  }
  const Stage& stage(size_t number) const { return *plan_.stages[number].stage; }
  bool works_on(size_t number, Grain g) const { return stage(number).works_on(g); }

  Plan& plan_;
  Progress& progress_;
  fs::path output_, work_;
  int threads_;
  tbb::global_control tbb_threads_;
  MemoryBudget memory_;
  GridStore grids_;
  stages::Context context_;
  std::vector<Account> accounts_;
  std::vector<std::vector<PieceFile>> made_;  ///< by each stage
  std::vector<Input> inputs_;
  std::vector<std::string> fingerprints_, folders_;  ///< of each stage; of the work that its folder holds
  core::ColumnSet kept_;                             ///< of the strips' points
  size_t source_ = 0;                                ///< the stage that is the plan's source; as many as there are stages where it has none
  size_t last_strip_stage_ = 0;
  std::unique_ptr<TileStore> store_;
  std::unique_ptr<SquareCounts> squares_;
  std::set<TileKey> surface_tiles_;  ///< without a point of their own, but a surface reaches into them from their neighbours
  bool has_products_ = false;        ///< of a tile stage that is finished
  std::uint64_t resumed_ = 0, damaged_ = 0;
  Value report_;
};

void Engine::prepare() {
  if (plan_.survey_file.empty())
    throw core::usage_error("no survey to run on", plan_.config.string(),
                            "name it with --survey DIR/survey.toml, or as run.survey in the config");
  for (const PlannedStage& s : plan_.stages)
    if (plan_.survey.crs.empty() && s.stage->is_source()) plan_.survey.crs = s.stage->own_crs(plan_.survey);
  context_.tile_side = plan_.run.tile.value;
  context_.grids = &grids_;
  context_.threads = threads_;
  context_.progress = [this](double share, std::string_view now) { progress_.share(share, now); };
  if (works_on_the_map(plan_) || !plan_.survey.crs.empty()) prepare_map();
  inputs_ = inputs_of(plan_);
  fingerprints_ = fingerprints(plan_, inputs_);
  if (!fingerprints_.empty()) context_.project = project_id(fingerprints_.back());
  const Day day = creation_day();
  context_.creation_year = day.year;
  context_.creation_day = day.of_year;
  while (source_ < plan_.stages.size() && !stage(source_).is_source()) ++source_;
  for (size_t i = 0; i < plan_.stages.size(); ++i)
    if (works_on(i, Grain::strip)) last_strip_stage_ = i;
  folders_ = fingerprints_;
}

/// The columns of the strips' points that the tile stages need or read: not those that a stage makes anew for every point before any other
/// reads them. Writers of a cloud make from its records what no other stage reads.
core::ColumnSet Engine::needed_columns() const {
  using core::Column;
  const bool as_recorded = last_strip_stage_ == source_ && stage(source_).info().makes(stages::Product::points);
  core::ColumnSet needed{Column::x, Column::y, Column::z, Column::strip, Column::record}, made;
  for (size_t i = last_strip_stage_ + 1; i < plan_.stages.size(); ++i) {
    if (!works_on(i, Grain::tile)) continue;
    const stages::Info& info = stage(i).info();
    const core::ColumnSet kept_as_read = info.needs | stage(i).also_reads();
    for (const Column c : {Column::height, Column::ground_probability})
      if (info.gives.has(c) && !kept_as_read.has(c) && !needed.has(c)) made.add(c);
    const bool is_writer = as_recorded && stage(i).is_streamed();
    needed = needed | (columns_of_tiles(stage(i)) - made - (is_writer ? io::held_by_source : core::ColumnSet{}));
  }
  return needed;
}

/// The last stage whose tiles depend on points; that of the strips where none does.
size_t Engine::last_reader() const {
  size_t last = last_strip_stage_;
  for (size_t i = last_strip_stage_ + 1; i < plan_.stages.size(); ++i)
    if (works_on(i, Grain::tile) && reads_points(stage(i))) last = i;
  return last;
}

/// Are the points of a tile needed no more once the stage has worked on it?
bool Engine::releases(size_t number) const {
  return number == last_reader() && !plan_.run.keep_work && stage(number).halo() <= 0.0 && stage(number).info().gives.empty();
}

/// The strips' folder is named by the columns of its points, too: all of them, where the store is kept for other stages than these or an
/// earlier run has kept it so; otherwise those that are needed.
void Engine::choose_strips() {
  const auto keep = [this](core::ColumnSet columns) {
    kept_ = columns;
    std::string text = fingerprints_[last_strip_stage_];
    for (int c = 0; c < core::column_count; ++c) text += columns.has(static_cast<core::Column>(c)) ? '1' : '0';
    folders_[last_strip_stage_] = core::hex(core::fnv1a(text));
  };
  core::ColumnSet all;
  for (int c = 0; c < core::column_count; ++c) all.add(static_cast<core::Column>(c));
  keep(all);
  if (!plan_.run.keep_work && !fs::exists(folder(last_strip_stage_))) keep(needed_columns());
}

void Engine::prepare_map() {
  context_.crs = core::Crs(plan_.survey.crs);
  if (works_on_the_map(plan_)) require_projected(context_.crs, plan_.survey_file);
  context_.unit = context_.crs.metres_per_unit();
  context_.vertical_unit = context_.crs.vertical_metres_per_unit();
  context_.product_crs = plan_.survey.crs;
  context_.heights = context_.crs.vertical_name();
  if (!context_.crs.has_height_unit()) {
    if (plan_.survey.height_unit)
      context_.vertical_unit = plan_.survey.height_unit->value;
    else if (!plan_.survey.points.empty())
      context_.vertical_unit = context_.unit;
    if (context_.vertical_unit != 1.0)
      context_.product_crs = "COMPD_CS[\"" + context_.crs.name() + " + height\"," + context_.crs.wkt1() +
                             ",VERT_CS[\"height\",VERT_DATUM[\"unknown\",2005],UNIT[\"" +
                             (context_.vertical_unit == 0.3048 ? "foot" : "height unit") + "\"," +
                             core::format_number(context_.vertical_unit) + "],AXIS[\"Up\",UP]]]";
  }
  // What comes from the records of a flight has ellipsoidal heights; a cloud's source knows about its own.
  if (context_.crs.heights() == core::Heights::unknown) context_.heights = core::ellipsoidal_heights;
  stages::set_area(context_, context_.area.box, 0.0);
  for (const PlannedStage& s : plan_.stages)
    if (s.stage->is_source()) s.stage->locate(context_);
}

/// What the stage writes from now on goes to its own folder, from which it is delivered at the end of the run.
void Engine::begin_products(size_t number) {
  std::error_code ec;
  fs::create_directories(folder(number), ec);
  if (ec) io::throw_system_error("cannot make the folder", folder(number), ec.value());
  context_.output = folder(number) / products_name;
}

void Engine::find_strips() {
  if (context_.source) return;
  context_.source = &stage(source_);
  context_.strips = context_.source->strips(context_, accounts_[source_].tally);
}

/// Survey stages, strips, tile stages and merges.
size_t Engine::steps() const {
  const bool points = makes_points(plan_);
  size_t n = points ? 1 : 0;
  for (size_t i = 0; i < plan_.stages.size(); ++i) {
    n += works_on(i, Grain::survey);
    if (points && i > last_strip_stage_)
      n += static_cast<size_t>(works_on(i, Grain::tile)) + static_cast<size_t>(works_on(i, Grain::merge));
  }
  return n;
}

/// Of the strips and what follows them.
void Engine::expect_times(std::uint64_t returns) {
  const auto n = static_cast<double>(returns), shared = n / threads_;
  std::vector<double> seconds(1, 0.0);
  for (size_t i = 0; i < plan_.stages.size(); ++i) {
    const std::string_view name = stage(i).info().name;
    if (works_on(i, Grain::strip)) seconds[0] += shared * expected_seconds(name, Grain::strip);
    if (i <= last_strip_stage_) continue;
    if (works_on(i, Grain::tile)) seconds.push_back(shared * expected_seconds(name, Grain::tile));
    if (works_on(i, Grain::merge)) seconds.push_back(n * expected_seconds(name, Grain::merge));
  }
  progress_.expect(std::move(seconds));
}

/// Of an earlier run of this plan that was killed, or whose work was kept.
void Engine::keep_whole() {
  if (makes_points(plan_)) choose_strips();
  std::set<std::string> valid;
  for (size_t i = 0; i < plan_.stages.size(); ++i) valid.insert(folder(i).filename().string());
  sweep(work_, valid);
  std::error_code absent;
  fs::remove_all(output_ / discarded_name, absent);
  if (std::none_of(valid.begin(), valid.end(), [this](const std::string& name) { return fs::exists(work_ / name); })) return;
  progress_.begin("check of earlier work", 0, "");
  const EarlierWork earlier = keep_whole_work(work_, [this](double done) { progress_.share(done); });
  progress_.end();
  damaged_ = earlier.damaged;
  std::uint64_t given_up = 0;
  if (makes_points(plan_))
    given_up =
        give_up_strips(folder(last_strip_stage_), [this](TileKey key) { return fs::exists(done_file(last_reader(), TileBox(key, key))); });
  damaged_ += given_up;
  if (damaged_ > 0)
    progress_.say("damaged: " + std::to_string(damaged_) + " pieces of an earlier run are not what they were and are done again");
  if (earlier.lines - given_up + earlier.pieces > 0)
    progress_.say("resumed: " + std::to_string(earlier.lines - given_up) + " flight lines or files and " + std::to_string(earlier.pieces) +
                  " pieces of other stages were done by an earlier run and are not done again");
}

/// What readers hand on is as large as their files, and read as fast from these.
bool Engine::is_read_again(size_t number) const { return stage(number).info().name.starts_with("readers."); }

/// Is what an earlier run has kept of a survey stage enough? IMU records are not needed where the stages that use them are done; their
/// piece is, for what the report says of them.
bool Engine::is_resumed(size_t number) const {
  if (!is_survey_piece_done(folder(number))) return false;
  if (!is_read_again(number)) return true;
  for (size_t i = number + 1; i < plan_.stages.size(); ++i)
    if (works_on(i, Grain::survey) && stage(i).info().uses(stages::Product::of<core::ImuData>()) && !is_survey_piece_done(folder(i)))
      return false;
  return true;
}

/// What no stage behind this one has a use for.
std::vector<stages::Product> Engine::last_uses(size_t number) const {
  std::vector<stages::Product> last = stage(number).info().needs_products;
  std::erase_if(last, [&](stages::Product p) {
    for (size_t i = number + 1; i < plan_.stages.size(); ++i)
      if (stage(i).info().uses(p)) return true;
    return false;
  });
  return last;
}

void Engine::run_survey_stages() {
  for (size_t i = 0; i < plan_.stages.size(); ++i) {
    if (!works_on(i, Grain::survey)) continue;
    if (stage(i).info().takes(stages::Product::shots)) find_strips();
    begin_products(i);
    progress_.begin(std::string(stage(i).info().name), 0, "");
    const bool resumed = is_resumed(i);
    context_.memory = memory_.free();
    context_.last_uses = last_uses(i);
    SurveyPiece piece = resumed ? resume_survey_piece(context_, folder(i))
                                : run_survey_piece(stage(i), context_, folder(i),
                                                   !is_read_again(i) || stage(i).info().makes(stages::Product::of<core::ImuData>()));
    progress_.end();
    resumed_ += resumed;
    accounts_[i].tally.add(piece.tally);
    accounts_[i].findings = std::move(piece.findings);
    accounts_[i].seconds += piece.seconds;
    made_[i] = std::move(piece.files);
    context_.earlier.push_back(context_.output);
    if (const Value* geometry = accounts_[i].findings.find("geometry"))
      if (const Value* doubt = geometry->find("doubt")) context_.records.put(stages::GeometryDoubt{doubt->as_text()});
  }
}

void Engine::stream_strip(const stages::Strip& strip, const fs::path& strip_folder) {
  struct Parcel {
    stages::StripBatch batch;
    std::vector<Account> accounts;
    std::uint64_t read = 0;
  };
  const size_t n = plan_.stages.size(), source = source_;
  const auto reader = stage(source).open(context_, strip);
  // Where the budget is little, batches are small, and the same in each run; then they are few.
  const double points_at_once = share_of_batches * memory_.bytes() / batch_bytes_per_point;
  const auto batches = std::clamp(static_cast<size_t>(points_at_once) / least_in_batch, size_t{1}, static_cast<size_t>(threads_) + 1);
  const size_t batch_points = std::clamp(static_cast<size_t>(points_at_once / static_cast<double>(batches)), least_in_batch, most_in_batch);
  StripWriter writer(strip_folder, plan_.run.tile.value,
                     static_cast<size_t>(share_of_buffers * memory_.free() / 2.0));  // columns grow by doubling
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
    more = reader->next(parcel->batch, batch_points, parcel->accounts[source].tally);
    parcel->read = parcel->batch.shots.size() + parcel->batch.block.size();
    border.cut(parcel->batch, !more);
    const std::uint64_t given = parcel->batch.shots.size() + parcel->batch.block.size();
    parcel->accounts[source].out = given;
    return parcel;
  };
  const auto work = [&](std::shared_ptr<Parcel> parcel) {
    for (size_t i = source + 1; i <= last_strip_stage_; ++i) {
      if (!works_on(i, Grain::strip)) continue;
      const auto size = [&] { return std::max(parcel->batch.shots.size(), parcel->batch.block.size()); };
      const auto start = Clock::now();
      parcel->accounts[i].in = size();
      stage(i).run_strip(context_, parcel->batch, parcel->accounts[i].tally);
      parcel->accounts[i].out = size();
      if (parcel->accounts[i].in != parcel->accounts[i].out + parcel->accounts[i].tally.left_out())
        throw core::Error("returns were lost on the way", std::string(stage(i).info().name), "this is a fault of the program");
      parcel->accounts[i].seconds = since(start);
    }
    keep_columns(parcel->batch.block, kept_);
    return parcel;
  };
  const auto write = [&](const std::shared_ptr<Parcel>& parcel) {
    writer.write(parcel->batch.block);
    for (size_t i = 0; i < n; ++i) {
      accounts[i].in += parcel->accounts[i].in;
      accounts[i].out += parcel->accounts[i].out;
      accounts[i].tally.add(parcel->accounts[i].tally);
      accounts[i].seconds += parcel->accounts[i].seconds;
    }
    progress_.advance(parcel->read);
  };
  tbb::parallel_pipeline(batches, tbb::make_filter<void, std::shared_ptr<Parcel>>(tbb::filter_mode::serial_in_order, read) &
                                      tbb::make_filter<std::shared_ptr<Parcel>, std::shared_ptr<Parcel>>(tbb::filter_mode::parallel, work) &
                                      tbb::make_filter<std::shared_ptr<Parcel>, void>(tbb::filter_mode::serial_in_order, write));

  accounts[source].in = strip.records;
  if (strip.records != accounts[source].out + accounts[source].tally.left_out())
    throw core::Error("records of " + strip.name + " were lost", std::string(stage(source).info().name), "this is a fault of the program");
  Value note = Value::array();
  for (size_t i = 0; i <= last_strip_stage_; ++i) {  // what comes after them may be another stage in the run that reads this
    const Account& a = accounts[i];
    Value one = Value::object();
    one["in"] = a.in;
    one["out"] = a.out;
    one["seconds"] = a.seconds;
    one["tally"] = a.tally.value();
    one["records"] = records_of(a.tally);
    note.push(std::move(one));
  }
  writer.commit(io::to_json(note));
}

/// The batches must fit beside what the process holds. They grow with the budget: what is needed are those of the least that works.
void Engine::expect_room_for_strips() const {
  const double left = memory_.left(), counted = memory_.bytes() - memory_.reserve(), held = counted - left;
  const double least = held / (counted / memory_.bytes() - share_of_batches);
  memory_.require(share_of_batches * least, left, "reading the points");
}

/// A tile that the clouds' headers show to be too full is refused before any point is read: with the budget for points that lie evenly over
/// their files' boxes, as the next ones around it do.
void Engine::expect_room_for_fullest_tile() const {
  if (!stage(source_).info().makes(stages::Product::points)) return;
  const std::optional<FullTile> tile = fullest_tile(context_);
  if (!tile) return;
  const double left = memory_.left();
  const auto needed = [&](const std::map<TileKey, std::uint64_t>& points) {
    TileStore assumed({}, plan_.run.tile.value, context_.origin);
    for (const auto& [key, n] : points) assumed.assume(key, n, needed_columns());
    SquareCounts squares(assumed);
    std::pair<double, std::string_view> most;
    for (size_t i = last_strip_stage_ + 1; i < plan_.stages.size(); ++i) {
      if (!works_on(i, Grain::tile)) continue;
      const StageMemory memory(assumed, stage(i), context_);
      TileGroup largest;
      for (const auto& [key, n] : points)
        if (TileGroup g = memory.of({key}); g.bytes > largest.bytes) largest = std::move(g);
      const TileGroup cut = memory.cut(std::move(largest), static_cast<std::uint64_t>(std::max(0.0, left)), squares);
      most = std::max(most, {static_cast<double>(cut.bytes), stage(i).info().name});
    }
    return most;
  };
  if (needed({{tile->key, tile->points}}).first <= left) return;
  std::map<TileKey, std::uint64_t> even = even_tiles(context_);
  even[tile->key] = std::max(even[tile->key], tile->points);
  const auto [bytes, what] = needed(even);
  memory_.require(bytes, left, std::string(what) + " on the fullest tile of " + tile->file, true);
}

/// Every tile stage has a way to work on every tile that is not done; otherwise the one that takes most is named.
void Engine::expect_room_for_tiles() {
  const double left = memory_.left(), free = std::max(0.0, left);
  double most = 0.0;
  std::string what;
  for (size_t i = last_strip_stage_ + 1; i < plan_.stages.size(); ++i) {
    if (!works_on(i, Grain::tile)) continue;
    const StageMemory memory(*store_, stage(i), context_);
    std::vector<TileBox> done = read_boxes(folder(i) / groups_file);
    std::erase_if(done, [&](const TileBox& box) { return !fs::exists(done_file(i, box)); });
    for (const auto& [key, n] : store_->tiles()) {
      const auto holds = [k = key](const TileBox& box) { return box.holds(k); };
      if (fs::exists(done_file(i, TileBox(key, key))) || std::any_of(done.begin(), done.end(), holds)) continue;
      const auto bytes = static_cast<double>(memory.cut(memory.of({key}), static_cast<std::uint64_t>(free), *squares_).bytes);
      if (bytes <= most) continue;
      most = bytes;
      what = std::string(stage(i).info().name) + " on the tile " + context_.label(key) + " of " + std::to_string(n) + " points";
    }
  }
  if (most > 0.0) memory_.require(most, left, what);
}

void Engine::run_strips() {
  find_strips();
  const size_t source = source_;
  const std::uint64_t without_strip = accounts_[source].tally.left_out();  // records that no strip holds
  const std::vector<stages::Strip>& strips = context_.strips;
  const fs::path strips_folder = folder(last_strip_stage_);
  std::uint64_t records = 0;
  for (const stages::Strip& s : strips) records += s.records;
  expect_times(records);
  progress_.begin("strips", records, "returns");
  std::vector<std::string> names;
  std::uint64_t in = 0;
  bool has_room = false;  // for those that are not done
  for (size_t i = 0; i < strips.size(); ++i) {
    char name[32];
    std::snprintf(name, sizeof name, "strip_%04zu", i + 1);
    names.emplace_back(name);
    const fs::path strip_folder = strips_folder / name;
    if (TileStore::is_committed(strip_folder)) {
      ++resumed_;
      progress_.skip(strips[i].records);
    } else {
      if (!std::exchange(has_room, true)) expect_room_for_strips(), expect_room_for_fullest_tile();
      stream_strip(strips[i], strip_folder);
    }
    const Value note = io::parse_json(TileStore::note(strip_folder), strip_folder.string());
    if (!note.is_array() || note.items().size() != last_strip_stage_ + 1) throw damaged_work(strip_folder);
    for (size_t k = 0; k <= last_strip_stage_; ++k) {
      const Value& one = note.items()[k];
      accounts_[k].in += static_cast<std::uint64_t>(one.find("in")->as_int());
      accounts_[k].out += static_cast<std::uint64_t>(one.find("out")->as_int());
      accounts_[k].seconds += one.find("seconds")->as_number();
      accounts_[k].tally.add(Tally::from(*one.find("tally")));
      add_records(accounts_[k].tally, *one.find("records"));
    }
    in = accounts_[source].in;
  }
  progress_.end();
  if (in == 0)
    throw core::Error("no laser return to work on", plan_.survey_file.string(),
                      "are the lines' times those of the records? see `swath info` of the laser file");
  accounts_[source].in += without_strip;
  expect_balance(accounts_[source].tally, stage(source));
  store_ = std::make_unique<TileStore>(strips_folder, plan_.run.tile.value, context_.origin);
  store_->open(names);
  if (store_->points() == 0)
    throw core::Error("no return could be georeferenced: the trajectory covers none of them", plan_.survey_file.string(),
                      "compare the time scales with `swath info` of the laser and trajectory files");
  squares_ = std::make_unique<SquareCounts>(*store_);
  expect_room_for_tiles();
}

/// The tiles with points, and for what is made of surfaces also those that triangles of their neighbours' points reach into: the surface
/// does not depend on where the tiles' borders lie.
std::vector<TileKey> Engine::tiles_of(size_t number) const {
  const stages::Info& info = stage(number).info();
  std::set<TileKey> keys;
  if (info.gives.empty() && (has_surface(info.gives_products) || has_surface(info.needs_products))) keys = surface_tiles_;
  for (const auto& [key, n] : store_->tiles()) keys.insert(key);
  return {keys.begin(), keys.end()};
}

/// Tiles without points that water of known height lies in, between the survey's own tiles.
std::set<TileKey> Engine::tiles_of_water() const {
  std::set<TileKey> out;
  if (store_->tiles().empty()) return out;
  std::vector<TileKey> keys;
  for (const auto& [key, n] : store_->tiles()) keys.push_back(key);
  const auto [low, high] = TileBox(keys);
  const auto tile = [&](double edge) { return std::floor(edge / context_.tile_side); };
  for (const stages::Box& water : stages::waters_of(context_)) {
    // As numbers: water may reach far beyond the survey.
    const double x0 = std::max<double>(low.ix, tile(water.x0)), x1 = std::min<double>(high.ix, tile(water.x1));
    const double y0 = std::max<double>(low.iy, tile(water.y0)), y1 = std::min<double>(high.iy, tile(water.y1));
    for (double iy = y0; iy <= y1; ++iy)
      for (double ix = x0; ix <= x1; ++ix)
        if (const TileKey key{static_cast<int>(ix), static_cast<int>(iy)}; !store_->tiles().contains(key)) out.insert(key);
  }
  return out;
}

/// A tile without points in which the surface says nothing: it is not part of the survey.
bool Engine::is_void_fringe(size_t number, const TileGroup& group) const {
  const TileKey key = group.tiles[0];
  const fs::path file = stages::grid_file(folder(number), key);
  if (store_->tiles().contains(key) || surface_tiles_.contains(key) || !fs::exists(file)) return false;
  const core::Grid grid = io::read_grid_file(file);
  return std::all_of(grid.reason.begin(), grid.reason.end(), [](core::Void r) { return r == core::Void::no_data; });
}

/// Of the tiles without points only those stay in which the surface says anything.
void Engine::keep_surface_tiles(size_t number, const std::set<TileKey>& fringe) {
  for (const TileKey key : fringe)
    if (fs::exists(stages::grid_file(folder(number), key))) surface_tiles_.insert(key);
}

fs::path Engine::done_file(size_t number, const TileBox& box) const {
  return folder(number) / (file_label(box.low) + (box.low == box.high ? "" : "_to_" + file_label(box.high)) + ".done");
}

/// Tiles are joined only where they give nothing but points' columns. A tile that does not fit is cut into parts.
std::vector<TileGroup> Engine::groups_of(size_t number, const std::vector<TileKey>& keys, std::uint64_t budget) {
  const stages::Info& info = stage(number).info();
  const StageMemory memory(*store_, stage(number), context_);
  const Measure measure = [&](std::vector<TileKey> tiles) { return memory.of(std::move(tiles)); };
  const auto fitted = [&](std::vector<TileGroup> groups) {
    for (TileGroup& g : groups) g = memory.cut(std::move(g), budget, *squares_);
    return groups;
  };
  if (info.gives.empty() || !info.gives_products.empty() || works_on(number, Grain::merge)) return fitted(single_tiles(keys, measure));
  // Those of a run that was killed, so that what it has done counts.
  const fs::path file = folder(number) / groups_file;
  std::vector<TileGroup> groups = grouped_tiles(keys, read_boxes(file), measure), open;
  std::copy_if(groups.begin(), groups.end(), std::back_inserter(open),
               [&](const TileGroup& g) { return !fs::exists(done_file(number, g)); });
  size_t held = 0;
  for (const TileGroup& g : groups) held += g.tiles.size();
  if (held == keys.size() && most_bytes(open, threads_) <= budget) return groups;
  groups = joined_tiles(keys, threads_, budget, measure);
  write_boxes(file, groups);
  return fitted(std::move(groups));
}

/// Runs the stage on a group and keeps what it did: the tally and seconds.
PieceRecord Engine::run_group(size_t number, const TileGroup& group, bool has_water) {
  const stages::Info& info = stage(number).info();
  const fs::path mine = folder(number), done = done_file(number, group);
  stages::TileJob job{group.tiles[0], TileBox(group.tiles).metres(context_.tile_side), mine, {}, 0, {}};
  const io::FinishedFiles finished;
  const io::UnflushedFiles checked_when_resumed;
  const auto start = Clock::now();
  TileWork(*store_, context_, stage(number)).run(group, job, has_water);
  std::vector<fs::path> by_stage = finished.files();
  std::vector<PieceFile> overlays;
  if (!info.gives.empty()) {
    size_t first = 0;
    for (const TileKey k : group.tiles) {
      const size_t count = group.tiles.size() == 1 ? job.own : store_->tiles().at(k);
      overlays.push_back(store_->write_overlay(mine, k, job.block, first, count, info.gives));
      first += count;
    }
  }
  if (is_void_fringe(number, group)) {
    const fs::path empty = stages::grid_file(mine, group.tiles[0]);
    std::erase(by_stage, empty);
    fs::remove(empty);
  }
  Value note = Value::object();
  note["tally"] = job.tally.value();
  note["seconds"] = since(start);
  note["cut"] = group.parts > 1;
  PieceRecord record{piece_files(mine, by_stage), std::move(note)};
  replace_files(record.files, std::move(overlays));
  write_record(done, record);
  return record;
}

void Engine::run_tiles(size_t number) {
  const stages::Info& info = stage(number).info();
  std::set<TileKey> fringe = has_surface(info.gives_products) ? store_->fringe(stage(number).halo()) : std::set<TileKey>{};
  const std::set<TileKey> wet = info.makes(stages::Product::dtm) ? tiles_of_water() : std::set<TileKey>{};
  fringe.insert(wet.begin(), wet.end());
  std::vector<TileKey> keys = tiles_of(number);
  for (const TileKey key : fringe)
    if (!surface_tiles_.contains(key)) keys.push_back(key);

  const double left = memory_.left(), free = std::max(0.0, left);
  const auto budget = static_cast<std::uint64_t>(free);
  const std::vector<TileGroup> groups = groups_of(number, keys, budget);
  for (const TileGroup& g : groups)
    if (!fs::exists(done_file(number, g)))
      memory_.require(static_cast<double>(g.bytes), left + memory_.reserve(),
                      std::string(info.name) + " on the tile " + context_.label(g.tiles[0]));
  std::vector<PieceRecord> notes(groups.size());
  std::vector<std::uint64_t> bytes;
  double work = 0.0;
  for (const TileGroup& g : groups) {
    bytes.push_back(fs::exists(done_file(number, g)) ? 0 : g.bytes);
    work += work_of(g);
  }
  const bool lets_go = releases(number);
  if (lets_go) {
    std::vector<fs::path> made;
    for (size_t i = last_strip_stage_ + 1; i < number; ++i) made.push_back(folder(i));
    note_release(folder(last_strip_stage_), made);
  }
  progress_.begin(std::string(info.name), store_->points(), "points", work);
  TileQueue queue(std::move(bytes), budget);
  std::atomic<std::uint64_t> again{0};
  tbb::parallel_for(
      tbb::blocked_range<size_t>(0, groups.size(), 1),
      [&](const tbb::blocked_range<size_t>& range) {
        for (size_t turn = range.begin(); turn < range.end(); ++turn) {
          const TileQueue::Piece piece = queue.take();
          const TileGroup& group = groups[piece.number()];
          PieceRecord& note = notes[piece.number()];
          if (const fs::path done = done_file(number, group); fs::exists(done)) {
            std::optional<PieceRecord> read = read_record(done);
            if (!read) throw damaged_work(done);
            note = std::move(*read);
            ++again;
            progress_.skip(group.own, work_of(group));
          } else {
            memory_.make_room(group.bytes);
            note = run_group(number, group, wet.contains(group.tiles[0]));
            progress_.advance(group.own, work_of(group));
          }
          if (lets_go) store_->release(group.tiles[0]);
        }
      },
      tbb::simple_partitioner());
  progress_.end();
  resumed_ += again;
  Account& account = accounts_[number];
  account.in = account.out = store_->points();
  keep_surface_tiles(number, fringe);
  for (size_t i = 0; i < notes.size(); ++i) {
    const TileKey first = groups[i].tiles[0];
    account.seconds += notes[i].note.find("seconds")->as_number();
    account.cut += static_cast<std::uint64_t>(notes[i].note.find("cut")->as_bool());
    if (store_->tiles().contains(first) || surface_tiles_.contains(first)) account.tally.add(Tally::from(*notes[i].note.find("tally")));
    for (PieceFile& f : notes[i].files) made_[number].push_back(std::move(f));
  }
  if (!info.gives.empty()) store_->add_overlay(folder(number), info.gives);
  for (const stages::Product p : info.gives_products) grids_.add(p, folder(number));
  expect_made(number);
}

/// Whatever the stage has finished is there.
void Engine::expect_made(size_t number) const {
  for (const PieceFile& f : made_[number]) {
    std::error_code ec;
    const fs::path file = folder(number) / f.name;
    if (fs::file_size(file, ec) != f.bytes || ec) throw damaged_work(file);
  }
}

void Engine::run_merge(size_t number) {
  stages::MergeJob job{folder(number), {}, {}};
  job.tiles = tiles_of(number);
  const auto start = Clock::now();
  context_.memory = memory_.free();
  progress_.begin(std::string(stage(number).info().name) + " merge", 0, "");
  const io::FinishedFiles finished;
  const io::UnflushedFiles flushed_when_delivered;
  stage(number).run_merge(context_, job);
  replace_files(made_[number], files_without_checksum(job.folder, finished.files()));
  progress_.end();
  expect_balance(job.tally, stage(number));
  accounts_[number].tally.add(job.tally);
  for (auto& [key, value] : job.findings.members()) accounts_[number].findings[key] = std::move(value);
  accounts_[number].seconds += since(start);
}

void Engine::run_tile_stages() {
  for (size_t i = last_strip_stage_ + 1; i < plan_.stages.size(); ++i) {
    if (!works_on(i, Grain::tile) && !works_on(i, Grain::merge)) continue;
    begin_products(i);
    if (works_on(i, Grain::tile))
      run_tiles(i);
    else
      for (const stages::Product p : stage(i).info().gives_products) grids_.add(p, folder(i));
    if (works_on(i, Grain::merge)) run_merge(i);
    if (!works_on(i, Grain::survey)) context_.earlier.push_back(context_.output);
    // What a comparison alone says of data that are refused is not kept.
    has_products_ = has_products_ || (!stage(i).info().name.starts_with("quality.") && fs::exists(context_.output));
  }
}

/// A late stage failed: the products of those before it are whole and stay, with the work that the same command goes on from.
void Engine::keep_finished(const core::Error& e) {
  std::error_code absent;
  fs::remove(output_ / "report.json", absent);  // of an earlier run: it says nothing of these products
  try {
    deliver(context_.earlier, output_, true, outside_inputs(plan_));
  } catch (const core::Error&) {
    throw e;
  }
  throw core::Error(e.what(), e.where(),
                    (e.hint().empty() ? std::string() : e.hint() + "; ") + "the products of the stages before it are in " +
                        output_.string() + ", and the same command goes on from there",
                    e.code());
}

Measured Engine::measured() const {
  const auto finding = [&](std::string_view limit) -> std::optional<double> {
    for (const LimitedFinding& f : limited_findings())
      for (size_t i = 0; i < accounts_.size(); ++i)
        if (f.limit == limit && stage(i).info().name == f.stage)
          if (const Value* v = value_at(accounts_[i].findings, f.path))  // null: computed, and not finite
            return v->is_number() ? v->as_number() : std::numeric_limits<double>::quiet_NaN();
    return std::nullopt;
  };
  std::optional<double> outside;
  for (size_t i = 0; i < accounts_.size(); ++i)
    if (stage(i).info().name == "georeference" && accounts_[i].in > 0)
      outside = static_cast<double>(accounts_[i].tally.of("outside the trajectory, left out")) / static_cast<double>(accounts_[i].in);
  return {outside, finding("voids"), finding("truth_rms"), finding("line_difference"), finding("contradictions")};
}

const Value* Engine::judged_geometry() const {
  for (const Account& a : accounts_)
    if (const Value* geometry = a.findings.find("geometry")) return geometry;
  return nullptr;
}

void Engine::compose_report(const std::string& command) {
  report_ = Value::object();
  report_["program"] = "swath " + std::string(program_version());
  report_["command"] = command;
  report_["survey"] = plan_.survey.name;
  if (!context_.crs.empty()) {
    report_["crs"]["name"] = context_.crs.name();
    report_["crs"]["definition"] = plan_.survey.crs;
    report_["crs"]["heights"] = context_.heights;
  }
  Value& files = report_["inputs"] = Value::array();
  for (const Input& i : inputs_) {
    Value one = Value::object();
    one["file"] = i.file.generic_string();
    one["bytes"] = i.bytes;
    one["xxh3"] = i.hash;
    files.push(std::move(one));
  }
  const Value options = explain(plan_);
  report_["run"] = *options.find("run");
  Value judged_geometry;
  Value& list = report_["stages"] = Value::array();
  for (size_t i = 0; i < accounts_.size(); ++i) {
    const Account& a = accounts_[i];
    Value one = Value::object();
    one["type"] = stage(i).info().name;
    one["fingerprint"] = fingerprints_[i];
    if (!works_on(i, Grain::survey) && (i != source_ || store_)) {  // a source that survey stages alone read has its records
      one["counts"]["in"] = a.in;
      one["counts"]["out"] = a.out;
    }
    if (a.cut > 0) one["tiles_cut_to_fit_memory"] = a.cut;
    if (Value records = records_of(a.tally); !records.items().empty()) one["records"] = std::move(records);
    if (!a.tally.empty()) one["tally"] = a.tally.value();
    if (!a.findings.members().empty()) one["findings"] = a.findings;
    if (const Value* geometry = a.findings.find("geometry")) {
      judged_geometry = *geometry;
      one["findings"] = Value::object();
      one["findings"]["verdict"] = *geometry->find("verdict");
    }
    one["options"] = *options.find("stages")->items()[i].find("options");
    one["seconds"] = a.seconds;
    list.push(std::move(one));
  }
  if (!judged_geometry.is_null()) report_["geometry"] = std::move(judged_geometry);
  report_["versions"] = versions();
}

/// Removes folders that hold nothing, upwards to `top` itself.
void remove_if_empty(const fs::path& top) {
  std::error_code ec;
  if (fs::is_directory(top, ec) && fs::is_empty(top, ec)) fs::remove(top, ec);
}

/// All products go to the output folder, and the report behind them.
void Engine::deliver_all(const WorkLock& lock) {
  const fs::path report = folder(plan_.stages.size() - 1) / "report";
  io::write_text_file(report / "report.json", io::to_json(report_));
  std::vector<fs::path> all = context_.earlier;
  all.push_back(report);
  lock.expect_there();
  for (size_t i = 0; i < plan_.stages.size(); ++i) expect_made(i);
  deliver(all, output_, plan_.run.keep_work, outside_inputs(plan_));
  lock.expect_there();
}

void Engine::expect_all_delivered() const {
  for (const std::vector<PieceFile>& of_stage : made_)
    for (const PieceFile& f : of_stage)
      if (f.name.begin()->string() == products_name) expect_delivered(output_ / f.name.lexically_relative(products_name), f.bytes);
  expect_delivered(output_ / "report.json", io::to_json(report_).size());
}

Outcome Engine::run(const std::string& command) {
  const auto start = Clock::now();
  fit_memory(memory_.bytes());
  expect_own(work_);
  expect_own(output_ / discarded_name);
  if (!plan_.survey_file.empty()) check_output(plan_);
  prepare();
  const bool made_output = !fs::exists(output_);
  std::error_code ec;
  fs::create_directories(work_, ec);
  if (ec) io::throw_system_error("cannot make the output folder", output_, ec.value());
  const fs::path discarded = output_ / discarded_name;
  const WorkLock lock(work_);
  expect_own(work_);  // again: whatever came to lie there before the lock is not emptied
  try {
    keep_whole();
    progress_.expect(std::vector<double>(steps(), 0.0));
    run_survey_stages();
    if (makes_points(plan_)) {
      run_strips();
      run_tile_stages();
    }
    compose_report(command);
    report_["limits"] = judged(plan_.run.limits, measured());
    const bool held = missed_limits(report_["limits"]).empty();
    report_["pieces_resumed"] = resumed_;
    report_["pieces_damaged"] = damaged_;
    report_["seconds"] = since(start);
    report_["threads"] = threads_;
    deliver_all(lock);
    if (!plan_.run.keep_work) discard(work_, discarded);
    expect_all_delivered();
    return {held ? core::Exit::done : core::Exit::quality_missed, report_};
  } catch (const core::SystemError&) {
    throw;  // the work done so far stays, for the same command once the cause is repaired
  } catch (const fs::filesystem_error& e) {
    io::throw_system_error("cannot work on the file", e.path1(), e.code().value());
  } catch (const std::bad_alloc&) {
    throw;  // as for a full disk
  } catch (const core::Error& e) {
    if (!lock.is_there()) throw;  // what is there now is another run's
    const core::Error reported = with_geometry(e, judged_geometry(), input_files(plan_));
    if (has_products_) keep_finished(reported);
    discard(work_, discarded);
    if (made_output) remove_if_empty(output_);
    throw reported;
  } catch (...) {
    if (!lock.is_there()) throw;
    discard(work_, discarded);
    if (made_output) remove_if_empty(output_);
    throw;
  }
}

}  // namespace

Outcome run(Plan& plan, Progress& progress, const std::string& command) { return Engine(plan, progress).run(command); }

}  // namespace swath::pipeline
