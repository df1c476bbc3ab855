// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/survey_stages.h"

#include <algorithm>

#include "core/geo/height_unit.h"
#include "pipeline/engine/map_fit.h"
#include "pipeline/engine/strips.h"
#include "pipeline/work/survey_piece.h"
#include "stages/area.h"

namespace swath::pipeline {
namespace {

using core::Value;
using stages::Grain;

/// As soon as the place of the data is known: of clouds before any work, of a flight once its trajectory is there.
void expect_map_fits(const RunState& run) {
  if (!works_on_the_map(run.plan)) return;
  const bool typed = run.plan.survey_tree.has_value();
  const std::string where =
      typed && !run.plan.survey.points.empty() ? run.plan.survey.points.front().file.string() : run.plan.survey_file.string() + ": crs";
  require_map_fit(run.context, where, typed);
}

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
    // A reader of the products takes heights in the unit of the horizontal axes, or in metres.
    if (!core::is_same_unit(run.context.vertical_unit, 1.0) ||
        (run.context.crs.is_projected() && !core::is_same_unit(run.context.vertical_unit, run.context.unit)))
      run.context.product_crs = core::with_height_unit(run.context.crs, run.context.vertical_unit,
                                                       run.plan.survey.points.empty() ? core::ellipsoidal_heights : "height");
  }
  // What comes from the records of a flight has ellipsoidal heights; a cloud's source knows about its own.
  if (run.context.crs.heights() == core::Heights::unknown) run.context.heights = core::ellipsoidal_heights;
  stages::set_area(run.context, run.context.area.box, 0.0);
  for (const PlannedStage& s : run.plan.stages)
    if (s.stage->is_source()) s.stage->locate(run.context);
  expect_map_fits(run);
}

/// The default budget is meant for tiles: where a survey stage needs more, the report says so. Any other is enforced.
void expect_memory(RunState& run, size_t number) {
  const std::string name(run.stage(number).info().name);
  const double bytes = run.stage(number).survey_memory(run.context), left = run.memory.left();
  if (bytes <= left) return;
  if (run.memory.bytes() != RunOptions().memory.value) run.memory.require(bytes, left, name, true);
  const auto text = [](double b) { return core::format_quantity(core::Dimension::memory, std::ceil(b / 1e8) * 1e8); };
  run.over_memory.push_back(name + " needs about " + text(bytes) + ", and " + text(std::max(0.0, left)) +
                            " of run.memory = " + text(run.memory.bytes()) + " are free");
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

}  // namespace

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
  if (run.inputs.empty()) run.inputs = inputs_of(run.plan);
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

void run_survey_stages(RunState& run) {
  for (size_t i = 0; i < run.plan.stages.size(); ++i) {
    if (!run.works_on(i, Grain::survey)) continue;
    if (run.stage(i).info().takes(stages::Product::shots)) find_strips(run);
    begin_products(run, i);
    run.progress.begin(std::string(run.stage(i).info().name), 0, "");
    const bool resumed = is_resumed(run, i);
    if (run.share && run.share->wave > 0 && !resumed && !is_read_again(run, i))
      wave_too_early(run, std::string(run.stage(i).info().name) + " is missing");
    if (!resumed) expect_memory(run, i);
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
    run.accounts[i].time += piece.time;
    run.made[i] = std::move(piece.files);
    run.context.earlier.push_back(run.context.output);
    if (const Value* geometry = run.accounts[i].findings.find("geometry"))
      if (const Value* doubt = geometry->find("doubt")) run.context.records.put(stages::GeometryDoubt{doubt->as_text()});
  }
  expect_map_fits(run);
}

}  // namespace swath::pipeline
