// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <set>
#include <utility>

#include "core/config/units.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "pipeline/delivery.h"
#include "pipeline/engine/outcome.h"
#include "pipeline/engine/strips.h"
#include "pipeline/engine/survey_stages.h"
#include "pipeline/engine/tiles.h"
#include "pipeline/input_guard.h"
#include "pipeline/summary.h"
#include "pipeline/work/released_points.h"
#include "pipeline/work/survey_piece.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;
using core::Value;
using stages::Grain;

constexpr const char* discarded_name = ".swath-discarded";

/// Names of the folders that this plan's work lies in.
std::set<std::string> own_folders(RunState& run) {
  if (makes_points(run.plan)) choose_strips(run);
  std::set<std::string> out;
  for (size_t i = 0; i < run.plan.stages.size(); ++i) out.insert(run.folder(i).filename().string());
  return out;
}

/// Several processes may be about to work on what is there.
void expect_no_foreign(RunState& run) {
  const std::set<std::string> foreign = foreign_folders(run.work, own_folders(run));
  if (foreign.empty()) return;
  throw core::usage_error("it holds work of another plan, or of other inputs: " + *foreign.begin(), run.work.string(),
                          "finish that plan, or choose another --output; `swath run` without --wave would remove it");
}

/// Of an earlier run of this plan that was killed, or whose work was kept.
void keep_whole(RunState& run) {
  const std::set<std::string> valid = own_folders(run);
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
    run.progress.say("damaged: " + core::counted(run.damaged, "piece of an earlier run is not what it was and is done again",
                                                 "pieces of an earlier run are not what they were and are done again"));
  if (run.read_again > 0)
    run.progress.say("read again: " + core::counted(run.read_again, "flight line or file", "flight lines or files") +
                     ", whose points were removed once written");
  if (earlier.lines - run.read_again + earlier.pieces > 0)
    run.progress.say("resumed: " + core::counted(earlier.lines - run.read_again, "flight line or file", "flight lines or files") + " and " +
                     core::counted(earlier.pieces, "piece") + " of other stages were done by an earlier run and are not done again");
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

/// The survey stages are done by one process; another that comes to do the same finds them done.
bool is_survey_done(const RunState& run) {
  for (size_t i = 0; i < run.plan.stages.size(); ++i)
    if (run.works_on(i, Grain::survey) && !run.stage(i).info().name.starts_with("readers.") && !is_survey_piece_done(run.folder(i)))
      return false;
  return true;
}

void expect_same_plan(const RunState& run, const Share& share) {
  if (!share.fingerprint.empty() && share.fingerprint != run.fingerprints.back())
    throw core::usage_error("config, survey or program have changed since the tasks were listed", run.plan.config.string(),
                            "list them anew with `swath tasks`, for another --output");
}

/// `share`: the last wave of what several processes do; null: the whole run.
Outcome run_alone(Plan& plan, Progress& progress, const std::string& command, std::vector<Input> inputs, const Share* share) {
  RunState run(plan, progress);
  run.inputs = std::move(inputs);
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, static_cast<size_t>(run.threads));
  const Stopwatch watch(Whose::program);
  fit_memory(run.memory.bytes());
  expect_own(run.work);
  expect_own(run.output / discarded_name);
  if (!run.plan.survey_file.empty()) check_output(run.plan);
  prepare(run);
  if (share) expect_same_plan(run, *share);
  const bool made_output = !fs::exists(run.output);
  std::error_code ec;
  fs::create_directories(run.work, ec);
  if (ec) io::throw_system_error("cannot make the output folder", run.output, ec.value());
  const fs::path discarded = run.output / discarded_name;
  const WorkLock lock(run.work);
  expect_own(run.work);  // again: whatever came to lie there before the lock is not emptied
  if (share) expect_no_foreign(run);
  try {
    keep_whole(run);
    run.progress.expect(std::vector<double>(steps(run), 0.0));
    run_survey_stages(run);
    if (makes_points(run.plan)) {
      run_strips(run);
      run_tile_stages(run);
    }
    Value report = report_of(run, command, watch.spent());
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

/// One without the folder is on a machine that does not see it, or comes too early.
void expect_work(const fs::path& work) {
  if (!fs::is_directory(work))
    throw core::usage_error("there is no work folder", work.string(),
                            "do wave 0 first; where that is done: does this machine see the folder?");
}

/// Is the report that of this plan's run? Its last stage says what it was made from.
bool is_report_of(const RunState& run, const Value& report) {
  const Value* stages = report.is_object() ? report.find("stages") : nullptr;
  if (!stages || !stages->is_array() || stages->items().empty() || !stages->items().back().is_object()) return false;
  const Value* made = stages->items().back().find("fingerprint");
  return made && made->is_text() && made->as_text() == run.fingerprints.back();
}

/// The last wave. A process that comes when it is done finds the report.
Outcome finish_shared(Plan& plan, Progress& progress, const std::string& command, const Share& share, std::vector<Input> inputs) {
  const fs::path output = fs::absolute(plan.run.output), work = output / work_name, file = output / "report.json";
  if (!fs::is_directory(work) && fs::is_regular_file(file)) {
    RunState run(plan, progress);
    run.inputs = std::move(inputs);
    prepare(run);
    expect_same_plan(run, share);
    Value report = io::read_value_file(file);
    if (is_report_of(run, report)) {
      const Value* limits = report.find("limits");
      return {limits && !missed_limits(*limits).empty() ? core::Exit::quality_missed : core::Exit::done, std::move(report)};
    }
    inputs = std::move(run.inputs);
  }
  expect_work(work);
  return run_alone(plan, progress, command, std::move(inputs), &share);
}

}  // namespace

Outcome run(Plan& plan, Progress& progress, const std::string& command) { return run_alone(plan, progress, command, {}, nullptr); }

Outcome run_share(Plan& plan, Progress& progress, const std::string& command, const Share& share, std::vector<Input> inputs) {
  const std::vector<Wave> waves = waves_of(plan);
  if (share.wave >= waves.size())
    throw core::usage_error("there is no wave " + std::to_string(share.wave), "--wave",
                            "this plan has the waves 0 to " + std::to_string(waves.size() - 1) + ": see `swath tasks`");
  const Wave wave = waves[share.wave];
  if (!wave.is_shared() && share.part != 1) return {};  // one process does it
  if (wave.kind == WaveKind::finish) return finish_shared(plan, progress, command, share, std::move(inputs));
  RunState run(plan, progress);
  run.share = share;
  run.inputs = std::move(inputs);
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, static_cast<size_t>(run.threads));
  fit_memory(run.memory.bytes());
  expect_own(run.work);
  if (!run.plan.survey_file.empty()) check_output(run.plan);
  prepare(run);
  expect_same_plan(run, share);
  if (share.wave > 0) expect_work(run.work);
  std::error_code ec;
  fs::create_directories(run.work, ec);
  if (ec) io::throw_system_error("cannot make the output folder", run.output, ec.value());
  if (makes_points(run.plan)) choose_strips(run);
  if (share.wave == 0 && is_survey_done(run)) return {};
  const WorkLock lock(run.work, share.wave == 0 ? WorkLock::Use::alone_when_free : WorkLock::Use::together);
  run.progress.expect(std::vector<double>(steps(run), 0.0));
  if (share.wave == 0) expect_no_foreign(run), keep_whole(run);
  run_survey_stages(run);
  if (share.wave > 0) run_strips(run);
  if (wave.kind == WaveKind::tiles) run_tile_stages(run);
  lock.expect_there();
  return {};
}

}  // namespace swath::pipeline
