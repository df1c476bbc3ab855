// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <set>

#include "io/text/output_file.h"
#include "pipeline/delivery.h"
#include "pipeline/engine/outcome.h"
#include "pipeline/engine/strips.h"
#include "pipeline/engine/tiles.h"
#include "pipeline/input_guard.h"
#include "pipeline/summary.h"
#include "pipeline/work/released_points.h"
#include "pipeline/work/survey_piece.h"
#include "stages/area.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;
using core::Value;
using stages::Grain;

constexpr const char* discarded_name = ".swath-discarded";

void prepare_map(RunState& run) {
  run.context.crs = core::Crs(run.plan.survey.crs);
  if (works_on_the_map(run.plan)) require_projected(run.context.crs, run.plan.survey_file);
  run.context.unit = run.context.crs.metres_per_unit();
  run.context.vertical_unit = run.context.crs.vertical_metres_per_unit();
  run.context.product_crs = run.plan.survey.crs;
  run.context.heights = run.context.crs.vertical_name();
  if (!run.context.crs.has_height_unit()) {
    if (run.plan.survey.height_unit)
      run.context.vertical_unit = run.plan.survey.height_unit->value;
    else if (!run.plan.survey.points.empty())
      run.context.vertical_unit = run.context.unit;
    if (run.context.vertical_unit != 1.0)
      run.context.product_crs = "COMPD_CS[\"" + run.context.crs.name() + " + height\"," + run.context.crs.wkt1() +
                                ",VERT_CS[\"height\",VERT_DATUM[\"unknown\",2005],UNIT[\"" +
                                (run.context.vertical_unit == 0.3048 ? "foot" : "height unit") + "\"," +
                                core::format_number(run.context.vertical_unit) + "],AXIS[\"Up\",UP]]]";
  }
  // What comes from the records of a flight has ellipsoidal heights; a cloud's source knows about its own.
  if (run.context.crs.heights() == core::Heights::unknown) run.context.heights = core::ellipsoidal_heights;
  stages::set_area(run.context, run.context.area.box, 0.0);
  for (const PlannedStage& s : run.plan.stages)
    if (s.stage->is_source()) s.stage->locate(run.context);
}

void prepare(RunState& run) {
  if (run.plan.survey_file.empty())
    throw core::usage_error("no survey to run on", run.plan.config.string(),
                            "name it with --survey DIR/survey.toml, or as run.survey in the config");
  for (const PlannedStage& s : run.plan.stages)
    if (run.plan.survey.crs.empty() && s.stage->is_source()) run.plan.survey.crs = s.stage->own_crs(run.plan.survey);
  run.context.tile_side = run.plan.run.tile.value;
  run.context.grids = &run.grids;
  run.context.threads = run.threads;
  run.context.progress = [&run](double share, std::string_view now) { run.progress.share(share, now); };
  if (works_on_the_map(run.plan) || !run.plan.survey.crs.empty()) prepare_map(run);
  run.inputs = inputs_of(run.plan);
  run.fingerprints = fingerprints(run.plan, run.inputs);
  if (!run.fingerprints.empty()) run.context.project = project_id(run.fingerprints.back());
  const Day day = creation_day();
  run.context.creation_year = day.year;
  run.context.creation_day = day.of_year;
  while (run.source < run.plan.stages.size() && !run.stage(run.source).is_source()) ++run.source;
  for (size_t i = 0; i < run.plan.stages.size(); ++i)
    if (run.works_on(i, Grain::strip)) run.last_strip_stage = i;
  run.folders = run.fingerprints;
}

/// Of an earlier run of this plan that was killed, or whose work was kept.
void keep_whole(RunState& run) {
  if (makes_points(run.plan)) choose_strips(run);
  std::set<std::string> valid;
  for (size_t i = 0; i < run.plan.stages.size(); ++i) valid.insert(run.folder(i).filename().string());
  sweep(run.work, valid);
  std::error_code absent;
  fs::remove_all(run.output / discarded_name, absent);
  if (std::none_of(valid.begin(), valid.end(), [&](const std::string& name) { return fs::exists(run.work / name); })) return;
  run.progress.begin("check of earlier work", 0, "");
  const EarlierWork earlier = keep_whole_work(run.work, [&](double done) { run.progress.share(done); });
  run.progress.end();
  if (makes_points(run.plan))
    run.read_again = give_up_strips(run.folder(run.last_strip_stage),
                                    [&](TileKey key) { return !run.keeps_store && is_tile_done(run, last_reader(run), key); });
  run.damaged = earlier.damaged;
  if (run.damaged > 0)
    run.progress.say("damaged: " + std::to_string(run.damaged) + " pieces of an earlier run are not what they were and are done again");
  if (run.read_again > 0)
    run.progress.say("read again: " + std::to_string(run.read_again) + " flight lines or files, whose points were removed once written");
  if (earlier.lines - run.read_again + earlier.pieces > 0)
    run.progress.say("resumed: " + std::to_string(earlier.lines - run.read_again) + " flight lines or files and " +
                     std::to_string(earlier.pieces) + " pieces of other stages were done by an earlier run and are not done again");
}

/// What readers hand on is as large as their files, and read as fast from these.
bool is_read_again(const RunState& run, size_t number) { return run.stage(number).info().name.starts_with("readers."); }

/// Is what an earlier run has kept of a survey stage enough? IMU records are not needed where the stages that use them are done; their
/// piece is, for what the report says of them.
bool is_resumed(const RunState& run, size_t number) {
  if (!is_survey_piece_done(run.folder(number))) return false;
  if (!is_read_again(run, number)) return true;
  for (size_t i = number + 1; i < run.plan.stages.size(); ++i)
    if (run.works_on(i, Grain::survey) && run.stage(i).info().uses(stages::Product::of<core::ImuData>()) &&
        !is_survey_piece_done(run.folder(i)))
      return false;
  return true;
}

/// What no stage behind this one has a use for.
std::vector<stages::Product> last_uses(const RunState& run, size_t number) {
  std::vector<stages::Product> last = run.stage(number).info().needs_products;
  std::erase_if(last, [&](stages::Product p) {
    for (size_t i = number + 1; i < run.plan.stages.size(); ++i)
      if (run.stage(i).info().uses(p)) return true;
    return false;
  });
  return last;
}

void run_survey_stages(RunState& run) {
  for (size_t i = 0; i < run.plan.stages.size(); ++i) {
    if (!run.works_on(i, Grain::survey)) continue;
    if (run.stage(i).info().takes(stages::Product::shots)) find_strips(run);
    begin_products(run, i);
    run.progress.begin(std::string(run.stage(i).info().name), 0, "");
    const bool resumed = is_resumed(run, i);
    run.context.memory = run.memory.free();
    run.context.last_uses = last_uses(run, i);
    SurveyPiece piece = resumed
                            ? resume_survey_piece(run.context, run.folder(i))
                            : run_survey_piece(run.stage(i), run.context, run.folder(i),
                                               !is_read_again(run, i) || run.stage(i).info().makes(stages::Product::of<core::ImuData>()));
    run.progress.end();
    run.resumed += resumed;
    run.accounts[i].tally.add(piece.tally);
    run.accounts[i].findings = std::move(piece.findings);
    run.accounts[i].seconds += piece.seconds;
    run.made[i] = std::move(piece.files);
    run.context.earlier.push_back(run.context.output);
    if (const Value* geometry = run.accounts[i].findings.find("geometry"))
      if (const Value* doubt = geometry->find("doubt")) run.context.records.put(stages::GeometryDoubt{doubt->as_text()});
  }
}

/// Survey stages, strips, tile stages and merges.
size_t steps(const RunState& run) {
  const bool points = makes_points(run.plan);
  size_t n = points ? 1 : 0;
  for (size_t i = 0; i < run.plan.stages.size(); ++i) {
    n += run.works_on(i, Grain::survey);
    if (points && i > run.last_strip_stage)
      n += static_cast<size_t>(run.works_on(i, Grain::tile)) + static_cast<size_t>(run.works_on(i, Grain::merge));
  }
  return n;
}

/// Removes folders that hold nothing, upwards to `top` itself.
void remove_if_empty(const fs::path& top) {
  std::error_code ec;
  if (fs::is_directory(top, ec) && fs::is_empty(top, ec)) fs::remove(top, ec);
}

}  // namespace

Outcome run(Plan& plan, Progress& progress, const std::string& command) {
  RunState run(plan, progress);
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, static_cast<size_t>(run.threads));
  const auto start = std::chrono::steady_clock::now();
  fit_memory(run.memory.bytes());
  expect_own(run.work);
  expect_own(run.output / discarded_name);
  if (!run.plan.survey_file.empty()) check_output(run.plan);
  prepare(run);
  const bool made_output = !fs::exists(run.output);
  std::error_code ec;
  fs::create_directories(run.work, ec);
  if (ec) io::throw_system_error("cannot make the output folder", run.output, ec.value());
  const fs::path discarded = run.output / discarded_name;
  const WorkLock lock(run.work);
  expect_own(run.work);  // again: whatever came to lie there before the lock is not emptied
  try {
    keep_whole(run);
    run.progress.expect(std::vector<double>(steps(run), 0.0));
    run_survey_stages(run);
    if (makes_points(run.plan)) {
      run_strips(run);
      run_tile_stages(run);
    }
    Value report = report_of(run, command, seconds_since(start));
    const bool held = missed_limits(*report.find("limits")).empty();
    deliver_all(run, report, lock);
    if (!run.plan.run.keep_work) discard(run.work, discarded);
    expect_all_delivered(run, report);
    return {held ? core::Exit::done : core::Exit::quality_missed, std::move(report)};
  } catch (const core::SystemError&) {
    throw;  // the work done so far stays, for the same command once the cause is repaired
  } catch (const fs::filesystem_error& e) {
    io::throw_system_error("cannot work on the file", e.path1(), e.code().value());
  } catch (const std::bad_alloc&) {
    throw;  // as for a full disk
  } catch (const core::Error& e) {
    if (!lock.is_there()) throw;  // what is there now is another run's
    const core::Error reported = with_geometry(e, judged_geometry(run), input_files(run.plan));
    if (run.has_products) keep_finished(run, reported);
    discard(run.work, discarded);
    if (made_output) remove_if_empty(run.output);
    throw reported;
  } catch (...) {
    if (!lock.is_there()) throw;
    discard(run.work, discarded);
    if (made_output) remove_if_empty(run.output);
    throw;
  }
}

}  // namespace swath::pipeline
